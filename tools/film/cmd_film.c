/* clothsim film: makes one film of the pictures of a run by ffmpeg, or a contact sheet.
 *
 *   run.json -> pictures, rate and range -> check that all are there -> ffmpeg -> rename
 *   run.json -> evenly spaced pictures -> shrunk tiles with times -> one PNG
 *   several runs -> a folder of tiled pictures beside the film -> ffmpeg -> removed */
#include "base/file.h"
#include "base/png.h"
#include "base/text.h"
#include "cli/commands.h"
#include "cli/file_conflicts.h"
#include "cli/line/print.h"
#include "cli/run_folder.h"
#include "film/film_sheet.h"
#include "shared/subprocess.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { PATH_BYTES = 4096 };

struct options {
    const char *out, *grid;
    double rate;
    uint32_t tile;
    bool show, titles, overwrite, quiet;
};
static const struct options defaults = {.tile = 320};

static const struct cs_arg rows[] = {
    {"out", 'o', "FILE",
     "an .mp4, .webm, .gif or .apng (default: film.mp4 in DIR); a .png of a sheet "
     "(sheet.png)",
     CS_ARG_INTO(struct options, out)},
    {"fps", 0, "RATE", "pictures per second (default: the speed of the scene)",
     CS_ARG_INTO(struct options, rate)},
    {"sheet", 0, "COLUMNSxROWS",
     "write one picture of at most so many columns and rows, such as 5x4, instead of a film",
     CS_ARG_INTO(struct options, grid)},
    {"tile", 0, "PIXELS", "maximum width of a picture on a sheet (default: 320)",
     CS_ARG_INTO(struct options, tile), .min = 16, .max = 4096},
    {"show", 0, NULL, "play the pictures in the terminal, and write no film",
     CS_ARG_INTO(struct options, show)},
    {"titles", 0, NULL, "write method, cost and error above each run",
     CS_ARG_INTO(struct options, titles)},
    {"overwrite", 'y', NULL, "replace an existing film or sheet",
     CS_ARG_INTO(struct options, overwrite)},
    CS_ARG_QUIET(struct options, quiet),
};

/* Films have no alpha: what is dark counts by it, and the rest is white. ffmpeg 5.1 breaks down
 * where pictures are laid on others by `overlay`. */
#define WHITE "format=gbrap,negate,premultiply=inplace=1,negate,"
/* 4:2:0 asks for even sizes. The colours are told as those of ITU-R BT.709, which players take
 * for them. */
#define EVEN "pad=ceil(iw/2)*2:ceil(ih/2)*2,scale=out_color_matrix=bt709:out_range=tv"
#define YUV                                                                                    \
    "-pix_fmt", "yuv420p", "-colorspace", "bt709", "-color_primaries", "bt709", "-color_trc",  \
        "bt709"
/* A GIF counts the time of a picture in 10 ms, and browsers slow down what is below 20 ms. */
#define PALETTE "fps='min(source_fps,25)',split[a][b];[a]palettegen[p];[b][p]paletteuse"

enum { ARGUMENTS = 48, CODEC = 16 };

/* A kind of film: the ending of its name, filters without and with alpha of the pictures, and
 * what ffmpeg is told of its codec. */
static const struct format {
    const char *ending, *filter, *clear_filter, *codec[CODEC];
} formats[] = {
    {".mp4",
     EVEN,
     WHITE EVEN,
     {YUV, "-c:v", "libx264", "-crf", "18", "-movflags", "+faststart"}},
    {".webm", EVEN, WHITE EVEN, {YUV, "-c:v", "libvpx-vp9", "-crf", "24", "-b:v", "0"}},
    {".gif", PALETTE, WHITE PALETTE, {"-loop", "0"}},
    {".apng", "format=rgb24", WHITE "format=rgb24", {"-plays", "0"}},
};
enum { FORMATS = sizeof formats / sizeof *formats };

/* Input and destination of a film. ffmpeg writes to `part`, which is renamed to `out`. */
struct film {
    const char *folder;
    double rate; /* pictures a second */
    const struct format *format;
    bool has_gaps;      /* between the pictures' numbers, of a run by an older version */
    bool clear;         /* the pictures have alpha */
    bool awaits_ffmpeg; /* set where it was not found: the message names the folder */
    char out[PATH_BYTES], part[PATH_BYTES + 16]; /* absolute: ffmpeg works in the folder */
};

static const struct format *find_format(const char *ending) {
    for (size_t k = 0; ending && k < FORMATS; k++)
        if (!strcmp(ending, formats[k].ending))
            return &formats[k];
    return NULL;
}

/* Sets the path of the film, whose ending names the format. The temporary file keeps the
 * ending, which ffmpeg reads. */
