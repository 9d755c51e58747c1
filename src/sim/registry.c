/* registry.c - finds integrators by name among the module files, and opens as few of them as
 * possible. */
#include "sim/registry.h"

#include "base/file.h"
#include "sim/module.h"

#include <dirent.h>
#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* A larger file is opened without a search through its bytes. */
enum { MODULE_BYTES_MAX = 256 << 20 };

/* Appends an entry; file, program and refusal are copied. Doubles the capacity when it is full.
 */
static enum cs_status add_entry(struct cs_registry *registry, const char *file,
                                const char *program, const struct cs_integrator *integrator,
                                const char *refusal, struct cs_error *error) {
    if (registry->n == registry->capacity) {
        const uint32_t capacity = 2 * registry->capacity + 32;
        /* an arena cannot grow an array: the old one stays until finish */
        struct cs_registry_entry *entries =
            cs_arena_alloc_array(&registry->arena, capacity, sizeof *entries, error);
        if (!entries)
            return error->status;
        if (registry->n > 0)
            memcpy(entries, registry->entries, registry->n * sizeof *entries);
        registry->entries = entries;
        registry->capacity = capacity;
    }
    const struct cs_registry_entry entry = {
        .file = cs_arena_copy_text(&registry->arena, file, error),
        .program = program ? cs_arena_copy_text(&registry->arena, program, error) : NULL,
        .integrator = integrator,
        .refusal = refusal ? cs_arena_copy_text(&registry->arena, refusal, error) : NULL,
    };
    registry->entries[registry->n++] = entry;
    return error->status;
}

/* The entry of an integrator that can be used, or NULL. */
static const struct cs_registry_entry *find_entry(const struct cs_registry *registry,
                                                  const char *name) {
    for (uint32_t k = 0; k < registry->n; k++)
        if (registry->entries[k].integrator &&
            (!strcmp(registry->entries[k].integrator->name, name) ||
             (registry->entries[k].program && !strcmp(registry->entries[k].program, name))))
            return registry->entries + k;
    return NULL;
}

/* True if a module file has an entry, also as refused. */
static bool was_opened(const struct cs_registry *registry, const char *file) {
    for (uint32_t k = 0; k < registry->n; k++)
        if (!strcmp(registry->entries[k].file, file))
            return true;
    return false;
}

/* Opens a module and adds an entry per integrator. A refused module becomes one entry with
 * the reason. A name that is taken stays with the first module. */
static enum cs_status open_module(struct cs_registry *registry, const char *file,
                                  struct cs_error *error) {
    if (was_opened(registry, file))
        return CS_OK;
    struct cs_error refusal = {0};
    const struct cs_module *module;
    cs_module_open(file, &module, &refusal);
    /* out of memory is no fault of the module's, and ends the search */
    if (refusal.status == CS_ERR_MEMORY)
        return cs_fail(error, refusal.status, "%s: %s", file, refusal.message);
    if (refusal.status)
        return add_entry(registry, file, NULL, NULL, refusal.message, error);
    for (uint32_t k = 0; k < module->n && !error->status; k++) {
        const struct cs_integrator *integrator = module->integrators[k];
        const struct cs_registry_entry *first = find_entry(registry, integrator->name);
        char why[PATH_MAX + 128];
        snprintf(why, sizeof why, "integrator \"%s\" is already in %s", integrator->name,
                 first ? first->file : "");
        add_entry(registry, file, NULL, first ? NULL : integrator, first ? why : NULL, error);
    }
    return error->status;
}

static enum cs_status open_listed(struct cs_registry *registry, const char *name,
                                  struct cs_error *error);

/* Starts a program, or reads a tableau, and adds it, unless it is there. A tableau takes no
 * name of the build's own methods: it has no option that would give it another one. */
