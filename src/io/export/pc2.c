/* Writes PC2 point caches: a header of 32 bytes, then places as floats, sample by sample. */
#include "io/export/pc2.h"

#include "base/little_endian.h"

enum { HEADER = 32, AT_COUNT = 28 };

static void make_header(uint8_t header[HEADER], uint32_t n, uint32_t every, uint32_t samples) {
    const uint32_t words[] = {htole32(1), /* the version */
                              htole32(n), cs_float_to_le32(0) /* the first frame */,
                              cs_float_to_le32((float)every), htole32(samples)};
    memcpy(header, "POINTCACHE2", 12);
    memcpy(header + 12, words, sizeof words);
}

enum cs_status cs_pc2_open(struct cs_pc2 *cache, const struct cs_export_mesh *skin,
                           const struct cs_export_settings *settings, struct cs_arena *arena,
                           struct cs_error *error) {
    char name[32], path[CS_EXPORT_PATH];
    uint8_t header[HEADER];
    const uint32_t kept = settings->n_samples_before;
    const uint64_t length = kept ? HEADER + 12 * (uint64_t)skin->n * kept : 0;
    cache->n_samples = kept;
    cache->floats = cs_arena_alloc_array(arena, skin->n, 3 * sizeof *cache->floats, error);
    snprintf(name, sizeof name, "%s.pc2", skin->name);
    make_header(header, skin->n, settings->frame_interval, kept);
    if (error->status || cs_export_name(path, settings->folder, name, error) ||
        cs_append_file_open(&cache->file, path, length, error))
        return error->status;
    return cs_append_file_write(&cache->file, 0, header, sizeof header, error);
}

enum cs_status cs_pc2_add(struct cs_pc2 *cache, const struct cs_export_mesh *skin,
                          struct cs_error *error) {
    const uint64_t *words = skin->fields[0].words;
    const size_t n = 3 * (size_t)skin->n;
    for (size_t k = 0; k < n; k++)
        cache->floats[k] = cs_float_to_le32((float)cs_double_from_le64(words[k]));
    if (cs_append_file_write(&cache->file, HEADER + 4 * (uint64_t)n * cache->n_samples,
                             cache->floats, n * sizeof *cache->floats, error))
        return error->status;
    const uint32_t count = htole32(++cache->n_samples);
    return cs_append_file_write(&cache->file, AT_COUNT, &count, sizeof count, error);
}
