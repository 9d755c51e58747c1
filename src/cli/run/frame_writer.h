/* frame_writer.h - writes numbered frames, on a worker thread if a core is free. It owns the
 * pixels of all pictures of a run: the caller borrows an image and submits it. */
#ifndef CS_FRAME_WRITER_H
#define CS_FRAME_WRITER_H

#include "base/png.h"

struct cs_frame_writer;

/* Size and encoding of all pictures of a run. */
struct cs_frame_writer_settings {
    uint32_t width, height;
    bool alpha;
    int level;     /* of compression, 0..9 */
    bool threaded; /* on a worker thread with a queue of two; else in the caller */
};

/* Creates a writer into an existing folder. Allocates two images (one without a thread). If the
 * thread cannot be started, frames are written in the caller. CS_ERR_MEMORY, or CS_ERR_MODULE
 * without the module that writes PNG; *frames is then NULL. */
enum cs_status cs_frame_writer_create(const char *folder,
                                      const struct cs_frame_writer_settings *settings,
                                      struct cs_frame_writer **frames, struct cs_error *error);

/* Returns an image to draw the next frame into; waits while all are being written. It belongs
 * to the writer, and to the caller's use until it is submitted. */
struct cs_image *cs_frame_writer_acquire(struct cs_frame_writer *frames);

/* Queues the acquired image as frame `number`: folder/frame_%05u.png. Texts are copied. The
 * failure of an earlier write is returned here or by finish. Frames are written in order, and
 * none after a failed one. */
enum cs_status cs_frame_writer_submit(struct cs_frame_writer *frames, uint32_t number,
                                      const struct cs_png_text *texts, uint32_t n_texts,
                                      struct cs_error *error);

/* Waits until all queued frames are written; *seconds gets the time spent in encoding. */
enum cs_status cs_frame_writer_finish(struct cs_frame_writer *frames, double *seconds,
                                      struct cs_error *error);

/* Writes what is still queued, then frees all. NULL is fine. */
void cs_frame_writer_destroy(struct cs_frame_writer *frames);

#endif
