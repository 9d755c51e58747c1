/* commands.h - the commands of the program, one file each. */
#ifndef CS_COMMANDS_H
#define CS_COMMANDS_H

#include "cli/line/args.h"

/* CS_COMMAND_LIST(X): X(name) of each, made by the build from its list in meson.build. */
#include "cli/command_list.h"

#define X(name) extern const struct cs_command cs_command_##name;
CS_COMMAND_LIST(X)
#undef X

#endif
