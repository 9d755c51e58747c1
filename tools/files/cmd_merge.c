/* clothsim merge: merges the folders of studies that several processes filled.
 *
 *   folders -> compare.csv, sweep.csv by rows; origin.json by copy; *.partial by appending
 *
 * A merged map is completed by repeating its command on the merged folder. */
#include "base/file.h"
#include "borders/stability_state.h"
#include "cli/commands.h"
#include "cli/line/print.h"
#include "cli/manifest.h"
#include "study/compare/compare_state.h"
#include "sweep/parameter_sweep.h"

#include <dirent.h>
#include <fnmatch.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { FILE_BYTES_MAX = 1 << 30 };

struct options {
    const char *out;
    bool overwrite, unchecked, quiet;
};
static const struct options defaults = {.out = "merged"};

static const struct cs_arg rows[] = {
    {"out", 'o', "DIR", "folder of the result (default: merged)",
     CS_ARG_INTO(struct options, out)},
    {"overwrite", 'y', NULL, "replace the results of an earlier merge",
     CS_ARG_INTO(struct options, overwrite)},
    {"unchecked", 0, NULL,
     "accept tables without the column check, such as those of earlier versions; their rows "
     "are not verified",
     CS_ARG_INTO(struct options, unchecked)},
    CS_ARG_QUIET(struct options, quiet),
};

/* The files of a study that are merged. */
static const char *const merged[] = {"compare.csv", "sweep.csv", "origin.json", "*.partial"};
enum { MERGED = sizeof merged / sizeof *merged };

/* Copies the provenance of a comparison; every part has the same. */
static enum cs_status copy_origin(const char *folder, const char *out, struct cs_error *error) {
    char from[4096], to[4096];
    char *bytes;
    size_t length;
    snprintf(from, sizeof from, "%s/origin.json", folder);
    snprintf(to, sizeof to, "%s/origin.json", out);
    if (access(from, F_OK) || cs_file_read(from, FILE_BYTES_MAX, &bytes, &length, error))
        return error->status;
    cs_file_write(to, bytes, length, error);
    free(bytes);
    return error->status;
}

/* Refuses folders of which some hold a comparison and others a sweep. */
static enum cs_status check_kinds(const char *const *folders, uint32_t n,
                                  struct cs_error *error) {
    const char *with[2] = {NULL, NULL};
    char path[4096];
    for (uint32_t k = 0; k < n; k++)
        for (int kind = 0; kind < 2; kind++) {
            snprintf(path, sizeof path, "%s/%s", folders[k], merged[kind]);
            with[kind] = access(path, F_OK) ? with[kind] : folders[k];
        }
    return with[0] && with[1]
               ? cs_fail(error, CS_ERR_USAGE,
                         "%s holds a comparison and %s a sweep: merge them apart", with[0],
                         with[1])
               : CS_OK;
}

/* Removes what an earlier merge wrote: tables, provenance and parts of maps. */
static enum cs_status remove_earlier(const char *out, struct cs_error *error) {
    DIR *directory = opendir(out);
    char path[4096];
    for (const struct dirent *entry; directory && (entry = readdir(directory));)
        for (size_t k = 0; k < MERGED && !error->status; k++) {
            snprintf(path, sizeof path, "%s/%s", out, entry->d_name);
            if (!fnmatch(merged[k], entry->d_name, 0))
                cs_file_remove(path, error);
        }
    if (directory)
        closedir(directory);
    return error->status;
}

static enum cs_status merge(struct cs_args *args, struct cs_error *error) {
    const struct options *options = args->options;
    const char *out = options->out, *const *folders = args->operands;
    const uint32_t n = args->n_operands;
    uint32_t cells = 0, rows_of_sweep = 0, maps = 0;
    for (uint32_t k = 0; k < n; k++)
        if (!strcmp(folders[k], out))
            return cs_fail(error, CS_ERR_USAGE,
                           "%s is both a part and the result: give another folder with --out",
                           out);
    check_kinds(folders, n, error);
    for (uint32_t k = 0; k < n * MERGED && !error->status; k++)
        cs_manifest_check_files(folders[k / MERGED], merged[k % MERGED], error);
    if (error->status)
        return error->status;
    if (options->overwrite && remove_earlier(out, error))
        return error->status;
    if (cs_compare_results_merge(folders, n, out, options->unchecked, &cells, error) ||
        cs_parameter_sweep_merge(folders, n, out, options->unchecked, &rows_of_sweep, error))
        return error->status;
    cells += rows_of_sweep;
    for (uint32_t k = 0; k < n && !error->status; k++)
        copy_origin(folders[k], out, error);
    if (error->status || cs_journal_merge(folders, n, out, &maps, error))
        return error->status;
    if (cells + maps == 0)
        return cs_fail(
            error, CS_ERR_FILE,
            "no folder contains a compare.csv, a sweep.csv or the .partial of a map");
    if (cs_manifest_write_study(out, error))
        return error->status;
    struct cs_text text = {0};
    cs_text_add(&text, "%u cells and %u parts of maps from %u folders in ", cells, maps, n);
    cs_text_add_plain(&text, out);
    cs_text_add(&text, "\n");
    return options->quiet ? (cs_text_finish(&text), CS_OK) : cs_print_out(stdout, &text, error);
}

const struct cs_command cs_command_merge = {
    .name = "merge",
    .operands = "DIR...",
    .summary = "merge the shards of a comparison, a sweep or a map",
    .notes =
        "Afterwards the command of the study, without --shard and with -o DIR, writes the\n"
        "report or map of all shards.\n"
        "\n"
        "Example: clothsim merge part1 part2 -o whole\n",
    CS_COMMAND_OPTIONS(rows, defaults),
    .operands_min = 1,
    .operands_max = 10000,
    .main = merge,
};
