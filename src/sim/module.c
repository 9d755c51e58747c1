/* module.c - opens an integrator module and checks it against the contract before it is
 * called. */
#include "sim/module.h"

#include "base/options.h"
#include "sim/crash.h"
#include "sim/process_state.h"

#include <dlfcn.h>
#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

/* True for 1 to 63 characters out of `letters`. */
static bool is_name(const char *name, const char *letters) {
    return name && *name && strlen(name) < 64 && !name[strspn(name, letters)];
}

/* The error about one option of an integrator. */
static enum cs_status refuse_option(const struct cs_integrator *integrator,
                                    const struct cs_option *option, const char *why,
                                    struct cs_error *error) {
    return cs_fail(error, CS_ERR_MODULE, "integrator \"%s\", option \"%.60s\": %s",
                   integrator->name, option->name ? option->name : "(no name)", why);
}

/* Checks a row of the option table: name, type, bounds of its field, texts, default. */
static enum cs_status check_option(const struct cs_integrator *integrator,
                                   const struct cs_option *option, struct cs_error *error) {
    /* the first four types are for modules; a foreign table may contain any number */
    const size_t size =
        (unsigned)option->type <= CS_CHOICE ? cs_value_kind_of(option)->size : 0;
    if (!is_name(option->name, "abcdefghijklmnopqrstuvwxyz0123456789_"))
        return refuse_option(integrator, option, "its name may contain only [a-z0-9_]", error);
    if (size == 0)
        return refuse_option(integrator, option, "its type is not allowed in modules", error);
    /* in this order the subtraction cannot wrap round */
    if (option->offset > integrator->options_size ||
        size > integrator->options_size - option->offset)
        return refuse_option(integrator, option, "it lies outside its struct", error);
    if (!option->help || !option->unit)
        return refuse_option(integrator, option, "it has no help or unit", error);
    /* written so that a NaN is refused */
    if (option->type == CS_CHOICE) {
        int32_t n = 0;
        while (option->choices && option->choices[n])
            n++;
        if (!(option->def >= 0) || option->def >= n)
            return refuse_option(integrator, option, "its default is none of its choices",
                                 error);
    } else if (option->type != CS_BOOL &&
               !(option->min <= option->def && option->def <= option->max)) {
        return refuse_option(integrator, option, "its default is outside its range", error);
    }
    return CS_OK;
}

/* The option with this name, or NULL. */
static const struct cs_option *find_option(const struct cs_integrator *integrator,
                                           const char *name) {
    for (uint32_t k = 0; name && k < integrator->n_options; k++)
        if (!strcmp(integrator->options[k].name, name))
            return integrator->options + k;
    return NULL;
}

/* Checks the dependencies of options: each names an option and a choice of its own table. */
static enum cs_status check_uses(const struct cs_integrator *integrator,
                                 struct cs_error *error) {
    const uint32_t n = CS_HAS(integrator, n_uses) ? integrator->n_uses : 0;
    for (uint32_t k = 0; k < n; k++) {
        const struct cs_option_use *use = integrator->uses ? integrator->uses + k : NULL;
        const struct cs_option *choice = use ? find_option(integrator, use->choice) : NULL;
        if (!choice || choice->type != CS_CHOICE || !find_option(integrator, use->option))
            return cs_fail(
                error, CS_ERR_MODULE,
                "integrator \"%s\": use %u names no option and choice of the integrator",
                integrator->name, k);
    }
    return CS_OK;
}

static enum cs_status check_renames(const struct cs_integrator *integrator,
                                    struct cs_error *error) {
    const uint32_t n = CS_HAS(integrator, n_renames) ? integrator->n_renames : 0;
    for (uint32_t k = 0; k < n; k++) {
        const struct cs_option_rename *rename =
            integrator->renames ? integrator->renames + k : NULL;
        if (!rename || !rename->old_name || find_option(integrator, rename->old_name) ||
            !find_option(integrator, rename->option))
            return cs_fail(error, CS_ERR_MODULE,
                           "integrator \"%s\": rename %u names no option of its own",
                           integrator->name, k);
    }
    return CS_OK;
}

/* Size of the struct in the first release of this interface. Fields after it are read only if
 * CS_HAS finds them. */
static const uint32_t least_size = offsetof(struct cs_integrator, goals);

