/* order_8_methods.h - the methods of the module `dop853`: the second starts by the first. */
#ifndef ORDER_8_METHODS_H
#define ORDER_8_METHODS_H

#include "nystrom.h"

extern const struct nystrom_pair dop853_pair;
extern const struct cs_integrator dop853, symmetric_multistep;

#endif
