/* advise_print.h - advice as aligned text. */
#ifndef CS_ADVISE_PRINT_H
#define CS_ADVISE_PRINT_H

#include "study/stability/advise.h"

/* Adds a line per method and below it what limits the step; notes on contact come first. */
void cs_advise_print(const struct cs_advise *advise, struct cs_text *out);

#endif
