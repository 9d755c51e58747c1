/* ieee_check.h - whether this build and machine compute with IEEE doubles as written: found by
 * computing, whatever the flags are called. */
#ifndef CS_IEEE_CHECK_H
#define CS_IEEE_CHECK_H

/* What is not so, in words; NULL: all is well. */
const char *cs_ieee_check(void);

#endif
