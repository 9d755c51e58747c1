/* driver.h - which driver Mesa takes, and which CPU instructions it may use. */
#ifndef CS_DRAW_DRIVER_H
#define CS_DRAW_DRIVER_H

#include <stdbool.h>

/* Sets the environment for the software driver llvmpipe and, unless fast, for SSE4.1 code: with
 * these, one Mesa version gives the same pixels on every x86-64 CPU. Mesa reads it once, so
 * only the first call of a process decides. Returns what holds: "caps=sse4.1" or "caps=native".
 */
const char *cs_driver_pin(bool fast);

#endif
