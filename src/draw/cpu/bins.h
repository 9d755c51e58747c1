/* bins.h - which items touch which band of CS_ROWS rows, in their order.
 *
 * Items are gone through twice: all are counted, then all are put. */
#ifndef CS_DRAW_BINS_H
#define CS_DRAW_BINS_H

#include "draw/cpu/raster.h"

struct cs_bins {
    uint32_t bands;
    size_t *band_ends; /* (bands + 1), owned: where the list of a band ends; of -1: begins */
    uint32_t *list;    /* owned */
    size_t capacity;
    bool failed; /* out of memory: the bins are empty */
};

enum cs_status cs_bins_init(struct cs_bins *bins, int height, struct cs_error *error);
void cs_bins_clear(struct cs_bins *bins);

/* An item in rows top..bottom of the picture. */
CS_INLINE void cs_bins_count(struct cs_bins *bins, int top, int bottom) {
    for (int band = top / CS_ROWS; band <= bottom / CS_ROWS; band++)
        bins->band_ends[band + 1]++;
}
/* Between counting and putting. */
void cs_bins_begin_put(struct cs_bins *bins);

CS_INLINE void cs_bins_put(struct cs_bins *bins, uint32_t item, int top, int bottom) {
    for (int band = top / CS_ROWS; band <= bottom / CS_ROWS && !bins->failed; band++)
        bins->list[bins->band_ends[band]++] = item;
}

/* Items of a band: *n of them. */
CS_INLINE const uint32_t *cs_bins_of(const struct cs_bins *bins, uint32_t band, size_t *n) {
    const size_t begin = band ? bins->band_ends[band - 1] : 0;
    *n = bins->failed ? 0 : bins->band_ends[band] - begin;
    return *n ? bins->list + begin : NULL; // an empty picture has no list
}

void cs_bins_finish(struct cs_bins *bins);

#endif
