/* ieee_check.h - run-time self-test: does this build evaluate IEEE double arithmetic exactly as
 * written? */
#ifndef CS_IEEE_CHECK_H
#define CS_IEEE_CHECK_H

/* Returns the first deviation in words, and NULL if there is none. */
const char *cs_ieee_check(void);

#endif