static enum cs_status add_program(struct cs_registry *registry, const char *text,
                                  struct cs_error *error) {
    const struct cs_integrator *integrator;
    const char *file;
    const bool tableau = !strncmp(text, "tableau:", strlen("tableau:"));
    if (find_entry(registry, text) || cs_program_method_open(text, &integrator, &file, error) ||
        (tableau && open_listed(registry, integrator->name, error)))
        return error->status;
    const struct cs_registry_entry *first = find_entry(registry, integrator->name);
    if (first)
        return cs_fail(
            error, CS_ERR_USAGE, "\"%.200s\": integrator \"%s\" is already in %s, expected %s",
            text, integrator->name, first->file,
            tableau ? "another name in the file" : "--program NAME=COMMAND with another name");
    return add_entry(registry, file, text, integrator, NULL, error);
}

enum cs_status cs_registry_add_file(struct cs_registry *registry, const char *file,
                                    struct cs_error *error) {
    char absolute[PATH_MAX];
    if (cs_names_program(file))
        return add_program(registry, file, error);
    if (!realpath(file, absolute))
        return cs_fail(error, CS_ERR_MODULE, "%s: no such module file", file);
    const uint32_t before = registry->n;
    if (open_module(registry, absolute, error))
        return error->status;
    for (uint32_t k = before; k < registry->n; k++)
        if (registry->entries[k].refusal)
            return cs_fail(error, CS_ERR_MODULE, "%s: %s", file, registry->entries[k].refusal);
    return CS_OK;
}

enum cs_status cs_registry_add_files(struct cs_registry *registry, const char *const *files,
                                     uint32_t n, struct cs_error *error) {
    for (uint32_t k = 0; k < n && !error->status; k++)
        cs_registry_add_file(registry, files[k], error);
    return error->status;
}

/* True if the file's bytes contain the name as a whole string, with its zero: the module may
 * then have the integrator. Reading a file is cheaper and safer than opening it, which loads
 * its libraries. */
static bool may_contain_name(const char *file, const char *name) {
    struct cs_error ignored = {0};
    char *bytes;
    size_t length;
    if (cs_file_read(file, MODULE_BYTES_MAX, &bytes, &length, &ignored))
        return true; /* opening it will say what is wrong */
    const bool holds = memmem(bytes, length, name, strlen(name) + 1) != NULL;
    free(bytes);
    return holds;
}

/* Filter of scandir. */
static int is_module_name(const struct dirent *entry) {
    return cs_names_code(entry->d_name);
}

/* Opens the modules of a folder in the order of their names. With a name: only those that may
 * contain it, until one has the integrator. A folder that is not there is empty. */
static enum cs_status open_folder(struct cs_registry *registry, const char *folder,
                                  const char *name, struct cs_error *error) {
    struct dirent **entries;
    const int n = scandir(folder, &entries, is_module_name, alphasort);
    if (n < 0 && errno == ENOMEM)
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for the list of modules");
    for (int k = 0; k < n; k++) {
        char file[PATH_MAX];
        const int length = snprintf(file, sizeof file, "%s/%s", folder, entries[k]->d_name);
        const bool found = name && find_entry(registry, name);
        if (!error->status && length < (int)sizeof file && !found &&
            (!name || may_contain_name(file, name)))
            open_module(registry, file, error);
        free(entries[k]);
    }
    if (n >= 0)
        free(entries);
    return error->status;
}

/* Moves to the next line "NAME WORDS" of a list that the build wrote to its module folder,
 * and sets *words to the rest after NAME. With name NULL any line counts. Returns false at
 * the end. */
static bool next_words(char **rest, const char *name, const char **words) {
    for (char *line; (line = strsep(rest, "\n"));) {
        const char *found = strsep(&line, " ");
        *words = line;
        if (line && (!name || !strcmp(found, name)))
            return true;
    }
    return false;
}

/* The text of such a list, which the caller frees; NULL if there is none. */
static char *read_list(const char *list) {
    struct cs_error unread = {0};
    char path[PATH_MAX], *text;
    size_t length;
    snprintf(path, sizeof path, "%.4000s/%s", cs_module_folder(), list);
    return cs_file_read(path, 1 << 16, &text, &length, &unread) ? NULL : text;
}

