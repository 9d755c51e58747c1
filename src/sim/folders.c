/* Finds the program's own modules: in its build tree, or where they are installed beside it. */
#include "sim/folders.h"

#include <limits.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { FOLDER_MAX = PATH_MAX + 256 };

/* cuts the last part off; false where none is left */
static bool go_up(char *path) {
    char *slash = strrchr(path, '/');
    if (slash)
        *slash = 0;
    return slash && *path;
}

/* Whether path or a folder above it is a Meson build; path is cut to it. */
static bool find_build(char *path) {
    do {
        char marker[FOLDER_MAX];
        snprintf(marker, sizeof marker, "%.4000s/meson-private", path);
        if (access(marker, F_OK) == 0)
            return true;
    } while (go_up(path));
    return false;
}

static const char *find(const char *in_build, const char *installed, char *out) {
    char program[PATH_MAX] = "", build[PATH_MAX];
    if (readlink("/proc/self/exe", program, sizeof program - 1) < 0 || !go_up(program))
        return out;
    memcpy(build, program, sizeof build);
    if (find_build(build))
        snprintf(out, FOLDER_MAX, "%s/%s", build, in_build);
    else
        snprintf(out, FOLDER_MAX, "%s/%s", program, installed);
    return out;
}

const char *cs_module_folder(void) {
    static char folder[FOLDER_MAX];
    return *folder ? folder : find("plugins", CS_MODULES_FROM_PROGRAM, folder);
}

const char *cs_renderer_folder(void) {
    static char folder[FOLDER_MAX];
    return *folder ? folder : find("src/draw", CS_MODULES_FROM_PROGRAM "/render", folder);
}
