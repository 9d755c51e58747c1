/* install_paths.c - finds the program's own files: in its build tree, or where they are
 * installed beside it. */
#include "base/install_paths.h"

#include "base/text.h"

#include <dirent.h>
#include <dlfcn.h>
#include <limits.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#ifdef __linux__
#include <sys/auxv.h>
#endif
#ifdef __APPLE__
#include <mach-o/dyld.h>
#elif defined(__FreeBSD__) || defined(__DragonFly__) || defined(__NetBSD__)
#include <sys/sysctl.h>
#include <sys/types.h>
#endif

enum { FOLDER_MAX = PATH_MAX + 256 };

/* Cuts off the last part of a path; false if nothing is left. */
static bool parent_path(char *path) {
    char *slash = strrchr(path, '/');
    if (slash)
        *slash = 0;
    return slash && *path;
}

/* True if path, or a folder above it, is a Meson build; path is then cut to that folder. */
static bool find_build(char *path) {
    do {
        char marker[FOLDER_MAX];
        snprintf(marker, sizeof marker, "%.4000s/meson-private", path);
        if (access(marker, F_OK) == 0)
            return true;
    } while (parent_path(path));
    return false;
}

#ifdef __linux__
/* The path that the program was started by, for a system without /proc, such as one in a
 * chroot. Returns false if no file is there any more. */
static bool find_started(char *path, size_t size) {
    char found[PATH_MAX];
    const char *started = (const char *)(uintptr_t)getauxval(AT_EXECFN);
    if (!started || !realpath(started, found) || strlen(found) >= size)
        return false;
    strcpy(path, found);
    return true;
}
#endif

/* The path of the running program. Each system has its own call; systems without one may have
 * Linux's /proc. Returns false if the system does not tell. */
static bool find_program(char *path, size_t size) {
#ifdef __APPLE__
    uint32_t length = (uint32_t)size;
    return _NSGetExecutablePath(path, &length) == 0;
#elif defined(__FreeBSD__) || defined(__DragonFly__)
    const int name[] = {CTL_KERN, KERN_PROC, KERN_PROC_PATHNAME, -1};
    return sysctl(name, 4, path, &size, NULL, 0) == 0;
#elif defined(__NetBSD__)
    const int name[] = {CTL_KERN, KERN_PROC_ARGS, -1, KERN_PROC_PATHNAME};
    return sysctl(name, 4, path, &size, NULL, 0) == 0;
#elif defined(__linux__)
    return readlink("/proc/self/exe", path, size - 1) >= 0 || find_started(path, size);
#else
    return readlink("/proc/self/exe", path, size - 1) >= 0;
#endif
}

/* The path of the running program, found at the first call; "" if it is unknown. */
static const char *program_path(void) {
    static char path[PATH_MAX];
    if (!*path && !find_program(path, sizeof path))
        *path = 0;
    return path;
}

/* A place of the program's files: in a build (NULL: none there), installed relative to the
 * program, and as it was configured. */
struct place {
    const char *in_build, *installed, *configured;
};

static const struct place modules = {"plugins", CS_MODULES_FROM_PROGRAM, CS_MODULES_INSTALLED};
static const struct place renderers = {"src/draw", CS_MODULES_FROM_PROGRAM "/render",
                                       CS_MODULES_INSTALLED "/render"};
static const struct place tools = {"tools", CS_TOOLS_FROM_PROGRAM, CS_TOOLS_INSTALLED};
static const struct place data = {NULL, CS_DATA_FROM_PROGRAM, CS_DATA_INSTALLED};

/* from the folder of the running program to that of clothsim */
static const char *to_clothsim = ".";

void cs_program_from_tool(void) {
    to_clothsim = CS_PROGRAM_FROM_TOOLS;
}

/* Writes the folder of a place to out: of the build, or relative to the program; as configured
 * if the program's path is unknown. out stays as it is where a build has none. */
static const char *find_place(const struct place *place, char *out) {
    char program[PATH_MAX], build[PATH_MAX];
    memcpy(program, program_path(), sizeof program);
    if (!parent_path(program)) {
        snprintf(out, FOLDER_MAX, "%s", place->configured);
        return out;
    }
    memcpy(build, program, sizeof build);
    if (!find_build(build))
        snprintf(out, FOLDER_MAX, "%s/%s/%s", program, to_clothsim, place->installed);
    else if (place->in_build)
        snprintf(out, FOLDER_MAX, "%s/%s", build, place->in_build);
    return out;
}

