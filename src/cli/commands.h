/* commands.h - the commands of the program, one file each. */
#ifndef CS_COMMANDS_H
#define CS_COMMANDS_H

#include "cli/args.h"

extern const struct cs_command cs_command_run;
extern const struct cs_command cs_command_integrators;
extern const struct cs_command cs_command_scene;
extern const struct cs_command cs_command_golden;
extern const struct cs_command cs_command_conform;
extern const struct cs_command cs_command_stability;
extern const struct cs_command cs_command_advise;
extern const struct cs_command cs_command_compare;
extern const struct cs_command cs_command_plot;
extern const struct cs_command cs_command_soft_bench;

#endif
