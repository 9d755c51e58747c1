/* clothsim new: starts an integrator module of a user's own.
 *
 *   NAME -> the template with its names replaced, and a Makefile -> a folder
 * The template is plugins/template.c, whose lines are built in. */
#include "base/file.h"
#include "base/install_paths.h"
#include "cli/commands.h"
#include "cli/line/print.h"
#include "cli/run_folder.h"

#include <stdlib.h>
#include <string.h>

enum { NAME_MAX_BYTES = 40 };

struct options {
    const char *folder;
    bool overwrite;
};
static const struct options defaults;

static const struct cs_arg rows[] = {
    {"out", 'o', "DIR", "folder for NAME.c and Makefile (default: NAME)",
     CS_ARG_INTO(struct options, folder)},
    {"overwrite", 'y', NULL, "replace these files", CS_ARG_INTO(struct options, overwrite)},
};

static const char *const template_lines[] = {
#include <template_lines.h>
};
/* The method and the file of the template. */
static const char method[] = "midpoint", file[] = "template.";

static const char letters[] = "abcdefghijklmnopqrstuvwxyz",
                  name_bytes[] = "abcdefghijklmnopqrstuvwxyz0123456789-";

static enum cs_status check_name(const char *kind, const char *name, struct cs_error *error) {
    const size_t length = strlen(name);
    if (strcmp(kind, "integrator") != 0)
        return cs_fail(error, CS_ERR_USAGE, "new: found \"%s\", expected integrator", kind);
    if (!strchr(letters, name[0]) || strspn(name, name_bytes) != length ||
        length > NAME_MAX_BYTES)
        return cs_fail(
            error, CS_ERR_USAGE,
            "new integrator: found \"%s\", expected at most %d small letters, digits "
            "and -, a letter first",
            name, NAME_MAX_BYTES);
    return CS_OK;
}

/* Adds a line of the template. The method's name stays where the line describes it, and is an
 * identifier in code. */
static void add_line(const char *line, const char *name, const char *identifier,
                     struct cs_text *out) {
    while (*line) {
        const char *end = line + strlen(method);
        const bool begins =
            !strncmp(line, method, strlen(method)) && strncmp(end, " method", 7);
        if (begins) {
            const bool is_word = *end == '"' || *end == ':' || *end == '\n';
            cs_text_add(out, "%s", is_word ? name : identifier);
            line = end;
        } else if (!strncmp(line, file, strlen(file))) {
            cs_text_add(out, "%s.", name);
            line += strlen(file);
        } else {
            cs_text_add(out, "%c", *line++);
        }
    }
}

/* The identifier ends in "_method": no keyword does, and no function of the template. */
static void add_source(const char *name, struct cs_text *out) {
    char identifier[NAME_MAX_BYTES + 8];
    snprintf(identifier, sizeof identifier, "%s_method", name);
    for (char *byte = identifier; *byte; byte++)
        *byte = *byte == '-' ? '_' : *byte;
    for (size_t k = 0; k < sizeof template_lines / sizeof template_lines[0]; k++)
        add_line(template_lines[k], name, identifier, out);
}

/* Adds the flag that finds the headers: of the source tree that this program was built in, else
 * of the installed package. */
static void add_headers(struct cs_text *out) {
    char path[CS_DATA_PATH_MAX];
    snprintf(path, sizeof path, "%s/../../include/clothsim", cs_module_folder());
    char *headers = realpath(path, NULL);
    /* no character that make or the shell reads as something else */
    if (headers && !headers[strspn(headers, "/._+-0123456789abcdefghijklmnopqrstuvwxyz"
                                            "ABCDEFGHIJKLMNOPQRSTUVWXYZ")])
        cs_text_add(out, "CPPFLAGS += -I%s/..\n", headers);
    else
        cs_text_add(out, "CPPFLAGS += $(shell pkg-config --cflags clothsim)\n");
    free(headers);
}

static void add_makefile(const char *name, struct cs_text *out) {
    cs_text_add(out,
                "# make: builds %s.so; make test: measures what the method claims\n"
                "CLOTHSIM ?= clothsim\n"
                "CFLAGS ?= -O2 -Wall -Wextra\n",
                name);
    add_headers(out);
    cs_text_add(
        out,
        "\n%s.so: %s.c\n"
        "\t$(CC) -std=c17 $(CPPFLAGS) $(CFLAGS) -ffp-contract=off -shared -fPIC -o $@ $< -lm\n"
        "\ntest: %s.so\n"
        "\t$(CLOTHSIM) conform ./%s.so\n"
        "\n.PHONY: test\n",
        name, name, name, name);
}

static enum cs_status start_module(struct cs_args *args, struct cs_error *error) {
    const struct options *options = args->options;
    const char *name = args->operands[1];
    const char *folder = options->folder ? options->folder : name;
    struct cs_text source = {0}, makefile = {0}, out = {0};
    char source_path[4096], makefile_path[4096];
    snprintf(source_path, sizeof source_path, "%.3900s/%.*s.c", folder, NAME_MAX_BYTES, name);
    snprintf(makefile_path, sizeof makefile_path, "%.3900s/Makefile", folder);
    if (check_name(args->operands[0], name, error) ||
        (!options->overwrite && (cs_output_check_file(source_path, error) ||
                                 cs_output_check_file(makefile_path, error))) ||
        cs_folder_create(folder, error))
        return error->status;
    add_source(name, &source);
    if (cs_file_write_text(source_path, &source, error))
        return error->status;
    add_makefile(name, &makefile);
    if (cs_file_write_text(makefile_path, &makefile, error))
        return error->status;
    cs_text_add(&out,
                "%s holds the explicit midpoint method: put yours into its functions step and "
                "limit\n"
                "  cd %s && make\n"
                "  clothsim run SCENE.json -p ./%s.so -i %s\n"
                "  make test\n",
                source_path, folder, name, name);
    return cs_print_out(stdout, &out, error);
}

const struct cs_command cs_command_new = {
    .name = "new",
    .operands = "integrator NAME",
    .summary = CS_SUMMARY_new,
    .notes =
        "Writes a folder with the source of a method that runs, which you change into your\n"
        "own, and a Makefile that builds and tests it: clothsim-integrator(7).\n\n"
        "Example: clothsim new integrator heun\n",
    CS_COMMAND_OPTIONS(rows, defaults),
    .operands_min = 2,
    .operands_max = 2,
    .main = start_module,
};
