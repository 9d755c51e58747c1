/* registry.h - the integrator modules: where they are searched, and why one is refused. */
#ifndef CS_REGISTRY_H
#define CS_REGISTRY_H

#include "base/arena.h"
#include "base/install_paths.h"
#include "base/status.h"

#include <clothsim/integrator.h>

/* One integrator that can be used, or one module file that cannot. */
struct cs_registry_entry {
    const char
        *file; /* absolute path of the module, or of a program (cs_program_method_open) */
    const char *program; /* "program:COMMAND" as it was added; NULL: a module */
    const struct cs_integrator *integrator; /* NULL: refused */
    const char *refusal;                    /* why; NULL: it can be used */
};

/* All integrators that were found so far. Zeroed: empty. Texts and entries are the arena's. */
struct cs_registry {
    struct cs_registry_entry *entries; /* sorted by integrator name, refused ones last */
    uint32_t n, capacity;
    struct cs_arena arena;
};

/* Adds one module file (--plugin), or starts one program and adds it (--program). A refused
 * file is an error here (CS_ERR_MODULE), unlike one that a folder holds. Only texts of the
 * command line may come here: this is the one door by which programs are started. */
enum cs_status cs_registry_add_file(struct cs_registry *registry, const char *file,
                                    struct cs_error *error);

/* Adds n module files and stops at the first that is refused. */
enum cs_status cs_registry_add_files(struct cs_registry *registry, const char *const *files,
                                     uint32_t n, struct cs_error *error);

/* Finds an integrator by name, or a program that was added by its "program:COMMAND". The order
 * of the search:
 * 1. Files and programs that were added before.
 * 2. The module that the build's own list, modules.txt, names for it.
 * 3. Modules in the folder of the build or of the installation, then in the absolute folders
 *    of CLOTHSIM_PLUGIN_PATH, by their file names.
 *
 * In folders only a module whose bytes contain the name is opened, and none after the one
 * that has the integrator: opening a module loads its libraries. Returns CS_ERR_USAGE with
 * the nearest name, or with the library that the build was made without; CS_ERR_MODULE with
 * the reason if it was refused. */
enum cs_status cs_registry_find(struct cs_registry *registry, const char *name,
                                const struct cs_registry_entry **found, struct cs_error *error);

/* Adds a module file as cs_registry_add_file does, and returns its first integrator in
 * *found. CS_ERR_MODULE if it has none. */
enum cs_status cs_registry_find_in(struct cs_registry *registry, const char *file,
                                   const struct cs_registry_entry **found,
                                   struct cs_error *error);

/* Opens every module of the folders and sorts the entries, for the list of integrators. */
enum cs_status cs_registry_open_all(struct cs_registry *registry, struct cs_error *error);
/* Opens every module and lists the names of the integrators: *n names, then NULL. others:
 * also those that do not follow the scene's equation of motion. The list is the registry's.
 * Returns NULL on failure. */
const char *const *cs_registry_names(struct cs_registry *registry, bool others, uint32_t *n,
                                     struct cs_error *error);

/* Releases the entries. Modules stay open. */
void cs_registry_finish(struct cs_registry *registry);

#endif
