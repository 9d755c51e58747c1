/* Sweeps with vectors of eight springs. */
#define WIDTH 8
#include "spring_sweep.h"
