/* Writes VTK's XML PolyData, one file per sample, and a PVD file with the time of each.
 *
 * A VTP file is an XML head, then "_" and raw appended data, then the closing tags. Each array
 * of the data is its length in bytes (UInt64), then its numbers, all little-endian. The head
 * states its offset from the "_". Arrays come in two parts:
 *   per sample  time, positions and other fields (Float64)
 *   constant    body of each point, texture coordinates, connectivity and ends of lines, faces
 * Head and constant part are made once; a sample writes only what changes between them. */
#include "base/file.h"
#include "base/serialise.h"
#include "base/text.h"
#include "export/writer.h"

/* Parts that the files of all samples have in common. */
struct common {
    struct cs_text head; /* XML up to the appended data, owned */
    uint8_t *fixed;      /* constant appended data, owned by the arena */
    size_t fixed_bytes;
};

/* The PVD file, a valid document after each sample. */
struct list {
    struct cs_append_file file;
    uint64_t end; /* offset of the closing tags, which the next entry overwrites */
};

struct files {
    struct common of[2]; /* bodies, colliders */
    struct list list;
};

/* An array that the head declares. */
struct array {
    const char *type, *name;
    uint32_t components;
    size_t bytes;
};

/* Declares an array at *offset, and moves the offset past its length and its data. */
static void add_array(struct cs_text *head, const struct array *array, size_t *offset) {
    cs_text_add(head,
                "<DataArray type=\"%s\" Name=\"%s\" NumberOfComponents=\"%u\" "
                "format=\"appended\" offset=\"%zu\"/>\n",
                array->type, array->name, array->components, *offset);
    *offset += sizeof(uint64_t) + array->bytes;
}

static void add_field(struct cs_text *head, const struct cs_export_mesh *mesh, uint32_t f,
                      size_t *offset) {
    const struct cs_export_field *field = mesh->fields + f;
    const size_t bytes = mesh->n * field->components * sizeof(uint64_t);
    add_array(head, &(struct array){"Float64", field->name, field->components, bytes}, offset);
}

/* Declares the cells of one kind: points of each, and where its list of points ends. */
static void add_cells(struct cs_text *head, const char *kind, uint32_t n, uint32_t corners,
                      size_t *offset) {
    const size_t bytes = n * sizeof(int32_t);
    cs_text_add(head, "<%s>\n", kind);
    add_array(head, &(struct array){"Int32", "connectivity", 1, corners * bytes}, offset);
    add_array(head, &(struct array){"Int32", "offsets", 1, bytes}, offset);
    cs_text_add(head, "</%s>\n", kind);
}

/* Prints the head; declares arrays in the order of the data: time, fields, constant part. */
static void print_head(const struct cs_export_mesh *mesh, struct cs_text *head) {
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
                mesh->n, mesh->n_lines, mesh->n_triangles);
    add_field(head, mesh, 0, &offset);
    cs_text_add(head, "</Points>\n<PointData%s>\n", mesh->uv ? " TCoords=\"uv\"" : "");
    for (uint32_t f = 1; f < mesh->n_fields; f++)
        add_field(head, mesh, f, &offset);
    add_array(head, &(struct array){"Int32", mesh->item, 1, mesh->n * sizeof(int32_t)},
              &offset);
    if (mesh->uv)
        add_array(head, &(struct array){"Float32", "uv", 2, mesh->n * sizeof(float[2])},
                  &offset);
    cs_text_add(head, "</PointData>\n");
    add_cells(head, "Lines", mesh->n_lines, 2, &offset);
    add_cells(head, "Polys", mesh->n_triangles, 3, &offset);
    cs_text_add(head, "</Piece>\n</PolyData>\n<AppendedData encoding=\"raw\">\n_");
}

/* Writes the length of an array of n numbers of 4 bytes; returns where they go, moves *at
 * past. */
static uint32_t *begin_array(uint8_t **at, size_t n) {
    const uint64_t length = htole64(n * sizeof(uint32_t));
    memcpy(*at, &length, sizeof length);
    uint32_t *numbers = (uint32_t *)(void *)(*at + sizeof length);
    *at += sizeof length + n * sizeof(uint32_t);
    return numbers;
}

