/* Saves and restores the floating-point mode around foreign code. */
#include "sim/guard.h"

#include <fenv.h>

#if defined(__SSE2__)
#include <xmmintrin.h>
enum { STICKY_FLAGS = 0x3f };
static unsigned control_get(void) {
    return _mm_getcsr() & ~(unsigned)STICKY_FLAGS;
}
static void control_set(unsigned control) {
    _mm_setcsr(control);
}
#elif defined(__aarch64__)
static unsigned control_get(void) {
    unsigned long fpcr;
    __asm__ volatile("mrs %0, fpcr" : "=r"(fpcr));
    return (unsigned)fpcr;
}
static void control_set(unsigned control) {
    __asm__ volatile("msr fpcr, %0" : : "r"((unsigned long)control));
}
#else
static unsigned control_get(void) {
    return 0;
}
static void control_set(unsigned control) {
    (void)control;
}
#endif

struct cs_guard cs_guard_take(void) {
    return (struct cs_guard){control_get(), fegetround()};
}

bool cs_guard_restore(struct cs_guard guard) {
    if (control_get() == guard.control && fegetround() == guard.rounding)
        return false;
    fesetround(guard.rounding);
    control_set(guard.control);
    return true;
}
