/* What foreign code changes is named, and signals alone change nothing. */
#include "sim/process_state.h"
#include "unit.h"

#include <signal.h>
#include <sys/time.h>

static volatile sig_atomic_t heard;

static void hear(int number) {
    (void)number;
    heard = heard + 1;
}

/* A signal may come within any system call. */
TEST(signals_change_nothing) {
    const struct sigaction action = {.sa_handler = hear};
    const struct timeval period = {.tv_usec = 50};
    const struct cs_process_state state = cs_process_state_save();
    sigaction(SIGALRM, &action, NULL);
    setitimer(ITIMER_REAL, &(struct itimerval){period, period}, NULL);
    for (heard = 0; heard < 2000;)
        UNIT_ASSERT_OFTEN(!cs_process_state_restore(&state));
    setitimer(ITIMER_REAL, &(struct itimerval){{0}, {0}}, NULL);
}

TEST(a_closed_stream_is_named) {
    const struct cs_process_state state = cs_process_state_save();
    const int kept = dup(STDIN_FILENO);
    close(STDIN_FILENO);
    ck_assert_str_eq(cs_process_state_restore(&state), "the open standard streams");
    dup2(kept, STDIN_FILENO);
    close(kept);
    ck_assert_ptr_null(cs_process_state_restore(&state));
}
