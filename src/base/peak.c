#include "base/peak.h"

#include <sys/resource.h>

size_t cs_peak_memory(void) {
    struct rusage usage;
    return getrusage(RUSAGE_SELF, &usage) ? 0 : 1024 * (size_t)usage.ru_maxrss;
}
