/* Writes one NumPy archive of a whole run: meshes, times and the values of all samples.
 *
 * A header of NPY states the length of its array, which is known only at the end. Until then
 * samples are appended to run.npz.part: time, then the fields of bodies and of moving
 * colliders, all little-endian doubles. Each sample has the same size, so field f of sample k
 * is found by its offset. finish() copies the part into the archive, transposed from samples of
 * fields to fields of samples. A continued run goes on from the part.
 *
 * Arrays with N samples: times (N), frames (N), positions and other fields (N, n, components),
 * faces, lines, offsets of bodies, uv; the same of colliders with the prefix "collider_". Of
 * seams: stitches (S, 4) and stitch_weights (S, 4). */
#include "base/file.h"
#include "base/serialise.h"
#include "export/npy.h"
#include "export/writer.h"

#include <string.h>
#include <unistd.h>

/* State of an open archive. */
struct archive {
    struct cs_append_file part;
    const char *folder;        /* borrowed */
    uint32_t every, n_samples; /* frames from one sample to the next, samples there are */
    uint64_t sample_bytes;     /* of a sample in the part */
};

enum { WHOLE, PART }; /* index of a file's name in cs_export_npz.files */

/* Numbers of field f at one sample. */
static size_t word_size(const struct cs_export_mesh *mesh, uint32_t f) {
    return (size_t)mesh->n * mesh->fields[f].components;
}

/* Calls `use` for each field of a sample in the order of the part. Size, writer and reader
 * share this order by sharing the function. */
static enum cs_status each_field(const struct cs_export_mesh *const meshes[2],
                                 enum cs_status (*use)(void *ctx,
                                                       const struct cs_export_mesh *mesh,
                                                       uint32_t f, struct cs_error *error),
                                 void *ctx, struct cs_error *error) {
    for (int k = 0; k < 2; k++)
        for (uint32_t f = 0; f < meshes[k]->n_fields; f++)
            // colliders at rest are not sampled: the archive has their one position
            if (meshes[k]->is_moving && meshes[k]->n > 0 && use(ctx, meshes[k], f, error))
                return error->status;
    return CS_OK;
}

/* Adds the size of a field to *ctx. */
static enum cs_status count_field(void *ctx, const struct cs_export_mesh *mesh, uint32_t f,
                                  struct cs_error *error) {
    uint64_t *bytes = ctx;
    (void)error;
    *bytes += word_size(mesh, f) * sizeof(uint64_t);
    return CS_OK;
}

static enum cs_status open_part(void *state, const struct cs_export_source *source,
                                struct cs_arena *arena, struct cs_error *error) {
    const struct cs_export_settings *settings = &source->settings;
    struct archive *npz = state;
    char path[CS_EXPORT_PATH];
    (void)arena;
    *npz = (struct archive){.folder = settings->folder,
                            .every = settings->frame_interval,
                            .n_samples = settings->n_samples_before,
                            .sample_bytes = sizeof(uint64_t)};
    each_field(source->meshes, count_field, &npz->sample_bytes, error);
    return cs_export_name(path, npz->folder, cs_export_npz.files[PART], error)
               ? error->status
               : cs_append_file_open(&npz->part, path,
                                     npz->sample_bytes * settings->n_samples_before, error);
}

/* A position in the part, which moves from field to field. */
struct place {
    struct archive *npz;
    uint64_t at;
};

static enum cs_status add_field(void *ctx, const struct cs_export_mesh *mesh, uint32_t f,
                                struct cs_error *error) {
    struct place *place = ctx;
    const size_t bytes = word_size(mesh, f) * sizeof(uint64_t);
    const uint64_t at = place->at;
    place->at += bytes;
    return cs_append_file_write(&place->npz->part, at, mesh->fields[f].words, bytes, error);
}

static enum cs_status add_npz(void *state, const struct cs_export_source *source,
                              const struct cs_export_sample *sample, struct cs_error *error) {
    struct archive *npz = state;
    const uint64_t time = cs_double_to_le64(sample->t);
    struct place place = {npz, npz->sample_bytes * npz->n_samples};
    if (cs_append_file_write(&npz->part, place.at, &time, sizeof time, error))
        return error->status;
    place.at += sizeof time;
    if (!each_field(source->meshes, add_field, &place, error))
        npz->n_samples++;
    return error->status;
}

/* Name, element type and shape of an array that is being written. */
struct array {
    const char *name, *type;
    uint64_t shape[3];
    unsigned n_axes, item_bytes;
};

