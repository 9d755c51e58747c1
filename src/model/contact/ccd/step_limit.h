/* step_limit.h - how far a step may go before it passes over contact or through a surface, and
 * what is said of one that did. */
#ifndef CS_STEP_LIMIT_H
#define CS_STEP_LIMIT_H

#include "model/system/system.h"

/* Whether the scene wants moves to be judged; else the others are not to be called. */
bool cs_step_limit_applies(const struct cs_system *system);

/* Of the move from x0 (3,n) at t0 to x1 at t1: 1, or less where it is to be taken back. Contact
 * by force knows only that it is too far: then half of it may be tried; where t1 is t0, as
 * within an iteration, it is not asked. */
double cs_step_limit_fraction(const struct cs_system *system, double t0, const double *x0,
                              double t1, const double *x1);

/* Whether contact has lacked the memory for what it found: forces lack parts, and the run must
 * end. */
bool cs_step_limit_failed(const struct cs_system *system);

/* Whether the scene wants the run to end at the first crossing, and x (3,n) at t has one: then
 * one line about it is added. */
bool cs_step_limit_ends_run(const struct cs_system *system, double t, const double *x,
                            struct cs_text *why);

#endif
