/* high_order_methods.h - the methods of the module `dop853`: it takes steps of `dopri5` too,
 * and starts `symmetric-multistep`. */
#ifndef HIGH_ORDER_METHODS_H
#define HIGH_ORDER_METHODS_H

#include "nystrom.h"

extern const struct nystrom_pair dop853_pair, dopri5_pair;
extern const struct cs_integrator dop853, dopri5, symmetric_multistep;

#endif
