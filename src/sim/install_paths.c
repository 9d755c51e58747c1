/* install_paths.c - finds the program's own files: in its build tree, or where they are
 * installed beside it. */
#include "sim/install_paths.h"

#include <limits.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>
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
#else
    return readlink("/proc/self/exe", path, size - 1) >= 0;
#endif
}

/* Writes the folder `in_build` of the build, or `installed` relative to the program, to out.
 * out stays as it is if the program's path is unknown, or in a build if in_build is NULL. */
static const char *find(const char *in_build, const char *installed, char *out) {
    char program[PATH_MAX] = "", build[PATH_MAX];
    if (!find_program(program, sizeof program) || !parent_path(program))
        return out;
    memcpy(build, program, sizeof build);
    if (!find_build(build))
        snprintf(out, FOLDER_MAX, "%s/%s", program, installed);
    else if (in_build)
        snprintf(out, FOLDER_MAX, "%s/%s", build, in_build);
    return out;
}

const char *cs_program_path(void) {
    static char path[PATH_MAX];
    return *path || find_program(path, sizeof path) ? path : "clothsim";
}

const char *cs_module_folder(void) {
    static char folder[FOLDER_MAX];
    return *folder ? folder : find("plugins", CS_MODULES_FROM_PROGRAM, folder);
}

const char *cs_renderer_folder(void) {
    static char folder[FOLDER_MAX];
    return *folder ? folder : find("src/draw", CS_MODULES_FROM_PROGRAM "/render", folder);
}

/* The path if it exists, or that of an installed file; else NULL. */
static const char *find_data(const char *path, char *out, size_t size) {
    char folder[FOLDER_MAX] = "";
    if (access(path, F_OK) == 0)
        return path;
    if (*path == '/' || !*find(NULL, CS_DATA_FROM_PROGRAM, folder))
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