/* Writes the cells of one kind. Lengths have 8 bytes and numbers 4, so all numbers are
 * aligned. */
static void fill_cells(uint8_t **at, const uint32_t *points, uint32_t n, uint32_t corners) {
    uint32_t *connectivity = begin_array(at, (size_t)corners * n);
    for (size_t k = 0; k < (size_t)corners * n; k++)
        connectivity[k] = htole32(points[k]);
    uint32_t *ends = begin_array(at, n);
    for (uint32_t k = 0; k < n; k++)
        ends[k] = htole32((k + 1) * corners);
}

/* Writes a texture coordinate per point: that of its first corner. */
static void fill_uv(const struct cs_export_mesh *mesh, uint8_t **at) {
    float(*uv)[2] = (float(*)[2])(void *)begin_array(at, 2 * (size_t)mesh->n);
    cs_export_mesh_point_uv(mesh, uv);
    for (size_t i = 0; i < mesh->n; i++)
        for (size_t c = 0; c < 2; c++) {
            const uint32_t word = cs_float_to_le32(uv[i][c]);
            memcpy(uv[i] + c, &word, sizeof word);
        }
}

/* Writes the constant part, in the order of print_head. */
static void fill_fixed(const struct cs_export_mesh *mesh, uint8_t *at) {
    uint32_t *item = begin_array(&at, mesh->n);
    for (uint32_t b = 0; b < mesh->n_items; b++)
        for (uint32_t i = mesh->first_point[b]; i < mesh->first_point[b + 1]; i++)
            item[i] = htole32(mesh->items[b]);
    if (mesh->uv)
        fill_uv(mesh, &at);
    fill_cells(&at, mesh->lines, mesh->n_lines, 2);
    fill_cells(&at, mesh->triangles, mesh->n_triangles, 3);
}

/* Makes head and constant part: five arrays with their lengths, and uv if there is one. */
static enum cs_status make(struct common *vtp, const struct cs_export_mesh *mesh,
                           struct cs_arena *arena, struct cs_error *error) {
    vtp->fixed_bytes =
        5 * sizeof(uint64_t) + sizeof(uint32_t) * (mesh->n + 3 * (size_t)mesh->n_lines +
                                                   4 * (size_t)mesh->n_triangles);
    if (mesh->uv)
        vtp->fixed_bytes += sizeof(uint64_t) + mesh->n * sizeof(float[2]);
    vtp->fixed = cs_arena_alloc(arena, vtp->fixed_bytes, error);
    print_head(mesh, &vtp->head);
    if (vtp->head.failed)
        cs_fail(error, CS_ERR_MEMORY, "out of memory for VTP files");
    if (!error->status)
        fill_fixed(mesh, vtp->fixed);
    return error->status;
}

/* Writes an array of doubles; failures are found when the file is finished. */
static void write_array(FILE *file, const uint64_t *words, size_t n) {
    const uint64_t length = htole64(n * sizeof *words);
    fwrite(&length, sizeof length, 1, file);
    fwrite(words, sizeof *words, n, file);
}

static enum cs_status write_sample(const struct common *vtp, const struct cs_export_mesh *mesh,
                                   const char *folder, const struct cs_export_sample *sample,
                                   struct cs_error *error) {
    char path[CS_EXPORT_PATH];
    struct cs_file_out out;
    const uint64_t time = cs_double_to_le64(sample->t);
    if (cs_export_number(path, folder, mesh->name, sample->number, cs_export_vtp.ending,
                         error) ||
        cs_file_create(&out, path, error))
        return error->status;
    fwrite(vtp->head.bytes, 1, vtp->head.length, out.file);
    write_array(out.file, &time, 1);
    for (uint32_t f = 0; f < mesh->n_fields; f++)
        write_array(out.file, mesh->fields[f].words,
                    (size_t)mesh->n * mesh->fields[f].components);
    fwrite(vtp->fixed, 1, vtp->fixed_bytes, out.file);
    fputs("\n</AppendedData>\n</VTKFile>\n", out.file);
    return cs_file_finish(&out, error);
}

