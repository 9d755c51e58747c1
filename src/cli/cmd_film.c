/* clothsim film: makes one film of the pictures of a run, by ffmpeg. */
#include "base/file.h"
#include "base/text.h"
#include "cli/commands.h"
#include "cli/line/interrupt.h"
#include "cli/line/print.h"
#include "cli/run_output.h"
#include "io/json.h"
#include "io/program.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { FILM_OUT, FILM_FPS, FILM_OVERWRITE, FILM_QUIET, FILM_ROWS };
enum { PATH_BYTES = 4096 };

static const struct cs_arg rows[FILM_ROWS] = {
    [FILM_OUT] = {"out", 'o', "FILE", "an .mp4 or .webm (default: film.mp4 in DIR)", false},
    [FILM_FPS] = {"fps", 0, "RATE", "pictures a second (default: as fast as the scene moved)",
                  false},
    [FILM_OVERWRITE] = {"overwrite", 'y', NULL, "replace a film that is there", false},
    [FILM_QUIET] = {"quiet", 'q', NULL, "print nothing", false},
};

/* What a film is made of, and where it goes: to `part`, which becomes `out`. */
struct film {
    const char *folder;
    double rate; /* pictures a second */
    bool webm;
    char out[PATH_BYTES], part[PATH_BYTES + 16]; /* absolute: ffmpeg works in the folder */
};

static double number_of(const struct cs_json *object, const char *key) {
    const struct cs_json *value = object ? cs_json_find(object, key) : NULL;
    return value && cs_json_kind_of(value) == CS_JSON_NUMBER ? cs_json_number(value) : 0;
}

/* The scene's frames a second over the step from one drawn frame to the next; 0: no pictures.
 */
static double rate_of(const struct cs_json *report) {
    const struct cs_json *scene = cs_json_find(report, "scene"),
                         *frames = cs_json_find(report, "frames");
    double drawn[2] = {0, 0};
    int n = 0;
    if (!scene || !frames)
        return 0;
    for (const struct cs_json *f = cs_json_first(frames); f && n < 2; f = cs_json_next(f)) {
        const struct cs_json *is = cs_json_find(f, "drawn");
        if (is && cs_json_kind_of(is) == CS_JSON_BOOL && cs_json_is_true(is))
            drawn[n++] = number_of(f, "number");
    }
    const double fps = number_of(cs_json_find(scene, "time"), "fps");
    return n == 0 ? 0 : fps / (n == 2 ? drawn[1] - drawn[0] : 1);
}

/* run.json in the folder says how fast the pictures follow each other, and that there are some
 */
static enum cs_status read_rate(struct film *film, struct cs_error *error) {
    char path[PATH_BYTES], *text;
    size_t length;
    struct cs_json *report;
    struct cs_json_fault fault;
    snprintf(path, sizeof path, "%.4000s/run.json", film->folder);
    if (cs_file_read(path, CS_JSON_BYTES_MAX, &text, &length, error))
        return error->status;
    cs_json_parse(text, length, &report, &fault);
    free(text);
    if (report)
        film->rate = rate_of(report);
    cs_json_destroy(report);
    if (!(film->rate > 0))
        return cs_fail(error, CS_ERR_FILE,
                       "%s: expected the report of a run that drew pictures", path);
    return CS_OK;
}

/* Where the film goes, by its ending what it is; the part keeps the ending, which ffmpeg reads.
 */
static enum cs_status place(const struct cs_args *args, struct film *film,
                            struct cs_error *error) {
    const char *name = cs_args_get(args, FILM_OUT);
    char made[PATH_BYTES], here[PATH_BYTES] = "";
    snprintf(made, sizeof made, "%.4000s/film.mp4", film->folder);
    const char *out = name ? name : made, *ending = strrchr(out, '.');
    film->webm = ending && !strcmp(ending, ".webm");
    if (!film->webm && (!ending || strcmp(ending, ".mp4")))
        return cs_fail(error, CS_ERR_USAGE,
                       "--out: expected a name that ends in .mp4 or .webm, found \"%.60s\"",
                       out);
    if (*out != '/' && !getcwd(here, sizeof here))
        return cs_fail(error, CS_ERR_FILE, "cannot tell the current folder");
    if (snprintf(film->out, sizeof film->out, "%s%s%s", here, *here ? "/" : "", out) >=
        PATH_BYTES)
        return cs_fail(error, CS_ERR_FILE, "\"%.60s...\": the path is too long", out);
    snprintf(film->part, sizeof film->part, "%s.part%s", film->out, ending);
    return cs_args_get(args, FILM_OVERWRITE) ? CS_OK : cs_output_check_file(out, error);
}