static enum cs_status set_output_path(const struct options *options, struct film *film,
                                      struct cs_error *error) {
    char made[PATH_BYTES], here[PATH_BYTES] = "";
    snprintf(made, sizeof made, "%.4000s/film.mp4", film->folder);
    const char *out = options->out ? options->out : made, *ending = strrchr(out, '.');
    bool streams;
    film->format = find_format(ending);
    if (!film->format)
        return cs_fail(error, CS_ERR_USAGE,
                       "--out: expected a name that ends in .mp4, .webm, .gif or .apng, found "
                       "\"%.60s\"",
                       out);
    if (*out != '/' && !getcwd(here, sizeof here))
        return cs_fail(error, CS_ERR_FILE, "cannot determine the current folder");
    if (snprintf(film->out, sizeof film->out, "%s%s%s", here, *here ? "/" : "", out) >=
        PATH_BYTES)
        return cs_fail(error, CS_ERR_FILE, "\"%.60s...\": the path is too long", out);
    snprintf(film->part, sizeof film->part, "%s.part%s", film->out, ending);
    if (cs_file_target(film->out, &streams, error) || streams)
        return cs_fail(error, CS_ERR_FILE, "cannot write \"%s\": a film is a regular file",
                       out);
    return options->overwrite ? CS_OK : cs_output_check_file(out, error);
}

/* The line for ffmpeg, closed by NULL. A damaged picture is an error. */
static void fill(const struct film *film, const char *rate, const char *out,
                 const char *arguments[ARGUMENTS]) {
    const struct format *format = film->format;
    const char *const line[] = {
        "ffmpeg", "-loglevel", "error", "-xerror", "-nostdin", "-y", "-framerate", rate,
        /* by number, as names of more than five digits are not in order */
        film->has_gaps ? "-pattern_type" : "-start_number", film->has_gaps ? "glob" : "1", "-i",
        film->has_gaps ? "frame_*.png" : "frame_%05d.png", "-vf",
        film->clear ? format->clear_filter : format->filter};
    size_t n = sizeof line / sizeof *line;
    memcpy(arguments, line, sizeof line);
    for (size_t k = 0; k < CODEC && format->codec[k]; k++)
        arguments[n++] = format->codec[k];
    arguments[n++] = out;
    arguments[n] = NULL;
}

/* a word as it is typed: what a shell reads otherwise is quoted */
static void add_word(struct cs_text *line, const char *word) {
    if (!strpbrk(word, "*()[]' $&;\"\\")) {
        cs_text_add(line, " %s", word);
        return;
    }
    cs_text_add(line, " '");
    for (const char *c = word; *c; c++)
        cs_text_add(line, "%.*s", *c == '\'' ? 4 : 1, *c == '\'' ? "'\\''" : c);
    cs_text_add(line, "'");
}

static enum cs_status refuse_film(const struct film *film, const char *const *arguments,
                                  struct cs_error *error) {
    struct cs_text line = {0};
    add_word(&line, film->folder);
    cs_text_add(&line, " &&");
    for (const char *const *a = arguments; *a; a++)
        add_word(&line, *a);
    cs_fail(error, CS_ERR_FILE, "ffmpeg is not installed; install it, then type: cd%s",
            cs_text_get(&line));
    cs_text_finish(&line);
    return error->status;
}

static enum cs_status make(struct film *film, struct cs_error *error) {
    const volatile sig_atomic_t *stop = cs_interrupt_catch();
    const char *arguments[ARGUMENTS];
    char rate[32];
    snprintf(rate, sizeof rate, "%.15g", film->rate);
    fill(film, rate, film->part, arguments);
    // made and locked here: ffmpeg would follow a link
    const int part = cs_file_open_own(film->part, O_CREAT, error);
    if (part < 0)
        return error->status;
    const struct cs_subprocess_result end = cs_subprocess_run(film->folder, arguments, stop);
    const bool done = end.exited_ok && !cs_file_rename(film->part, film->out, error);
    if (!done)
        cs_file_remove(film->part, error);
    close(part);
    if (!end.was_found) {
        film->awaits_ffmpeg = true;
        fill(film, rate, film->out, arguments);
        return refuse_film(film, arguments, error);
    }
    if (done)
        return CS_OK;
    return *stop ? cs_fail(error, CS_ERR_INTERRUPT, "interrupted; no film was written")
                 : cs_fail(error, CS_ERR_FILE, "%s: ffmpeg could not make it", film->out);
}

