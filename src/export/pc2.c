/* Writes PC2 point caches: the points of all samples in one file, in the order of the OBJ.
 *
 *   offset  bytes  field, little-endian
 *   0       12     "POINTCACHE2", 0
 *   12      4      version 1
 *   16      4      number n of points
 *   20      4      first frame, a float: 0
 *   24      4      frames from one sample to the next, a float
 *   28      4      number of samples
 *   32      12 n   positions of the first sample, floats x y z per point; then the next
 *
 * The number of samples is written after their positions. A file that a crash cut off therefore
 * never promises a sample that it does not hold. */
#include "base/serialise.h"
#include "export/writer.h"

/* The cache of bodies or of colliders; closed if they have none. */
struct cache {
    struct cs_append_file file;
    uint32_t n_samples;
    uint32_t *floats; /* (n, 3) of one sample, the arena's */
};

enum { HEADER = 32, AT_COUNT = 28 }; /* bytes of the header; offset of the number of samples */

static void make_header(uint8_t header[HEADER], uint32_t n, uint32_t every, uint32_t samples) {
    const uint32_t words[] = {htole32(1), /* the version */
                              htole32(n), cs_float_to_le32(0) /* the first frame */,
                              cs_float_to_le32((float)every), htole32(samples)};
    memcpy(header, "POINTCACHE2", 12);
    memcpy(header + 12, words, sizeof words);
}

/* Opens a cache: a new file, or the first `kept` samples of that of a continued run. */
static enum cs_status open_cache(struct cache *cache, const struct cs_export_mesh *mesh,
                                 const struct cs_export_settings *settings,
                                 struct cs_arena *arena, struct cs_error *error) {
    char name[32], path[CS_EXPORT_PATH];
    uint8_t header[HEADER];
    const uint32_t kept = settings->n_samples_before;
    const uint64_t length = kept ? HEADER + 12 * (uint64_t)mesh->n * kept : 0;
    cache->n_samples = kept;
    cache->floats = cs_arena_alloc_array(arena, mesh->n, 3 * sizeof *cache->floats, error);
    snprintf(name, sizeof name, "%s.%s", mesh->name, cs_export_pc2.cache_ending);
    make_header(header, mesh->n, settings->frame_interval, kept);
    if (error->status || cs_export_name(path, settings->folder, name, error) ||
        cs_append_file_open(&cache->file, path, length, error))
        return error->status;
    return cs_append_file_write(&cache->file, 0, header, sizeof header, error);
}

/* Adds a sample: positions first, then the count that includes it. */
static enum cs_status add_to(struct cache *cache, const struct cs_export_mesh *mesh,
                             struct cs_error *error) {
    const uint64_t *words = mesh->fields[0].words;
    const size_t n = 3 * (size_t)mesh->n;
    for (size_t k = 0; k < n; k++)
        cache->floats[k] = cs_float_to_le32((float)cs_double_from_le64(words[k]));
    if (cs_append_file_write(&cache->file, HEADER + 4 * (uint64_t)n * cache->n_samples,
                             cache->floats, n * sizeof *cache->floats, error))
        return error->status;
    const uint32_t count = htole32(++cache->n_samples);
    return cs_append_file_write(&cache->file, AT_COUNT, &count, sizeof count, error);
}

static enum cs_status open_files(void *state, const struct cs_export_source *source,
                                 struct cs_arena *arena, struct cs_error *error) {
    struct cache *caches = state;
    /* what never moves needs no cache */
    for (int k = 0; k < 2; k++)
        if (source->meshes[k]->n > 0 && source->meshes[k]->is_moving &&
            open_cache(caches + k, source->meshes[k], &source->settings, arena, error))
            return error->status;
    return CS_OK;
}

static enum cs_status add_pc2(void *state, const struct cs_export_source *source,
                              const struct cs_export_sample *sample, struct cs_error *error) {
    struct cache *caches = state;
    (void)sample;
    for (int k = 0; k < 2; k++)
        if (caches[k].file.file && add_to(caches + k, source->meshes[k], error))
            return error->status;
    return CS_OK;
}

static enum cs_status sync_files(const void *state, struct cs_error *error) {
    const struct cache *caches = state;
    for (int k = 0; k < 2; k++)
        if (cs_append_file_sync(&caches[k].file, error))
            return error->status;
    return CS_OK;
}

static void close_files(void *state) {
    struct cache *caches = state;
    for (int k = 0; k < 2; k++)
        cs_append_file_close(&caches[k].file);
}

const struct cs_export_writer cs_export_pc2 = {
    .cache_ending = "pc2",
    .size = 2 * sizeof(struct cache), /* of bodies, of colliders */
    .open = open_files,
    .add = add_pc2,
    .sync = sync_files,
    .close = close_files,
};
