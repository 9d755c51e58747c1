/* sine.h - the sine while a scene is loaded: not libm's, whose bits differ between machines. */
#ifndef CS_SINE_H
#define CS_SINE_H

/* sin(r pi / 2) for r in 0..1, by its nested series up to the 21st power: good to 1e-15, 0 at 0
 * and 1 at 1. */
double cs_quarter_sine(double r);

#endif
