/* Sweeps with vectors of two springs. */
#define WIDTH 2
#include "spring_sweep.h"
