/* board.c - memory of a band, and the mean of its samples. */
#include "draw/cpu/board.h"

static enum cs_status take_samples(struct cs_samples *samples, int width,
                                   struct cs_arena *arena, struct cs_error *error) {
    const size_t n = (size_t)width * CS_ROWS;
    samples->width = width;
    samples->depth = cs_arena_take_n(arena, n, sizeof *samples->depth, error);
    samples->shown = cs_arena_take_n(arena, n, sizeof *samples->shown, error);
    return error->status;
}

enum cs_status cs_board_init(struct cs_board *board, int width, bool fades, bool ground,
                             struct cs_arena *arena, struct cs_error *error) {
    const size_t n = (size_t)width * CS_ROWS;
    if (take_samples(&board->samples, width, arena, error) != CS_OK ||
        (ground && take_samples(&board->ground, width, arena, error) != CS_OK))
        return error->status;
    // a colour a row for the sky
    board->most_colours = (uint32_t)(CS_COLOURS_A_PIXEL * n + CS_ROWS);
    board->base = cs_arena_take_n(arena, n, sizeof *board->base, error);
    board->codes = cs_arena_take_n(arena, n, sizeof *board->codes, error);
    board->colours = cs_arena_take_n(arena, board->most_colours, sizeof *board->colours, error);
    board->slots = cs_arena_take_n(arena, CS_SLOTS, sizeof *board->slots, error);
    if (fades)
        board->glazes = cs_arena_take_n(arena, 8 * n, sizeof *board->glazes, error);
    return error->status;
}

static void clear(struct cs_samples *samples, int top, int rows) {
    const size_t n = (size_t)samples->width * (size_t)rows;
    const cs_f4 far = {0}; // the far plane
    const cs_i4 nothing = {CS_NOTHING, CS_NOTHING, CS_NOTHING, CS_NOTHING};
    samples->top = top;
    samples->rows = rows;
    for (size_t i = 0; i < n; i++) {
        samples->depth[i] = far;
        samples->shown[i] = nothing;
    }
}

void cs_board_clear(struct cs_board *board, int top, int rows) {
    clear(&board->samples, top, rows);
    board->n_colours = board->n_glazes = board->n_behind = 0;
}

void cs_board_clear_ground(struct cs_board *board) {
    clear(&board->ground, board->samples.top, board->samples.rows);
}

void cs_board_resolve(const struct cs_board *board, const struct cs_tone *tone,
                      struct cs_image *image) {
    const size_t n = (size_t)board->samples.width * (size_t)board->samples.rows;
    const size_t first = (size_t)board->samples.top * (size_t)board->samples.width;
    for (size_t i = 0; i < n; i++) {
        const uint32_t *colours = board->colours + board->base[i], code = board->codes[i];
        uint32_t c = *colours;
        if (code) {
            const uint32_t samples[4] = {colours[code & 3], colours[code >> 2 & 3],
                                         colours[code >> 4 & 3], colours[code >> 6]};
            c = cs_tone_mean(tone, samples);
        }
        cs_tone_put(tone, c, image, first + i);
    }
}
