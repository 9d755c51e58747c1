/* Loaded before a program by LD_PRELOAD, it leaves another rounding mode behind, as the start of
 * some libraries does. */
#include <fenv.h>

__attribute__((constructor)) static void begin(void) {
    fesetround(FE_UPWARD);
}