enum { ARGUMENTS = 48 };

/* The line for ffmpeg, closed by NULL. A damaged picture is an error. The colours are told as
 * those of ITU-R BT.709, which players take for them; an odd size is padded by a pixel, as
 * 4:2:0 asks for. */
static void fill(const struct film *film, const char *rate, const char *out,
                 const char *arguments[ARGUMENTS]) {
    static const char *const before[] = {"ffmpeg",   "-loglevel", "error",     "-xerror",
                                         "-nostdin", "-y",        "-framerate"};
    static const char *const between[] = {
        "-pattern_type",
        "glob",
        "-i",
        "frame_*.png",
        "-vf",
        "pad=ceil(iw/2)*2:ceil(ih/2)*2,scale=out_color_matrix=bt709:out_range=tv",
        "-pix_fmt",
        "yuv420p",
        "-colorspace",
        "bt709",
        "-color_primaries",
        "bt709",
        "-color_trc",
        "bt709"};
    static const char *const mp4[] = {"-c:v", "libx264",   "-crf",
                                      "18",   "-movflags", "+faststart"};
    static const char *const webm[] = {"-c:v", "libvpx-vp9", "-crf", "24", "-b:v", "0"};
    size_t n = sizeof before / sizeof *before;
    memcpy(arguments, before, sizeof before);
    arguments[n++] = rate;
    memcpy(arguments + n, between, sizeof between);
    n += sizeof between / sizeof *between;
    memcpy(arguments + n, film->webm ? webm : mp4, sizeof mp4);
    n += sizeof mp4 / sizeof *mp4;
    arguments[n++] = out;
    arguments[n] = NULL;
}

/* a word as it is typed: what a shell reads otherwise is quoted */
static void add_word(struct cs_text *line, const char *word) {
    if (!strpbrk(word, "*()' $&;\"\\")) {
        cs_text_add(line, " %s", word);
        return;
    }
    cs_text_add(line, " '");
    for (const char *c = word; *c; c++)
        cs_text_add(line, "%.*s", *c == '\'' ? 4 : 1, *c == '\'' ? "'\\''" : c);
    cs_text_add(line, "'");
}

static enum cs_status refuse(const struct film *film, const char *const *arguments,
                             struct cs_error *error) {
    struct cs_text line = {0};
    add_word(&line, film->folder);
    cs_text_add(&line, " &&");
    for (const char *const *a = arguments; *a; a++)
        add_word(&line, *a);
    cs_fail(error, CS_ERR_FILE, "ffmpeg is not installed; once it is, type: cd%s",
            cs_text_get(&line));
    cs_text_finish(&line);
    return error->status;
}

static enum cs_status make(const struct film *film, struct cs_error *error) {
    const volatile sig_atomic_t *stop = cs_interrupt_catch();
    const char *arguments[ARGUMENTS];
    struct cs_program_end end;
    char rate[32];
    snprintf(rate, sizeof rate, "%.15g", film->rate);
    fill(film, rate, film->part, arguments);
    if (cs_program_run(film->folder, arguments, false, &end, error))
        return error->status;
    if (!end.found) {
        fill(film, rate, film->out, arguments);
        return refuse(film, arguments, error);
    }
    if (end.done && !rename(film->part, film->out))
        return CS_OK;
    remove(film->part);
    return *stop ? cs_fail(error, CS_ERR_INTERRUPT, "interrupted; there is no film")
                 : cs_fail(error, CS_ERR_FILE, "%s: ffmpeg could not make it", film->out);
}

static enum cs_status film(struct cs_args *args, struct cs_error *error) {
    struct film film = {.folder = args->operands[0]};
    struct cs_text text = {0};
    double rate = 0;
    if (read_rate(&film, error) || cs_args_real(args, FILM_FPS, &rate, error) ||
        place(args, &film, error))
        return error->status;
    if (rate > 0)
        film.rate = rate;
    if (make(&film, error) || cs_args_get(args, FILM_QUIET))
        return error->status;
    cs_text_add(&text, "%s: %g pictures a second\n", film.out, film.rate);
    return cs_print_out(stdout, &text, error);
}

const struct cs_command cs_command_film = {
    .name = "film",
    .operands = "DIR",
    .summary = "make a film of the pictures of a run",
    .notes = "DIR is the folder that clothsim run wrote. ffmpeg makes the film.\n\n"
             "Example: clothsim film out -o cloth.webm\n",
    .rows = rows,
    .n_rows = FILM_ROWS,
    .least = 1,
    .most = 1,
    .main = film,
};
