/* driver.h - choice of Mesa's driver, and of the CPU instructions that it may use. */
#ifndef CS_DRAW_DRIVER_H
#define CS_DRAW_DRIVER_H

#include <stdbool.h>

/* Sets the environment for the software driver llvmpipe and, unless fast, for SSE4.1 code. One
 * version of Mesa then gives the same pixels on every x86-64 CPU that was tried: the default
 * path uses fused multiply-add, the pinned one does not. Mesa reads the environment once, so
 * only the first call of a process decides. Returns the choice: "caps=sse4.1" or
 * "caps=native". */
const char *cs_driver_pin(bool fast);

#endif
