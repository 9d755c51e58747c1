/* coarse.h - obstacles that are sharper than a mesh: contact by force is felt by particles, and
 * what lies between them can come in. */
#ifndef CS_COARSE_H
#define CS_COARSE_H

#include "model/system/system.h"

/* How far in m a straight edge of that length sinks into a round core of that radius between
 * its ends, which lie on it: s^2/8R where it is short. Corner: the core is the rounded edge of
 * a box, which a long one cuts off. */
double cs_coarse_sinking(double length, double radius, bool corner);

/* Adds one line about the first collider into which edges can sink by more than a quarter of
 * its range, and how many more there are; nothing where there is none, or contact is no force.
 * Edges are those of grids and surfaces at the start. A hint: what carries little stays further
 * out than what is pressed in. */
void cs_coarse_print(const struct cs_system *system, struct cs_text *out);

#endif
