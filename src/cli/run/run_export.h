/* run_export.h - what a run exports, as the command line says it. */
#ifndef CS_RUN_EXPORT_H
#define CS_RUN_EXPORT_H

#include "base/text.h"
#include "io/export/export.h"
#include "sim/run.h"

/* Reads --export and --export-values, lists with commas between; NULL: not given. CS_ERR_USAGE.
 */
enum cs_status cs_run_export_read(const char *formats, const char *values,
                                  struct cs_export_settings *settings, struct cs_error *error);

/* Begins to export a run as it stands: at its start, or where it goes on. */
enum cs_status cs_run_export_begin(struct cs_export *export,
                                   const struct cs_export_settings *settings,
                                   const struct cs_run *run, bool goes_on,
                                   struct cs_error *error);

/* Adds "obj pc2", or with values "vtp (force)"; "none". */
void cs_run_export_print(const struct cs_export_settings *settings, struct cs_text *out);

#endif
