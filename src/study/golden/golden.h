/* golden.h - compares runs with stored results: state hashes and images.
 *
 * golden/hash.tsv has one run per line; golden/image.tsv one picture, with
 * golden/image/NAME.png. A run is a scene, an integrator with options ("-": the scene's own),
 * overrides ("path=value;path=value", "-": none) and a number of frames. Paths are relative to
 * the folder above the golden folder. */
#ifndef CS_GOLDEN_H
#define CS_GOLDEN_H

#include "study/golden/golden_run.h"

/* Recomputes every row. Rows that differ are counted in failed and reported, with *.actual.png
 * and *.difference.png beside a golden image; with accept_all the tables and images are
 * rewritten. CS_ERR_FILE if a table cannot be read; CS_ERR_INTERRUPT. */
enum cs_status cs_golden_check(struct cs_golden *golden, struct cs_error *error);

#endif
