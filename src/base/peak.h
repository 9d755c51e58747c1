/* peak.h - most memory that this process has held at once. */
#ifndef CS_PEAK_H
#define CS_PEAK_H

#include <stddef.h>

/* Bytes resident at the peak, libraries and all; 0 where the system does not say. */
size_t cs_peak_memory(void);

#endif
