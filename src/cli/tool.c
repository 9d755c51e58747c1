/* Starts and asks the program of a command that is one of its own: clothsim-NAME of tools/. */
#include "base/install_paths.h"
#include "cli/commands.h"
#include "io/subprocess.h"

#include <errno.h>
#include <string.h>
#include <unistd.h>

enum cs_status cs_tool_start(const struct cs_command *command, char **argv,
                             struct cs_error *error) {
    char path[CS_DATA_PATH_MAX];
    execv(cs_tool_path(command->name, path, sizeof path), argv);
    return cs_fail(error, CS_ERR_FILE, "%s: cannot start its program \"%.4000s\": %s",
                   command->name, path, strerror(errno));
}

enum cs_status cs_tool_query(const struct cs_command *command, const char *shell,
                             struct cs_text *out, struct cs_error *error) {
    char path[CS_DATA_PATH_MAX], line[1024];
    const char *const words[] = {cs_tool_path(command->name, path, sizeof path), "--complete",
                                 command->name, shell, NULL};
    struct cs_subprocess tool;
    if (cs_subprocess_open(&tool, ".", words, STDOUT_FILENO, error))
        return error->status;
    while (tool.output && fgets(line, sizeof line, tool.output))
        cs_text_add(out, "%s", line);
    return cs_subprocess_close(&tool)
               ? cs_fail(error, CS_ERR_FILE, "%s: cannot ask its program \"%.4000s\"",
                         command->name, path)
               : CS_OK;
}
