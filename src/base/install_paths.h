/* install_paths.h - the program's own files: modules and data, in the build or installed. */
#ifndef CS_INSTALL_PATHS_H
#define CS_INSTALL_PATHS_H

#include "base/status.h"

#include <stddef.h>

/* Bytes that suffice for the result of cs_data_find. */
enum { CS_DATA_PATH_MAX = 8192 };

/* The path of the program clothsim, also when a tool asks; "clothsim" if the system does not
 * tell where the running program is. Static. */
const char *cs_program_path(void);

/* NULL, or a sentence: the program's path is unknown, and the folders below are those that were
 * configured. */
const char *cs_program_path_fault(void);

/* To be called first by a command that is a program of its own, clothsim-NAME: it stands in
 * another folder than clothsim, to which the folders below are relative. */
void cs_program_from_tool(void);

/* Writes to out (size bytes, such as CS_DATA_PATH_MAX) the path of the program of a command: in
 * a build tree the build's, else the installed one. Returns out. */
const char *cs_tool_path(const char *command, char *out, size_t size);

/* The folders of integrator and renderer modules. In a build tree the build's, else the
 * installed ones. These are found relative to the program, so that an installed tree can be
 * moved. Absolute and static. */
const char *cs_module_folder(void);
const char *cs_renderer_folder(void);

/* Loads FOLDER/NAME.so, a module for pictures, and returns its table `symbol`, which begins
 * with the version of its interface. It stays loaded. package: of Debian, that builds it; NULL:
 * it is always built. Returns NULL after failure: CS_ERR_MODULE. */
const void *cs_table_open(const char *folder, const char *name, const char *symbol,
                          unsigned abi, const char *package, struct cs_error *error);

/* Finds a data file or folder. Returns the path itself if it exists or is absolute. Else the
 * path of an installed file of this name ("scenes/hang.json"), written to out (size bytes,
 * such as CS_DATA_PATH_MAX). Else the path itself. */
const char *cs_data_find(const char *path, char *out, size_t size);

/* The same for a scene, whose name alone ("hang") means scenes/hang.json. */
const char *cs_scene_find(const char *name, char *out, size_t size);

/* Writes to out the name nearest to that of a scene that is not there: of a file in its folder,
 * or, for a name alone, of an installed scene. "" if none is near. */
void cs_scene_nearest(const char *name, char *out, size_t size);

#endif