static const char list_head[] = "<?xml version=\"1.0\"?>\n"
                                "<VTKFile type=\"Collection\" version=\"0.1\" "
                                "byte_order=\"LittleEndian\">\n<Collection>\n";
static const char list_tail[] = "</Collection>\n</VTKFile>\n";

/* Writes entries over the closing tags, and the tags again after them. */
static enum cs_status put(struct list *pvd, struct cs_text *entries, struct cs_error *error) {
    const size_t length = entries->length;
    cs_text_add(entries, "%s", list_tail);
    if (entries->failed)
        cs_fail(error, CS_ERR_MEMORY, "out of memory for \"%s\"", pvd->file.path);
    else if (!cs_append_file_write(&pvd->file, pvd->end, entries->bytes, entries->length,
                                   error))
        pvd->end += length;
    cs_text_finish(entries);
    return error->status;
}

static enum cs_status begin_list(struct list *pvd, const char *folder, struct cs_error *error) {
    char path[CS_EXPORT_PATH];
    struct cs_text entries = {0};
    if (cs_export_name(path, folder, cs_export_vtp.files[0], error) ||
        cs_append_file_open(&pvd->file, path, 0, error))
        return error->status;
    cs_text_add(&entries, "%s", list_head);
    return put(pvd, &entries, error);
}

/* Adds a sample of bodies and colliders, if they have points. Those that never move have one
 * file, of number 0. */
static enum cs_status list_sample(struct list *pvd,
                                  const struct cs_export_mesh *const meshes[2], uint32_t number,
                                  double t, struct cs_error *error) {
    struct cs_text entries = {0};
    for (uint32_t part = 0; part < 2; part++) {
        const struct cs_export_mesh *mesh = meshes[part];
        if (mesh->n == 0)
            continue;
        cs_text_add(&entries, "<DataSet timestep=\"");
        cs_text_add_real(&entries, t);
        cs_text_add(&entries, "\" part=\"%u\" file=\"%s_%05u.vtp\"/>\n", part, mesh->name,
                    mesh->is_moving ? number : 0);
    }
    return put(pvd, &entries, error);
}

/* Writes the list again from the start, with the samples of a continued run. */
static enum cs_status open_list(struct list *list, const struct cs_export_source *source,
                                struct cs_error *error) {
    const struct cs_export_settings *settings = &source->settings;
    if (begin_list(list, settings->folder, error))
        return error->status;
    for (uint32_t k = 0; k < settings->n_samples_before && !error->status; k++)
        list_sample(list, source->meshes, k, k * settings->frame_interval / source->fps, error);
    return error->status;
}

static enum cs_status open_files(void *state, const struct cs_export_source *source,
                                 struct cs_arena *arena, struct cs_error *error) {
    struct files *files = state;
    for (int k = 0; k < 2; k++)
        if (source->meshes[k]->n > 0 && make(files->of + k, source->meshes[k], arena, error))
            return error->status;
    return open_list(&files->list, source, error);
}

static enum cs_status add_vtp(void *state, const struct cs_export_source *source,
                              const struct cs_export_sample *sample, struct cs_error *error) {
    struct files *files = state;
    for (int k = 0; k < 2; k++)
        if (cs_export_mesh_has_sample(source->meshes[k], sample) &&
            write_sample(files->of + k, source->meshes[k], source->settings.folder, sample,
                         error))
            return error->status;
    return list_sample(&files->list, source->meshes, sample->number, sample->t, error);
}

static void close_files(void *state) {
    struct files *files = state;
    for (int k = 0; k < 2; k++)
        cs_text_finish(&files->of[k].head);
    cs_append_file_close(&files->list.file);
}

const struct cs_export_writer cs_export_vtp = {
    .holds_values = true,
    .ending = "vtp",
    .files = {"run.pvd"},
    .size = sizeof(struct files),
    .open = open_files,
    .add = add_vtp,
    .close = close_files,
};
