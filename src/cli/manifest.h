/* manifest.h - manifest.txt: the files that a run or a study left in a folder, with sizes and
 * hashes.
 *
 * The first line is "# clothsim manifest 1". A line "HASH SIZE NAME" follows for each file,
 * sorted by name. The last line has the hash of everything above, which detects a damaged or
 * cut manifest. Hashes are those that `xxh128sum` prints. */
#ifndef CS_MANIFEST_H
#define CS_MANIFEST_H

#include "base/status.h"
#include "base/text.h"

#include <stdint.h>

#define CS_MANIFEST_NAME "manifest.txt"

/* Writes the manifest of a folder, over the files that a run writes (run_folder.h). It is
 * synced: the disk has it when the call returns. CS_ERR_FILE, CS_ERR_MEMORY. */
enum cs_status cs_manifest_write(const char *folder, struct cs_error *error);

/* The same for a study, whose half-written files of killed processes it removes, over the
 * tables, reports, diagrams and references in the folder, by the endings of their names. An
 * interrupted study has one too: *error may hold CS_ERR_INTERRUPT, and keeps it; any other
 * failure leaves the manifest of before, which then names the tables it has added to. */
enum cs_status cs_manifest_write_study(const char *folder, struct cs_error *error);

/* Checks the files whose names match a pattern of the shell against the manifest of their
 * folder, if there is one. CS_ERR_FILE names the first that differs. */
enum cs_status cs_manifest_check_files(const char *folder, const char *pattern,
                                       struct cs_error *error);
/* Checks the folder of a run that goes on against its manifest, and removes that: until the run
 * ends its files change. CS_ERR_FILE names the first that differs; the manifest then stays. */
enum cs_status cs_manifest_consume(const char *folder, struct cs_error *error);

/* Compares a folder with its manifest: adds a line for each file that has changed, is missing,
 * or is a run's and not in the manifest. *n: files listed; *differing: lines added. CS_ERR_FILE
 * if there is no manifest or if it is damaged. */
enum cs_status cs_manifest_check(const char *folder, struct cs_text *out, uint32_t *n,
                                 uint32_t *differing, struct cs_error *error);

#endif
