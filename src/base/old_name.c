/* Reports old names of options, each once. */
#include "base/old_name.h"

#include <stdint.h>
#include <stdio.h>

enum { REPORTS_MAX = 16 };

void cs_old_name_report(const char *place, const char *old, const char *name) {
    static const char *reported[REPORTS_MAX];
    static uint32_t n;
    for (uint32_t k = 0; k < n; k++)
        if (reported[k] == old)
            return;
    if (n < REPORTS_MAX)
        reported[n++] = old;
    fprintf(stderr, "clothsim: %s%s is now %s%s; the old name goes in the next release\n",
            place, old, place, name);
}