/* Begins the member NAME.npy, whose size follows from the shape, and writes its header. */
static void begin_array(struct cs_zip *zip, const struct array *array) {
    char head[CS_NPY_HEAD], name[40];
    uint64_t bytes = array->item_bytes;
    for (unsigned k = 0; k < array->n_axes; k++)
        bytes *= array->shape[k];
    cs_npy_head(head, array->type, array->shape, array->n_axes);
    snprintf(name, sizeof name, "%s.npy", array->name);
    cs_zip_begin(zip, name, sizeof head + bytes);
    cs_zip_put(zip, head, sizeof head);
}

/* Writes an array of integers or floats of 32 bits, converted block by block. */
static void put_array(struct cs_zip *zip, const struct array *array, const void *numbers) {
    enum { BLOCK = 1024 };
    uint32_t block[BLOCK];
    uint64_t n = 1;
    for (unsigned k = 0; k < array->n_axes; k++)
        n *= array->shape[k];
    begin_array(zip, array);
    for (uint64_t done = 0; done < n; done += BLOCK) {
        const size_t count = n - done < BLOCK ? (size_t)(n - done) : BLOCK;
        memcpy(block, (const char *)numbers + done * sizeof *block, count * sizeof *block);
        for (size_t k = 0; k < count; k++)
            block[k] = htole32(block[k]);
        cs_zip_put(zip, block, count * sizeof *block);
    }
    cs_zip_end(zip);
}

/* Writes integers (n, columns); columns 0: (n). */
static void put_integer(struct cs_zip *zip, const char *name, const uint32_t *values,
                        uint64_t n, uint64_t columns) {
    put_array(zip, &(struct array){name, "<i4", {n, columns}, columns ? 2 : 1, 4}, values);
}

/* Writes what does not change: faces, lines, offsets, texture coordinates. */
static void put_meshes(struct cs_zip *zip, const struct cs_export_mesh *const meshes[2]) {
    const struct cs_export_mesh *bodies = meshes[0], *colliders = meshes[1];
    put_integer(zip, "faces", bodies->triangles, bodies->n_triangles, 3);
    put_integer(zip, "lines", bodies->lines, bodies->n_lines, 2);
    put_integer(zip, "body_offsets", bodies->first_point, bodies->n_items + 1, 0);
    put_integer(zip, "face_offsets", bodies->first_triangle, bodies->n_items + 1, 0);
    if (bodies->uv)
        put_array(zip, &(struct array){"uv", "<f4", {bodies->n_triangles, 3, 2}, 3, 4},
                  bodies->uv);
    if (colliders->n == 0)
        return;
    put_integer(zip, "colliders", colliders->items, colliders->n_items, 0);
    put_integer(zip, "collider_faces", colliders->triangles, colliders->n_triangles, 3);
    put_integer(zip, "collider_offsets", colliders->first_point, colliders->n_items + 1, 0);
    put_integer(zip, "collider_face_offsets", colliders->first_triangle, colliders->n_items + 1,
                0);
}

/* Writes the particles of each stitch, -1 where it has but two, and their weights. */
static void put_stitches(struct cs_zip *zip, const struct cs_seams *seams) {
    begin_array(zip, &(struct array){"stitches", "<i4", {seams->n, 4}, 2, 4});
    for (uint32_t s = 0; s < seams->n; s++)
        for (uint32_t k = 0; k < 4; k++) {
            const struct cs_stitch *stitch = seams->stitches + s;
            const uint32_t at = htole32(k < stitch->n ? stitch->at[k] : UINT32_MAX);
            cs_zip_put(zip, &at, sizeof at);
        }
    cs_zip_end(zip);
    begin_array(zip, &(struct array){"stitch_weights", "<f8", {seams->n, 4}, 2, 8});
    for (uint32_t s = 0; s < seams->n; s++)
        for (uint32_t k = 0; k < 4; k++) {
            const struct cs_stitch *stitch = seams->stitches + s;
            const uint64_t weight = cs_double_to_le64(k < stitch->n ? stitch->weight[k] : 0);
            cs_zip_put(zip, &weight, sizeof weight);
        }
    cs_zip_end(zip);
}

/* Writes the frame of each sample. */
static void put_frames(const struct archive *npz, struct cs_zip *zip) {
    begin_array(zip, &(struct array){"frames", "<i4", {npz->n_samples}, 1, 4});
    for (uint32_t k = 0; k < npz->n_samples; k++) {
        const uint32_t frame = htole32(k * npz->every);
        cs_zip_put(zip, &frame, sizeof frame);
    }
    cs_zip_end(zip);
}

