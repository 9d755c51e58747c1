/* bins.c - lists of items by band, one after the other in one block of memory. */
#include "draw/cpu/bins.h"

#include <stdlib.h>
#include <string.h>

enum cs_status cs_bins_init(struct cs_bins *bins, int height, struct cs_error *error) {
    bins->bands = (uint32_t)((height + CS_ROWS - 1) / CS_ROWS);
    bins->band_ends = calloc(bins->bands + 1, sizeof *bins->band_ends);
    return bins->band_ends ? CS_OK
                           : cs_fail(error, CS_ERR_MEMORY, "out of memory for a picture");
}

void cs_bins_clear(struct cs_bins *bins) {
    memset(bins->band_ends, 0, (bins->bands + 1) * sizeof *bins->band_ends);
}

/* band_ends[b + 1] holds the count of band b. A running sum makes band_ends[b] the start of its
 * list; putting moves it to the end. */
void cs_bins_begin_put(struct cs_bins *bins) {
    for (uint32_t band = 0; band < bins->bands; band++)
        bins->band_ends[band + 1] += bins->band_ends[band];
    const size_t n = bins->band_ends[bins->bands];
    bins->failed = false;
    if (n <= bins->capacity)
        return;
    free(bins->list);
    bins->capacity = n + n / 4;
    bins->list = malloc(bins->capacity * sizeof *bins->list);
    bins->failed = !bins->list;
    if (bins->failed)
        bins->capacity = 0;
}

void cs_bins_finish(struct cs_bins *bins) {
    free(bins->band_ends);
    free(bins->list);
    *bins = (struct cs_bins){0};
}
