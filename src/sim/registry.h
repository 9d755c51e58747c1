/* registry.h - the integrator modules: where they are looked for, and why one is refused. */
#ifndef CS_REGISTRY_H
#define CS_REGISTRY_H

#include "base/arena.h"
#include "base/status.h"
#include "sim/install_paths.h"

#include <clothsim/integrator.h>

/* One integrator that can be used, or one module file that cannot. */
struct cs_registry_entry {
    const char *file;                       /* absolute path of the module */
    const struct cs_integrator *integrator; /* NULL: refused */
    const char *refusal;                    /* why; NULL: it can be used */
};

/* Zeroed: empty. */
struct cs_registry {
    struct cs_registry_entry *entries; /* sorted by integrator name, refused ones last */
    uint32_t n, capacity;
    struct cs_arena arena;
};

/* Adds one module file (--plugin). A refused file is an error here: CS_ERR_MODULE. */
enum cs_status cs_registry_add_file(struct cs_registry *registry, const char *file,
                                    struct cs_error *error);

/* Adds n module files, until one is refused. */
enum cs_status cs_registry_add_files(struct cs_registry *registry, const char *const *files,
                                     uint32_t n, struct cs_error *error);

/* Finds an integrator by name: files that were added first, then the modules in the folders
 * (the build's or the installed one, then CLOTHSIM_PLUGIN_PATH; absolute folders only) by their
 * names. First comes the module that the build's own list, modules.txt, names. Else only a
 * module whose bytes hold the name is opened, and none after the one that has the integrator:
 * opening loads libraries. CS_ERR_USAGE with the nearest name where
 * there is none, or with the library that the build was made without; CS_ERR_MODULE with the
 * reason where it was refused. */
enum cs_status cs_registry_find(struct cs_registry *registry, const char *name,
                                const struct cs_registry_entry **found, struct cs_error *error);

/* Adds a module file as cs_registry_add_file does and gives its first integrator. */
enum cs_status cs_registry_find_in(struct cs_registry *registry, const char *file,
                                   const struct cs_registry_entry **found,
                                   struct cs_error *error);

/* Opens every module of the folders, for the list. */
enum cs_status cs_registry_open_all(struct cs_registry *registry, struct cs_error *error);
/* Does so and lists the names of the integrators, (*n) and a NULL. others: also of those that
 * do not follow the scene's equation of motion. The list is the registry's; NULL: it failed. */
const char *const *cs_registry_names(struct cs_registry *registry, bool others, uint32_t *n,
                                     struct cs_error *error);

void cs_registry_finish(struct cs_registry *registry);

#endif
