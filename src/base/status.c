/* Status codes, the first message of a failure, and assertions. */
#include "base/status.h"

#include <stdlib.h>

enum cs_status cs_fail(struct cs_error *error, enum cs_status status, const char *format, ...) {
    if (error->status != CS_OK)
        return error->status;
    error->status = status;
    CS_FORMAT(error->message, format);
    return status;
}

int cs_status_exit_code(enum cs_status status) {
    switch (status) {
#define X(name, code, sentence)                                                                \
    case name:                                                                                 \
        return code;
        CS_STATUS_LIST(X)
#undef X
    }
    return 6;
}

void cs_assert_failed(const char *fact, const char *file, int line) {
    fprintf(stderr, "clothsim: internal error: %s (%s:%d)\n", fact, file, line);
    abort();
}