/* Opens the build's own modules by modules.txt; with a name only the one listed for it. */
static enum cs_status open_listed(struct cs_registry *registry, const char *name,
                                  struct cs_error *error) {
    char *text = read_list("modules.txt"), *rest = text;
    const char *module;
    while (!error->status && next_words(&rest, name, &module)) {
        char file[PATH_MAX];
        snprintf(file, sizeof file, "%.4000s/%.64s", cs_module_folder(), module);
        if (!strchr(module, '/') && access(file, F_OK) == 0)
            open_module(registry, file, error);
    }
    free(text);
    return error->status;
}

/* Searches all places in their order: the build's list, its folder, CLOTHSIM_PLUGIN_PATH. */
static enum cs_status open_folders(struct cs_registry *registry, const char *name,
                                   struct cs_error *error) {
    if (open_listed(registry, name, error) || (name && find_entry(registry, name)) ||
        open_folder(registry, cs_module_folder(), name, error))
        return error->status;
    const char *list = getenv("CLOTHSIM_PLUGIN_PATH");
    while (list && *list && !error->status) {
        const size_t length = strcspn(list, ":");
        char folder[PATH_MAX];
        /* absolute folders only: no code from the working folder by accident */
        if (*list == '/' && length < sizeof folder) {
            memcpy(folder, list, length);
            folder[length] = 0;
            open_folder(registry, folder, name, error);
        }
        list += length + (list[length] == ':');
    }
    return error->status;
}

/* Order of qsort: by integrator name, refused files last and by path. */
static int by_name(const void *left, const void *right) {
    const struct cs_registry_entry *a = left, *b = right;
    if (!a->integrator != !b->integrator)
        return a->integrator ? -1 : 1;
    return a->integrator ? strcmp(a->integrator->name, b->integrator->name)
                         : strcmp(a->file, b->file);
}

enum cs_status cs_registry_open_all(struct cs_registry *registry, struct cs_error *error) {
    if (open_folders(registry, NULL, error))
        return error->status;
    if (registry->n > 0)
        qsort(registry->entries, registry->n, sizeof *registry->entries, by_name);
    return CS_OK;
}

const char *const *cs_registry_names(struct cs_registry *registry, bool others, uint32_t *n,
                                     struct cs_error *error) {
    const char **names = NULL;
    *n = 0;
    if (!cs_registry_open_all(registry, error))
        names = cs_arena_alloc_array(&registry->arena, registry->n + 1, sizeof *names, error);
    for (uint32_t k = 0; names && k < registry->n; k++) {
        const struct cs_integrator *integrator = registry->entries[k].integrator;
        if (integrator && (others || integrator->fidelity != CS_FIDELITY_OTHER))
            names[(*n)++] = integrator->name;
    }
    return names;
}

/* The library that a method needs and this build lacks, or NULL. The text is the registry's. */
static const char *find_left_out(struct cs_registry *registry, const char *name,
                                 struct cs_error *error) {
    char *text = read_list("left-out.txt"), *rest = text;
    const char *words, *library = NULL;
    if (next_words(&rest, name, &words))
        library = cs_arena_copy_text(&registry->arena, words, error);
    free(text);
    return library;
}

