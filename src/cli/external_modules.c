/* Looks for what may name a module from outside, before any is loaded. */
#include "cli/commands.h"

#include <stdlib.h>
#include <string.h>

bool cs_external_modules_requested(const struct cs_args *args, const char *const *texts,
                                   uint32_t n) {
    const char *folders = getenv("CLOTHSIM_PLUGIN_PATH");
    bool named = cs_args_is_given(args, "plugin") || (folders && *folders);
    for (uint32_t k = 0; k < n; k++)
        named |= texts[k] && (strchr(texts[k], '/') || strstr(texts[k], ".so"));
    return named;
}