/* Checks that no picture is missing: ffmpeg would end the film there without a message. */
static enum cs_status check_pictures(struct film *film, const struct cs_film_report *report,
                                     struct cs_error *error) {
    char path[PATH_BYTES];
    for (uint32_t k = 0; k < report->n; k++) {
        snprintf(path, sizeof path, "%.4000s/frame_%05u.png", film->folder,
                 report->pictures[k].number);
        film->has_gaps = film->has_gaps || report->pictures[k].number != k + 1;
        if (access(path, R_OK))
            return cs_fail(error, CS_ERR_FILE, "cannot read \"%s\": %s", path, strerror(errno));
    }
    return CS_OK;
}

static enum cs_status make_film(const struct cs_args *args, const struct cs_film_report *report,
                                struct cs_text *told, struct cs_error *error) {
    const struct options *options = args->options;
    struct film film = {.folder = args->operands[0],
                        .rate = options->rate > 0 ? options->rate : cs_film_rate(report),
                        .clear = report->clear};
    if (cs_args_is_given(args, "tile"))
        return cs_fail(error, CS_ERR_USAGE, "--tile needs --sheet");
    if (set_output_path(options, &film, error) || check_pictures(&film, report, error) ||
        make(&film, error))
        return error->status;
    cs_text_add(told, "%s: %g pictures per second\n", film.out, film.rate);
    return CS_OK;
}

enum { RUNS_MAX = 8 };

static enum cs_status write_tiles(const struct cs_film_tiles *tiles, const char *folder,
                                  uint32_t n, struct cs_error *error) {
    const struct cs_png_text text = {"Software", "clothsim " CS_VERSION};
    const volatile sig_atomic_t *stop = cs_interrupt_catch();
    char path[PATH_BYTES + 16];
    for (uint32_t k = 0; k < n && !error->status; k++) {
        struct cs_image image = {0};
        snprintf(path, sizeof path, "%.4000s/frame_%05u.png", folder, k + 1);
        if (*stop)
            cs_fail(error, CS_ERR_INTERRUPT, "interrupted; no film was written");
        else if (!cs_film_tiles_make(tiles, k, &image, error))
            cs_png_write(path, &image, 1, &text, 1, error);
        free(image.rgb);
    }
    return error->status;
}

/* Removes the pictures of tiles, which ffmpeg alone needs. */
static void remove_tiles(const char *folder, uint32_t n) {
    char path[PATH_BYTES + 16];
    for (uint32_t k = 0; k < n; k++) {
        snprintf(path, sizeof path, "%.4000s/frame_%05u.png", folder, k + 1);
        cs_file_remove(path, &(struct cs_error){0});
    }
    rmdir(folder);
}

/* Makes the film of several runs, which must show the same times. */
static enum cs_status tile_film(const struct cs_args *args,
                                const struct cs_film_report *reports, struct cs_text *told,
                                struct cs_error *error) {
    const struct options *options = args->options;
    char folder[PATH_BYTES];
    const struct cs_film_tiles tiles = {(uint32_t)args->n_operands, options->tile,
                                        args->operands, reports, options->titles};
    struct film film = {.folder = folder,
                        .rate = options->rate > 0 ? options->rate : cs_film_rate(reports)};
    uint32_t n = 0;
    if (!options->out)
        return cs_fail(error, CS_ERR_USAGE, "expected --out FILE for a film of several runs");
    for (uint32_t r = 0; r < tiles.n; r++) {
        n = reports[r].n > n ? reports[r].n : n;
        if (cs_film_rate(reports + r) != cs_film_rate(reports))
            return cs_fail(error, CS_ERR_FILE,
                           "%s: found %g pictures per second, expected %g as in %s",
                           tiles.folders[r], cs_film_rate(reports + r), cs_film_rate(reports),
                           tiles.folders[0]);
    }
    snprintf(folder, sizeof folder, "%.4000s.tiles", options->out);
    if (set_output_path(options, &film, error) ||
        (!options->overwrite && cs_output_check_file(folder, error)) ||
        cs_folder_create(folder, error))
        return error->status;
    if (!write_tiles(&tiles, folder, n, error) && !make(&film, error))
        cs_text_add(told, "%s: %u runs, %g pictures per second\n", film.out, tiles.n,
                    film.rate);
    if (!film.awaits_ffmpeg)
        remove_tiles(folder, n);
    return error->status;
}

enum { MOST_TILES = 1000 };

static enum cs_status read_sheet(const struct options *options, struct cs_contact_sheet *sheet,
                                 struct cs_error *error) {
    const char *found = options->grid;
    char rest;
    *sheet = (struct cs_contact_sheet){.tile = options->tile};
    if (options->rate > 0)
        return cs_fail(error, CS_ERR_USAGE, "--fps applies to a film, not to --sheet");
    if (strspn(found, "0123456789x") != strlen(found) || strlen(found) > 9 ||
        sscanf(found, "%ux%u%c", &sheet->columns, &sheet->rows, &rest) != 2 ||
        !sheet->columns || sheet->columns > MOST_TILES || !sheet->rows ||
        sheet->rows > MOST_TILES)
        return cs_fail(
            error, CS_ERR_USAGE,
            "--sheet: found \"%.60s\", expected columns and rows of 1 to %d, such as "
            "5x4",
            found, MOST_TILES);
    return CS_OK;
}