/* The methods that another name of the literature stands for, or NULL. */
static const char *translate_name(const char *name) {
    static const char *const names[][2] = {
        {"euler", "explicit-euler\", \"symplectic-euler\" or \"backward-euler"},
        {"forward-euler", "explicit-euler"},
        {"implicit-euler", "implicit-linearised\" or \"backward-euler"},
        {"semi-implicit-euler", "symplectic-euler"},
        {"baraff-witkin", "implicit-linearised"},
        {"implicit", "implicit-linearised\" or \"backward-euler"},
        {"verlet", "velocity-verlet\" or \"position-verlet"},
        {"stoermer-verlet", "position-verlet"},
        {"stormer-verlet", "velocity-verlet\" or \"position-verlet"},
        {"cvode", "cvode-bdf\" or \"cvode-adams"},
        {"leapfrog", "velocity-verlet"},
        {"midpoint", "implicit-midpoint"},
        {"trapezoidal", "newmark"},
        {"crank-nicolson", "newmark"},
        {"rk", "rk4"},
        {"runge-kutta", "rk4"},
        {"rk45", "dopri5"},
        {"ode45", "dopri5"},
        {"bdf", "bdf2\" or \"cvode-bdf"},
        {"pbd", "xpbd"},
        {"pd", "projective-dynamics"},
        {"hht", "newmark"},
        {"generalised-alpha", "newmark"},
        {"generalized-alpha", "newmark"}};
    for (size_t k = 0; k < sizeof names / sizeof *names; k++)
        if (!strcmp(name, names[k][0]))
            return names[k][1];
    return NULL;
}

/* The error for a name that no module has: the missing library, else the nearest name. */
static enum cs_status unknown_name(struct cs_registry *registry, const char *name,
                                   struct cs_error *error) {
    uint32_t n;
    if (cs_names_program(name))
        return cs_fail(error, CS_ERR_USAGE,
                       "found \"%.60s\", expected a name: only -i and --program start one",
                       name);
    const char *const *names = cs_registry_names(registry, true, &n, error);
    if (!names)
        return error->status;
    const bool is_automatic = !strcmp(name, "automatic");
    if (is_automatic || !strcmp(name, "all"))
        return cs_fail(error, CS_ERR_USAGE,
                       "found integrator \"%s\", expected the name of one (%s)", name,
                       is_automatic ? "automatic chooses by the scene, and takes no options"
                                    : "all is for advise, compare, stability and sweep");
    const char *other = translate_name(name);
    const char *nearest = other ? other : cs_nearest_word(name, names);
    const char *library = find_left_out(registry, name, error);
    if (library)
        return cs_fail(error, CS_ERR_USAGE,
                       "integrator \"%s\" needs %s, which this clothsim was built without",
                       name, library);
    return cs_fail(
        error, CS_ERR_USAGE, "no integrator \"%.60s\"%s%s%s (see: clothsim integrators)", name,
        nearest ? "; did you mean \"" : "", nearest ? nearest : "", nearest ? "\"?" : "");
}

/* A module that was refused is blamed if its bytes contain the name: the user meant it. */
enum cs_status cs_registry_find(struct cs_registry *registry, const char *name,
                                const struct cs_registry_entry **found,
                                struct cs_error *error) {
    *found = find_entry(registry, name);
    if (!*found && open_folders(registry, name, error))
        return error->status;
    if (!*found)
        *found = find_entry(registry, name);
    if (*found)
        return CS_OK;
    for (uint32_t k = 0; k < registry->n; k++)
        if (registry->entries[k].refusal && may_contain_name(registry->entries[k].file, name))
            return cs_fail(error, CS_ERR_MODULE, "%s: %s", registry->entries[k].file,
                           registry->entries[k].refusal);
    return unknown_name(registry, name, error);
}

enum cs_status cs_registry_find_in(struct cs_registry *registry, const char *file,
                                   const struct cs_registry_entry **found,
                                   struct cs_error *error) {
    char absolute[PATH_MAX];
    if (cs_registry_add_file(registry, file, error))
        return error->status;
    for (uint32_t k = 0; k < registry->n && realpath(file, absolute); k++)
        if (registry->entries[k].integrator && !strcmp(registry->entries[k].file, absolute)) {
            *found = registry->entries + k;
            return CS_OK;
        }
    return cs_fail(error, CS_ERR_MODULE, "%s: it contains no integrator", file);
}

void cs_registry_finish(struct cs_registry *registry) {
    cs_arena_finish(&registry->arena);
    *registry = (struct cs_registry){0};
}