/* Writes the time of each sample in s, gathered from the part. */
static enum cs_status put_times(const struct archive *npz, struct cs_zip *zip,
                                struct cs_error *error) {
    begin_array(zip, &(struct array){"times", "<f8", {npz->n_samples}, 1, 8});
    for (uint32_t k = 0; k < npz->n_samples; k++) {
        uint64_t time;
        if (cs_append_file_read(&npz->part, npz->sample_bytes * k, &time, sizeof time, error))
            return error->status;
        cs_zip_put(zip, &time, sizeof time);
    }
    cs_zip_end(zip);
    return CS_OK;
}

/* Begins the array of a field over all samples. */
static void begin_field(struct cs_zip *zip, const struct cs_export_mesh *mesh, uint32_t f,
                        uint32_t n_samples) {
    char name[40];
    const struct cs_export_field *field = mesh->fields + f;
    snprintf(name, sizeof name, "%s%s", mesh->local_positions ? "collider_" : "",
             field->plural);
    begin_array(zip, &(struct array){name,
                                     "<f8",
                                     {n_samples, mesh->n, field->components},
                                     field->components > 1 ? 3 : 2,
                                     8});
}

/* The archive, and the position of the next field in the first sample. */
struct series {
    struct place place;
    struct cs_zip *zip;
};

/* Writes a field over all samples, gathered from the part through the field's own array. */
static enum cs_status put_field(void *ctx, const struct cs_export_mesh *mesh, uint32_t f,
                                struct cs_error *error) {
    struct series *series = ctx;
    const struct archive *npz = series->place.npz;
    uint64_t *words = mesh->fields[f].words;
    const size_t bytes = word_size(mesh, f) * sizeof *words;
    begin_field(series->zip, mesh, f, npz->n_samples);
    for (uint32_t k = 0; k < npz->n_samples; k++) {
        if (cs_append_file_read(&npz->part, series->place.at + npz->sample_bytes * k, words,
                                bytes, error))
            return error->status;
        cs_zip_put(series->zip, words, bytes);
    }
    cs_zip_end(series->zip);
    series->place.at += bytes;
    return CS_OK;
}

static enum cs_status put_samples(struct archive *npz,
                                  const struct cs_export_mesh *const meshes[2],
                                  struct cs_zip *zip, struct cs_error *error) {
    const struct cs_export_mesh *colliders = meshes[1];
    struct series series = {{npz, sizeof(uint64_t)}, zip};
    put_frames(npz, zip);
    if (put_times(npz, zip, error) || each_field(meshes, put_field, &series, error))
        return error->status;
    if (colliders->n > 0 && !colliders->is_moving) {
        begin_field(zip, colliders, 0, 1);
        cs_zip_put(zip, colliders->fields[0].words, word_size(colliders, 0) * sizeof(uint64_t));
        cs_zip_end(zip);
    }
    return CS_OK;
}

static enum cs_status sync_part(const void *state, struct cs_error *error) {
    const struct archive *npz = state;
    return cs_append_file_sync(&npz->part, error);
}

/* Writes the archive; overwrites the fields of the meshes. Removes the part unless the run may
 * be continued. */
static enum cs_status finish_npz(void *state, const struct cs_export_source *source,
                                 bool goes_on, struct cs_error *error) {
    struct archive *npz = state;
    char path[CS_EXPORT_PATH];
    struct cs_file_out out;
    if (!npz->part.file)
        return CS_OK;
    if (cs_export_name(path, npz->folder, cs_export_npz.files[WHOLE], error) ||
        cs_file_create(&out, path, error))
        return error->status;
    struct cs_zip zip = {.file = out.file};
    put_meshes(&zip, source->meshes);
    if (source->meshes[0]->seams)
        put_stitches(&zip, source->meshes[0]->seams);
    if (put_samples(npz, source->meshes, &zip, error)) {
        cs_file_abandon(&out);
        return error->status;
    }
    cs_zip_finish(&zip);
    if (zip.seek_error) {
        cs_file_abandon(&out);
        return cs_fail(error, cs_file_status(zip.seek_error), "cannot write \"%s\": %s", path,
                       strerror(zip.seek_error));
    }
    if (cs_file_finish(&out, error))
        return error->status;
    return goes_on ? CS_OK : cs_file_remove(npz->part.path, error);
}

static void close_part(void *state) {
    struct archive *npz = state;
    cs_append_file_close(&npz->part);
}

const struct cs_export_writer cs_export_npz = {
    .holds_values = true,
    .files = {[WHOLE] = "run.npz", [PART] = "run.npz.part"},
    .size = sizeof(struct archive),
    .open = open_part,
    .add = add_npz,
    .sync = sync_part,
    .finish = finish_npz,
    .close = close_part,
};
