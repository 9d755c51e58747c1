/* One state hash against its golden value. */
#include "study/golden/golden.h"

#include <string.h>

enum cs_status cs_golden_check_hash(struct cs_golden *golden, struct cs_golden_row *row,
                                    struct cs_error *error) {
    struct cs_session session;
    struct cs_error failed = {0};
    if (cs_golden_step(golden, &row->run, false, &session, &failed)) {
        /* only a build without SUNDIALS may lack an integrator, and only where the row says so
         */
        row->skipped = failed.status == CS_ERR_USAGE && !strcmp(row->note, "sundials");
        if (row->skipped)
            return CS_OK;
        return cs_fail(error, failed.status, "%s", failed.message);
    }
    cs_hash_doubles(session.run.x, 6 * (size_t)session.system.view.n, row->found);
    if (strcmp(row->found, row->hash))
        cs_text_add(&row->message, "hash %s, expected %s (%s after frame %u)", row->found,
                    row->hash, cs_outcome_text(session.run.outcome), session.run.frame);
    cs_session_close(&session);
    return CS_OK;
}
