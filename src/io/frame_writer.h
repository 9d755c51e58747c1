/* frame_writer.h - writes numbered frames, on a thread of its own where a core is free. */
#ifndef CS_FRAME_WRITER_H
#define CS_FRAME_WRITER_H

#include "io/png.h"

#include <stdbool.h>

struct cs_frame_writer;

/* What pictures they are, and how they are written. */
struct cs_frame_writer_settings {
    uint32_t width, height;
    bool alpha;
    int level;     /* of packing */
    bool threaded; /* on a worker with a queue of two; else inline */
};

/* folder exists. */
enum cs_status cs_frame_writer_create(const char *folder,
                                      const struct cs_frame_writer_settings *settings,
                                      struct cs_frame_writer **frames, struct cs_error *error);

/* An image to draw the next frame into; waits while both are being written. Owned by *frames.
 */
struct cs_image *cs_frame_writer_acquire(struct cs_frame_writer *frames);

/* Hands the taken image over as frame `number`: folder/frame_%05u.png. Texts are copied.
 * An earlier write's failure is returned here or by finish; frames are written in order and
 * none after a failed one. */
enum cs_status cs_frame_writer_submit(struct cs_frame_writer *frames, uint32_t number,
                                      const struct cs_png_text *texts, uint32_t n_texts,
                                      struct cs_error *error);

/* Waits for what is under way; *seconds gets the time spent in encoding. */
enum cs_status cs_frame_writer_finish(struct cs_frame_writer *frames, double *seconds,
                                      struct cs_error *error);

/* NULL is fine; without an earlier finish, what is queued is still written. */
void cs_frame_writer_destroy(struct cs_frame_writer *frames);

#endif
