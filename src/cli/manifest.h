/* manifest.h - manifest.txt: which files a run left in a folder, with their sizes and hashes.
 *
 * "# clothsim manifest 1", a line "HASH SIZE NAME" for each file by name, and a last line with
 * the hash of all above. Hashes are what `xxh128sum` prints.
 */
#ifndef CS_MANIFEST_H
#define CS_MANIFEST_H

#include "base/status.h"
#include "base/text.h"

#include <stdint.h>

#define CS_MANIFEST_NAME "manifest.txt"

/* Writes that of a folder, of the files that a run writes (run_output.h) and are there, at
 * once: the disk has it when the call returns. CS_ERR_FILE, CS_ERR_MEMORY. */
enum cs_status cs_manifest_write(const char *folder, struct cs_error *error);

/* Holds a folder against its manifest: adds a line for each file that has changed, is not
 * there, or is not in the manifest. *n: files that are in it; *differing: lines. CS_ERR_FILE
 * where there is no manifest, or it is damaged. */
enum cs_status cs_manifest_check(const char *folder, struct cs_text *out, uint32_t *n,
                                 uint32_t *differing, struct cs_error *error);

#endif
