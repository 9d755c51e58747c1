/* golden.h - compares runs with stored results: state hashes and images.
 *
 *   tables -> per row a run to its last frame -> hash or picture, compared -> report, or
 * accepted */
#ifndef CS_GOLDEN_H
#define CS_GOLDEN_H

#include "golden/golden_row.h"

/* Recomputes every row. Rows that differ are counted in failed and reported, with *.actual.png
 * and *.difference.png beside a golden image; with accept_all the tables and images are
 * rewritten. A row whose run fails is counted in failed, and the others go on; a run that is
 * added fails as a whole. CS_ERR_FILE if a table cannot be read; CS_ERR_INTERRUPT. */
enum cs_status cs_golden_check(struct cs_golden *golden, struct cs_error *error);

#endif
