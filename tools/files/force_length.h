/* force_length.h - force over length of the first body of a scene. */
#ifndef CS_FORCE_LENGTH_H
#define CS_FORCE_LENGTH_H

#include "shared/table_plot.h"

/* Fills a table of "length over start" from `low` to `high` in 101 rows, and "force in N" along
 * x: the sum over the half of the body with smaller x of the elastic forces, which pull the
 * ends together where it is positive. The positions of the start are stretched along x about
 * their middle; width and thickness stay, and nothing moves. Errors of the scene. */
enum cs_status cs_force_length_measure(const char *scene, double low, double high,
                                       struct cs_arena *arena, struct cs_number_table *table,
                                       struct cs_error *error);

#endif
