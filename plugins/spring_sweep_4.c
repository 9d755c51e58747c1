/* Sweeps with vectors of four springs. */
#define WIDTH 4
#include "spring_sweep.h"