static enum cs_status place_sheet(const struct cs_args *args, char out[PATH_BYTES],
                                  struct cs_error *error) {
    const struct options *options = args->options;
    if (options->out)
        snprintf(out, PATH_BYTES, "%.4000s", options->out);
    else
        snprintf(out, PATH_BYTES, "%.4000s/sheet.png", args->operands[0]);
    const char *ending = strrchr(out, '.');
    if (!ending || strcmp(ending, ".png"))
        return cs_fail(error, CS_ERR_USAGE,
                       "--out: expected a name that ends in .png, found \"%.60s\"", out);
    const char *slash = strrchr(out, '/'), *name = slash ? slash + 1 : out;
    char picture[2 * PATH_BYTES];
    snprintf(picture, sizeof picture, "%.4000s/%s", args->operands[0], name);
    if (cs_output_is_result(name) &&
        cs_file_conflicts_pair(out, "--out", picture, "a picture of the run", error))
        return error->status;
    return options->overwrite ? CS_OK : cs_output_check_file(out, error);
}

static enum cs_status make_sheet(const struct cs_args *args,
                                 const struct cs_film_report *report, struct cs_text *told,
                                 struct cs_error *error) {
    const struct cs_png_text text = {"Software", "clothsim " CS_VERSION};
    char out[PATH_BYTES];
    struct cs_contact_sheet sheet;
    struct cs_image image;
    if (read_sheet(args->options, &sheet, error) || place_sheet(args, out, error) ||
        cs_contact_sheet_make(&sheet, args->operands[0], report, &image, error))
        return error->status;
    cs_png_write(out, &image, 6, &text, 1, error);
    free(image.rgb);
    cs_text_add(told, "%s: %u x %u pictures%s\n", out, sheet.columns, sheet.rows,
                sheet.colour_bar || report->pictures->range[0] == report->pictures->range[1]
                    ? ""
                    : ", with different colour ranges: see --range of clothsim run");
    return error->status;
}

static enum cs_status show(const struct cs_args *args, const struct cs_film_report *report,
                           struct cs_error *error) {
    static const char *const others[] = {"out", "sheet", "tile"};
    const struct options *options = args->options;
    for (size_t k = 0; k < sizeof others / sizeof *others; k++)
        if (cs_args_is_given(args, others[k]))
            return cs_fail(error, CS_ERR_USAGE, "--show writes no files: remove --show or --%s",
                           others[k]);
    return cs_film_show(args->operands[0], report,
                        options->rate > 0 ? options->rate : cs_film_rate(report), error);
}

static enum cs_status film(struct cs_args *args, struct cs_error *error) {
    const struct options *options = args->options;
    struct cs_film_report reports[RUNS_MAX] = {{.fps = 0}};
    struct cs_text told = {0};
    const bool several = args->n_operands > 1 || options->titles;
    if (several && options->show)
        return cs_fail(error, CS_ERR_USAGE, "--show plays one run without --titles");
    if (several && options->grid)
        return cs_fail(error, CS_ERR_USAGE,
                       "--sheet takes one run without --titles, found %u runs",
                       (unsigned)args->n_operands);
    for (uint32_t r = 0; r < args->n_operands && !error->status; r++)
        cs_film_report_read(args->operands[r], reports + r, error);
    if (!error->status && several)
        tile_film(args, reports, &told, error);
    else if (!error->status && options->show)
        show(args, reports, error);
    else if (!error->status && options->grid)
        make_sheet(args, reports, &told, error);
    else if (!error->status)
        make_film(args, reports, &told, error);
    for (uint32_t r = 0; r < args->n_operands; r++)
        cs_film_report_finish(reports + r);
    if (!error->status && !options->quiet)
        return cs_print_out(stdout, &told, error);
    cs_text_finish(&told);
    return error->status;
}

const struct cs_command cs_command_film = {
    .name = "film",
    .operands = "DIR [DIR ...]",
    .summary = CS_SUMMARY_film,
    .notes = "DIR is a folder that clothsim run wrote. Several are shown side by side, and\n"
             "--titles compares them with the first. ffmpeg makes the film.\n\n"
             "Example: clothsim film out -o cloth.webm\n",
    CS_COMMAND_OPTIONS(rows, defaults),
    .operands_min = 1,
    .operands_max = RUNS_MAX,
    .main = film,
};
