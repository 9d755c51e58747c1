/* bins.h - lists of the items that touch each band of CS_ROWS rows, in their order.
 *
 * A counting sort: all items are counted, cs_bins_begin_put makes room, then all are put in the
 * same order. An item is listed in each band that it touches. */
#ifndef CS_DRAW_BINS_H
#define CS_DRAW_BINS_H

#include "draw/cpu/raster.h"

/* Lists of all bands in one block of memory. */
struct cs_bins {
    uint32_t bands;
    size_t *band_ends; /* (bands + 1), owned: end of each band's list, start of the next */
    uint32_t *list;    /* (capacity), owned */
    size_t capacity;
    bool failed; /* out of memory: the bins are empty */
};

/* Makes bins for a picture of `height` rows; they are filled again per picture.
 * CS_ERR_MEMORY. */
enum cs_status cs_bins_init(struct cs_bins *bins, int height, struct cs_error *error);
/* Sets all counts to 0. */
void cs_bins_clear(struct cs_bins *bins);

/* Counts an item in rows top..bottom of the picture. */
CS_INLINE void cs_bins_count(struct cs_bins *bins, int top, int bottom) {
    for (int band = top / CS_ROWS; band <= bottom / CS_ROWS; band++)
        bins->band_ends[band + 1]++;
}
/* Turns counts into the starts of the lists; call it after the last count. */
void cs_bins_begin_put(struct cs_bins *bins);

/* Puts item number `item`, which was counted with the same rows. */
CS_INLINE void cs_bins_put(struct cs_bins *bins, uint32_t item, int top, int bottom) {
    for (int band = top / CS_ROWS; band <= bottom / CS_ROWS && !bins->failed; band++)
        bins->list[bins->band_ends[band]++] = item;
}

/* Returns the *n items of a band; NULL if there are none. */
CS_INLINE const uint32_t *cs_bins_of(const struct cs_bins *bins, uint32_t band, size_t *n) {
    const size_t begin = band ? bins->band_ends[band - 1] : 0;
    *n = bins->failed ? 0 : bins->band_ends[band] - begin;
    return *n ? bins->list + begin : NULL; // an empty picture has no list
}

/* Frees the memory. */
void cs_bins_finish(struct cs_bins *bins);

#endif
