/* export_name.h - paths of exported files. */
#ifndef CS_EXPORT_EXPORT_NAME_H
#define CS_EXPORT_EXPORT_NAME_H

#include "base/status.h"

#include <stdint.h>
#include <stdio.h>

enum { CS_EXPORT_PATH = 4096 }; /* bytes of a path with its end */

/* Refuses a path that snprintf has cut off; length: its result. CS_ERR_FILE. */
static inline enum cs_status cs_export_check(int length, const char *folder,
                                             struct cs_error *error) {
    return length >= CS_EXPORT_PATH
               ? cs_fail(error, CS_ERR_FILE,
                         "cannot use the folder \"%.60s...\": the path is too long", folder)
               : CS_OK;
}

/* Writes the path FOLDER/NAME. */
static inline enum cs_status cs_export_name(char path[CS_EXPORT_PATH], const char *folder,
                                            const char *name, struct cs_error *error) {
    return cs_export_check(snprintf(path, CS_EXPORT_PATH, "%s/%s", folder, name), folder,
                           error);
}

/* Writes the path FOLDER/NAME_00012.ENDING of a sample. */
static inline enum cs_status cs_export_number(char path[CS_EXPORT_PATH], const char *folder,
                                              const char *name, uint32_t number,
                                              const char *ending, struct cs_error *error) {
    return cs_export_check(
        snprintf(path, CS_EXPORT_PATH, "%s/%s_%05u.%s", folder, name, number, ending), folder,
        error);
}

#endif
