/* status.h - how a call fails: a status code, and the first message with its place. */
#ifndef CS_STATUS_H
#define CS_STATUS_H

#include <stdarg.h>
#include <stdio.h>

/* name, exit code, sentence for the man page */
#define CS_STATUS_LIST(X)                                                                      \
    X(CS_OK, 0, "done; an unstable run is a result too")                                       \
    X(CS_ERR_CHECK, 1, "a check failed: a golden state, a claim, or two results that differ")  \
    X(CS_ERR_USAGE, 2, "the command line is wrong")                                            \
    X(CS_ERR_SCENE, 3, "the scene is not valid")                                               \
    X(CS_ERR_FILE, 4, "a file cannot be read or written")                                      \
    X(CS_ERR_MODULE, 5, "an integrator or renderer module cannot be used, or failed")          \
    X(CS_ERR_INTERNAL, 6, "an error in clothsim itself")                                       \
    X(CS_ERR_MEMORY, 7, "out of memory")                                                       \
    X(CS_ERR_UNSTABLE, 8, "no answer; with --strict: a run blew up, or a cell failed")         \
    X(CS_ERR_INTERRUPT, 130, "interrupted by SIGINT; by signal N: 128 + N; results are saved")

enum cs_status {
#define X(name, code, sentence) name,
    CS_STATUS_LIST(X)
#undef X
};

/* The failure of a call. A zeroed struct means that nothing has failed. */
struct cs_error {
    enum cs_status status; /* CS_OK while nothing has failed */
    char message[1024];    /* one line, without the program's name */
};

/* Records status and message in *error unless it already holds a failure: the first one wins,
 * because it is made where most is known. Returns the status that *error then has, for `return
 * cs_fail(error, ...)`. */
enum cs_status cs_fail(struct cs_error *error, enum cs_status status, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Prints the arguments of the function that it stands in, `(..., format, ...)`, into an array
 * of characters, cut to its size. */
#define CS_FORMAT(message, format)                                                             \
    do {                                                                                       \
        va_list args;                                                                          \
        va_start(args, format);                                                                \
        vsnprintf(message, sizeof(message), format, args);                                     \
        va_end(args);                                                                          \
    } while (0)

/* Exit code of a status. */
int cs_status_exit_code(enum cs_status status);

/* Checks an invariant of the program: prints the place and aborts if it does not hold, in every
 * build. */
#define CS_ASSERT(fact) ((fact) ? (void)0 : cs_assert_failed(#fact, __FILE__, __LINE__))
_Noreturn void cs_assert_failed(const char *fact, const char *file, int line);

#endif