const char *cs_program_path(void) {
    static const struct place beside = {".", ".", "."};
    static char path[FOLDER_MAX + sizeof "/clothsim"];
    char folder[FOLDER_MAX];
    if (!*program_path())
        return "clothsim";
    snprintf(path, sizeof path, "%s/clothsim", find_place(&beside, folder));
    return path;
}

const char *cs_program_path_fault(void) {
    return *program_path()
               ? NULL
               : "the system does not tell where this program is (no /proc): methods are taken "
                 "from " CS_MODULES_INSTALLED ", scenes from " CS_DATA_INSTALLED;
}

const char *cs_module_folder(void) {
    static char folder[FOLDER_MAX];
    return *folder ? folder : find_place(&modules, folder);
}

const char *cs_renderer_folder(void) {
    static char folder[FOLDER_MAX];
    return *folder ? folder : find_place(&renderers, folder);
}

const char *cs_tool_path(const char *command, char *out, size_t size) {
    char folder[FOLDER_MAX];
    snprintf(out, size, "%s/clothsim-%s", find_place(&tools, folder), command);
    return out;
}

const void *cs_table_open(const char *folder, const char *name, const char *symbol,
                          unsigned abi, const char *package, struct cs_error *error) {
    char path[FOLDER_MAX + 256];
    snprintf(path, sizeof path, "%s/%s.so", folder, name);
    if (access(path, R_OK) != 0) {
        cs_fail(error, CS_ERR_MODULE, "no module %s: %s%s", path,
                package ? "build clothsim with the Debian package " : "install clothsim again",
                package ? package : "");
        return NULL;
    }
    // never closed: a driver leaves threads and exit handlers behind
    void *module = dlopen(path, RTLD_NOW | RTLD_LOCAL);
    const unsigned *found = module ? dlsym(module, symbol) : NULL;
    if (!module)
        cs_fail(error, CS_ERR_MODULE, "%s cannot be loaded: %s", name, dlerror());
    else if (!found)
        cs_fail(error, CS_ERR_MODULE, "%s is no module for pictures", path);
    else if (*found != abi)
        cs_fail(error, CS_ERR_MODULE,
                "%s has interface version %u, %u expected: install clothsim again", path,
                *found, abi);
    return error->status ? NULL : found;
}

/* The path if it exists, or that of an installed file; else NULL. */
static const char *find_data(const char *path, char *out, size_t size) {
    char folder[FOLDER_MAX] = "";
    if (access(path, F_OK) == 0)
        return path;
    if (*path == '/' || !*find_place(&data, folder))
        return NULL;
    const int length = snprintf(out, size, "%s/%s", folder, path);
    return length > 0 && (size_t)length < size && access(out, F_OK) == 0 ? out : NULL;
}

const char *cs_data_find(const char *path, char *out, size_t size) {
    const char *found = find_data(path, out, size);
    return found ? found : path;
}

const char *cs_scene_find(const char *name, char *out, size_t size) {
    char path[CS_DATA_PATH_MAX];
    const char *found = find_data(name, out, size);
    if (found || strpbrk(name, "/."))
        return found ? found : name;
    snprintf(path, sizeof path, "scenes/%.200s.json", name);
    found = find_data(path, out, size);
    if (found == path)
        found = strcpy(out, path);
    return found ? found : name;
}

/* Finds the name in a folder that is nearest to `word`, without its ending if it is `bare`. */
static bool find_near(const char *folder, const char *word, bool bare,
                      char best[NAME_MAX + 1]) {
    struct dirent **files;
    const int n = scandir(folder, &files, NULL, alphasort);
    *best = 0;
    for (int k = 0; k < n; k++) {
        char *name = files[k]->d_name, *ending = strstr(name, ".json");
        if (ending && bare)
            *ending = 0;
        if (ending && cs_nearest_word(word, (const char *const[]){best, name, NULL}) == name)
            strcpy(best, name);
        free(files[k]);
    }
    if (n >= 0)
        free(files);
    return *best;
}

void cs_scene_nearest(const char *name, char *out, size_t size) {
    const char *slash = strrchr(name, '/');
    const int kept = slash ? (int)(slash + 1 - name) : 0;
    const bool bare = !strpbrk(name, "/.");
    char folder[FOLDER_MAX + sizeof "/scenes"] = ".", best[NAME_MAX + 1];
    if (slash)
        snprintf(folder, sizeof folder, "%.*s", kept, name);
    if (!find_near(folder, name + kept, bare, best) && bare &&
        !find_near("scenes", name, bare, best) && *find_place(&data, strcpy(folder, "")))
        find_near(strcat(folder, "/scenes"), name, bare, best);
    snprintf(out, size, "%.*s%s", *best ? kept : 0, name, best);
}
