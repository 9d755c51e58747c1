/* path_findings.h - mistakes in paths of grabs and moves. */
#ifndef CS_PATH_FINDINGS_H
#define CS_PATH_FINDINGS_H

#include "model/system/particle_system.h"

/* Adds what is wrong with the paths of grabs and moves, one per line. */
void cs_path_findings_print(const struct cs_system *system, struct cs_text *out);

#endif
