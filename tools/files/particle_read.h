/* particle_read.h - the motion of one particle, from an archive of a run. */
#ifndef CS_PARTICLE_READ_H
#define CS_PARTICLE_READ_H

#include "shared/table_plot.h"

/* Reads the positions of a particle from run.npz, of clothsim run --export npz or numpy.savez:
 * a table of t, x, y and z. CS_ERR_USAGE: there are fewer particles; CS_ERR_FILE: "times" or
 * "positions" is missing, compressed or not of float64; CS_ERR_MEMORY. */
enum cs_status cs_particle_read(const char *path, uint32_t particle, struct cs_arena *arena,
                                struct cs_number_table *table, struct cs_error *error);

#endif
