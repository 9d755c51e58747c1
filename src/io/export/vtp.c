/* Writes VTK's XML PolyData with raw appended data, each array behind its length. */
#include "io/export/vtp.h"

#include "base/file.h"
#include "base/little_endian.h"
#include "io/export/export_name.h"

/* An array in the head, whose data follow those before. */
struct array {
    const char *type, *name;
    uint32_t components;
    size_t bytes;
};

static void add_array(struct cs_text *head, const struct array *array, size_t *offset) {
    cs_text_add(head,
                "<DataArray type=\"%s\" Name=\"%s\" NumberOfComponents=\"%u\" "
                "format=\"appended\" offset=\"%zu\"/>\n",
                array->type, array->name, array->components, *offset);
    *offset += sizeof(uint64_t) + array->bytes;
}

static void add_field(struct cs_text *head, const struct cs_export_mesh *skin, uint32_t f,
                      size_t *offset) {
    const struct cs_export_field *field = skin->fields + f;
    const size_t bytes = skin->n * field->components * sizeof(uint64_t);
    add_array(head, &(struct array){"Float64", field->name, field->components, bytes}, offset);
}

static void add_cells(struct cs_text *head, const char *kind, uint32_t n, uint32_t corners,
                      size_t *offset) {
    const size_t bytes = n * sizeof(int32_t);
    cs_text_add(head, "<%s>\n", kind);
    add_array(head, &(struct array){"Int32", "connectivity", 1, corners * bytes}, offset);
    add_array(head, &(struct array){"Int32", "offsets", 1, bytes}, offset);
    cs_text_add(head, "</%s>\n", kind);
}

/* In the order of the data: time, fields, then what stays. */
static void print_head(const struct cs_export_mesh *skin, struct cs_text *head) {
    size_t offset = 0;
    cs_text_add(head, "<?xml version=\"1.0\"?>\n"
                      "<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" "
                      "header_type=\"UInt64\">\n<PolyData>\n<FieldData>\n"
                      "<DataArray type=\"Float64\" Name=\"TimeValue\" NumberOfTuples=\"1\" "
                      "format=\"appended\" offset=\"0\"/>\n</FieldData>\n");
    offset += sizeof(uint64_t) + sizeof(double);
    cs_text_add(head,
                "<Piece NumberOfPoints=\"%u\" NumberOfVerts=\"0\" NumberOfLines=\"%u\" "
                "NumberOfStrips=\"0\" NumberOfPolys=\"%u\">\n<Points>\n",
                skin->n, skin->n_lines, skin->n_triangles);
    add_field(head, skin, 0, &offset);
    cs_text_add(head, "</Points>\n<PointData%s>\n", skin->uv ? " TCoords=\"uv\"" : "");
    for (uint32_t f = 1; f < skin->n_fields; f++)
        add_field(head, skin, f, &offset);
    add_array(head, &(struct array){"Int32", skin->item, 1, skin->n * sizeof(int32_t)},
              &offset);
    if (skin->uv)
        add_array(head, &(struct array){"Float32", "uv", 2, skin->n * sizeof(float[2])},
                  &offset);
    cs_text_add(head, "</PointData>\n");
    add_cells(head, "Lines", skin->n_lines, 2, &offset);
    add_cells(head, "Polys", skin->n_triangles, 3, &offset);
    cs_text_add(head, "</Piece>\n</PolyData>\n<AppendedData encoding=\"raw\">\n_");
}

/* the beginning of an array of n numbers; returns where they go */
static uint32_t *begin_array(uint8_t **at, size_t n) {
    const uint64_t length = htole64(n * sizeof(uint32_t));
    memcpy(*at, &length, sizeof length);
    uint32_t *numbers = (uint32_t *)(void *)(*at + sizeof length);
    *at += sizeof length + n * sizeof(uint32_t);
    return numbers;
}

/* Lengths are of 8 bytes and numbers of 4, so that every number has its place in memory. */
static void fill_cells(uint8_t **at, const uint32_t *points, uint32_t n, uint32_t corners) {
    uint32_t *connectivity = begin_array(at, (size_t)corners * n);
    for (size_t k = 0; k < (size_t)corners * n; k++)
        connectivity[k] = htole32(points[k]);
    uint32_t *ends = begin_array(at, n);
    for (uint32_t k = 0; k < n; k++)
        ends[k] = htole32((k + 1) * corners);
}

static void fill_uv(const struct cs_export_mesh *skin, uint8_t **at) {
    float(*uv)[2] = (float(*)[2])(void *)begin_array(at, 2 * (size_t)skin->n);
    cs_export_mesh_point_uv(skin, uv);
    for (size_t i = 0; i < skin->n; i++)
        for (size_t c = 0; c < 2; c++) {
            const uint32_t word = cs_float_to_le32(uv[i][c]);
            memcpy(uv[i] + c, &word, sizeof word);
        }
}

static void fill_fixed(const struct cs_export_mesh *skin, uint8_t *at) {
    uint32_t *item = begin_array(&at, skin->n);
    for (uint32_t b = 0; b < skin->n_items; b++)
        for (uint32_t i = skin->first_point[b]; i < skin->first_point[b + 1]; i++)
            item[i] = htole32(skin->items[b]);
    if (skin->uv)
        fill_uv(skin, &at);
    fill_cells(&at, skin->lines, skin->n_lines, 2);
    fill_cells(&at, skin->triangles, skin->n_triangles, 3);
}

enum cs_status cs_vtp_make(struct cs_vtp *vtp, const struct cs_export_mesh *skin,
                           struct cs_arena *arena, struct cs_error *error) {
    vtp->constant_bytes =
        5 * sizeof(uint64_t) + sizeof(uint32_t) * (skin->n + 3 * (size_t)skin->n_lines +
                                                   4 * (size_t)skin->n_triangles);
    if (skin->uv)
        vtp->constant_bytes += sizeof(uint64_t) + skin->n * sizeof(float[2]);
    vtp->constant_part = cs_arena_alloc(arena, vtp->constant_bytes, error);
    print_head(skin, &vtp->header);
    if (vtp->header.failed)
        cs_fail(error, CS_ERR_MEMORY, "out of memory for VTP files");
    if (!error->status)
        fill_fixed(skin, vtp->constant_part);
    return error->status;
}

/* failures are seen when the file is finished */
static void write_array(FILE *file, const uint64_t *words, size_t n) {
    const uint64_t length = htole64(n * sizeof *words);
    fwrite(&length, sizeof length, 1, file);
    fwrite(words, sizeof *words, n, file);
}

enum cs_status cs_vtp_write(const struct cs_vtp *vtp, const struct cs_export_mesh *skin,
                            const char *folder, const struct cs_export_sample *sample,
                            struct cs_error *error) {
    char path[CS_EXPORT_PATH];
    struct cs_file_out out;
    const uint64_t time = cs_double_to_le64(sample->t);
    if (cs_export_number(path, folder, skin->name, sample->number, "vtp", error) ||
        cs_file_create(&out, path, error))
        return error->status;
    fwrite(vtp->header.bytes, 1, vtp->header.length, out.file);
    write_array(out.file, &time, 1);
    for (uint32_t f = 0; f < skin->n_fields; f++)
        write_array(out.file, skin->fields[f].words,
                    (size_t)skin->n * skin->fields[f].components);
    fwrite(vtp->constant_part, 1, vtp->constant_bytes, out.file);
    fputs("\n</AppendedData>\n</VTKFile>\n", out.file);
    return cs_file_finish(&out, error);
}
