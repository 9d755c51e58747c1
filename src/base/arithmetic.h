/* arithmetic.h - whether this build and machine compute with IEEE doubles as written: found by
 * computing, whatever the flags are called. */
#ifndef CS_ARITHMETIC_H
#define CS_ARITHMETIC_H

/* What is not so, in words; NULL: all is well. */
const char *cs_arithmetic_fault(void);

#endif
