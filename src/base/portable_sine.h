/* portable_sine.h - sine, cosine and logarithm for scenes, moving colliders and energies. libm
 * is not used, because its bits differ between machines. */
#ifndef CS_PORTABLE_SINE_H
#define CS_PORTABLE_SINE_H

/* sin(r pi / 2) for r in 0..1, by its nested series up to the 21st power: accurate to 1e-15, 0
 * at 0 and 1 at 1. */
double cs_quarter_sine(double r);

/* Sine and cosine of an angle in rad, at least 0 and below 1e18. */
void cs_sine_cosine(double angle, double *sine, double *cosine);

/* ln r, for r above 0 and finite: accurate to 1e-15 of 1 or of its own size. */
double cs_natural_log(double r);

#endif
