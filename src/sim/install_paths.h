/* install_paths.h - where this program's own files lie. */
#ifndef CS_INSTALL_PATHS_H
#define CS_INSTALL_PATHS_H

#include <stddef.h>

enum { CS_DATA_PATH_MAX = 8192 };

/* The file of this program; its name where the system does not say. */
const char *cs_program_path(void);

/* The folders of integrator and renderer modules: the build's when the program runs from the
 * build, else the installed ones, found from the program's own place so that an installed tree
 * can be moved. Absolute. */
const char *cs_module_folder(void);
const char *cs_renderer_folder(void);

/* The path itself where something lies there or where it is absolute, else that of an installed
 * file or folder with this name ("scenes/hang.json"), written to out (size, such as
 * CS_DATA_PATH_MAX); the path itself where there is none either. */
const char *cs_data_find(const char *path, char *out, size_t size);

#endif
