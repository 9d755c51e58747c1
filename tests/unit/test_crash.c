/* A crash says what crashed: the module that was being called, or the program itself. */
#include "sim/crash.h"
#include "unit.h"

#include <sys/mman.h>

/* Crashes a child that has called a module, within the call or after it, and reports. */
static enum cs_status crash(bool in_call, int number, struct cs_error *error) {
    int end;
    struct cs_crash_log *log =
        mmap(NULL, sizeof *log, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    const pid_t child = fork();
    if (!child) {
        setrlimit(RLIMIT_CORE, &(struct rlimit){0, 0});
        for (int k = 1; k < 32; k++)
            signal(k, SIG_DFL);
        cs_crash_log_to(log);
        cs_crash_watch(CS_CRASH_METHOD, "integrator", "rk4", "in restart");
        if (!in_call)
            cs_crash_forget(CS_CRASH_METHOD);
        raise(number);
    }
    waitpid(child, &end, 0);
    *error = (struct cs_error){0};
    cs_crash_report_print(log, end, error);
    munmap(log, sizeof *log);
    return error->status;
}

TEST(a_crash_says_what_crashed) {
    static const int numbers[] = {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT};
    struct cs_error error;
    for (size_t k = 0; k < LENGTH(numbers); k++) {
        crash(true, numbers[k], &error);
        UNIT_ASSERT_FAILED(&error, CS_ERR_MODULE, "integrator \"rk4\" crashed in restart: it ");
        crash(false, numbers[k], &error);
        UNIT_ASSERT_FAILED(&error, CS_ERR_INTERNAL, "clothsim itself crashed: it ");
        UNIT_ASSERT_FAILED(&error, CS_ERR_INTERNAL, "\"rk4\" in restart, had returned");
    }
    // killed from outside: nobody crashed
    crash(false, SIGKILL, &error);
    UNIT_ASSERT_FAILED(&error, CS_ERR_MODULE, "with signal 9");
}