enum cs_status cs_module_check_integrator(const struct cs_integrator *integrator,
                                          struct cs_error *error) {
    /* the name first: every message needs it */
    if (!integrator || !is_name(integrator->name, "abcdefghijklmnopqrstuvwxyz0123456789-"))
        return cs_fail(error, CS_ERR_MODULE, "an integrator's name may contain only [a-z0-9-]");
    if (integrator->size < least_size)
        return cs_fail(error, CS_ERR_MODULE, "integrator \"%s\": size %u, expected at least %u",
                       integrator->name, integrator->size, least_size);
    if (!integrator->summary || !integrator->source)
        return cs_fail(error, CS_ERR_MODULE, "integrator \"%s\": no summary or source",
                       integrator->name);
    if (!integrator->create || !integrator->restart || !integrator->advance)
        return cs_fail(error, CS_ERR_MODULE,
                       "integrator \"%s\": create, restart or advance is missing",
                       integrator->name);
    if (integrator->n_options > 0 && !integrator->options)
        return cs_fail(error, CS_ERR_MODULE, "integrator \"%s\": no option table",
                       integrator->name);
    for (uint32_t k = 0; k < integrator->n_options; k++)
        if (check_option(integrator, integrator->options + k, error))
            return error->status;
    return check_uses(integrator, error) ? error->status : check_renames(integrator, error);
}

/* Checks version, sizes, and each integrator of a module. */
static enum cs_status check_module(const struct cs_module *module, struct cs_error *error) {
    if (module->abi != CS_ABI)
        return cs_fail(error, CS_ERR_MODULE, "made for interface %u, expected %u", module->abi,
                       CS_ABI);
    if (module->size < least_size)
        return cs_fail(error, CS_ERR_MODULE, "integrator structs of %u bytes, expected %u",
                       module->size, least_size);
    if (module->n == 0 || !module->integrators)
        return cs_fail(error, CS_ERR_MODULE, "contains no integrator");
    for (uint32_t k = 0; k < module->n; k++)
        if (cs_module_check_integrator(module->integrators[k], error))
            return error->status;
    return CS_OK;
}

/* Refuses a file that anyone may write, itself or by its folder: others could have put code
 * there. Anything but a regular file could hang or crash the loader. A folder with the sticky
 * bit, such as /tmp, lets only owners replace files. */
static enum cs_status check_file(const char *file, struct cs_error *error) {
    struct stat info, folder;
    char path[PATH_MAX];
    const char *end = strrchr(file, '/');
    snprintf(path, sizeof path, "%.*s", end ? (int)(end - file) : 1, end ? file : ".");
    if (stat(file, &info) || stat(*path ? path : "/", &folder))
        return cs_fail(error, CS_ERR_MODULE, "cannot be examined: %s", strerror(errno));
    if (!S_ISREG(info.st_mode))
        return cs_fail(error, CS_ERR_MODULE, "is not a regular file");
    if (info.st_mode & S_IWOTH)
        return cs_fail(error, CS_ERR_MODULE, "is world-writable; run chmod o-w on it first");
    if ((folder.st_mode & S_IWOTH) && !(folder.st_mode & S_ISVTX))
        return cs_fail(error, CS_ERR_MODULE,
                       "is in a world-writable folder; run chmod o-w on the folder first");
    return CS_OK;
}

enum cs_status cs_module_open(const char *file, const struct cs_module **module,
                              struct cs_error *error) {
    *module = NULL;
    const struct cs_process_state state = cs_process_state_save();
    if (check_file(file, error))
        return error->status;
    cs_crash_begin(CS_CRASH_METHOD);
    cs_crash_watch(CS_CRASH_METHOD, "module", file, "when it was loaded");
    void *handle = dlopen(file, RTLD_NOW | RTLD_LOCAL);
    cs_crash_forget(CS_CRASH_METHOD);
    const bool starved = cs_crash_was_starved(CS_CRASH_METHOD);
    const char *changed = cs_process_state_restore(&state);
    if (!handle)
        return cs_fail(error, starved ? CS_ERR_MEMORY : CS_ERR_MODULE, "%scannot be loaded: %s",
                       starved ? "out of memory: " : "", dlerror());
    if (changed)
        return cs_fail(error, CS_ERR_MODULE, "changes %s when it is loaded%s", changed,
                       changed == cs_process_state_mode ? " (was it linked with -ffast-math?)"
                                                        : "");
    const struct cs_module *found = dlsym(handle, "clothsim_module");
    if (!found)
        return cs_fail(error, CS_ERR_MODULE, "has no symbol clothsim_module");
    if (check_module(found, error))
        return error->status;
    *module = found;
    return CS_OK;
}
