/* Reads an OBJ file line by line. Faces are stored as polygons until the end, since a face may
 * stand before its vertices. A faulty line is reported, and the next one read. */
#include "scene/file/obj_read.h"

#include "base/text.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Limits against hostile files. */
enum {
    VERTICES_MAX = 1 << 24,
    TRIANGLES_MAX = 1 << 26,
    WORD_MAX = 64,      /* the longest number */
    FAULTS_SHOWN = 4,   /* of a file */
    SKIPPED_BYTES = 64, /* of words of lines passed over */
};

/* A face: its corners begin here, and end where those of the next one begin. */
struct face {
    size_t begin;
    uint32_t line, labels[CS_LABEL_KINDS];
};

/* A growing array. */
struct array {
    void *items;
    size_t n, capacity;
};

struct reader {
    const char *name, *cursor, *end; /* end of the text */
    uint32_t line, joined;           /* its number; lines that it goes on in */
    struct array positions, uv, faces, corners, labels;
    uint32_t labels_now[CS_LABEL_KINDS];
    struct cs_obj *obj;
    struct cs_text faults;
    uint32_t n_faults;
    struct cs_arena *arena;
    struct cs_error *error;
};

/* Reports a fault of a line; returns false. */
__attribute__((format(printf, 3, 4))) static bool fault_at(struct reader *in, uint32_t line,
                                                           const char *format, ...) {
    char message[160];
    CS_FORMAT(message, format);
    if (in->n_faults++ < FAULTS_SHOWN)
        cs_text_add(&in->faults, "%s%.128s:%u: %s", in->n_faults > 1 ? "; " : "", in->name,
                    line, message);
    return false;
}

/* Adds a zeroed item; NULL and CS_ERR_MEMORY if out of memory. */
static void *append(struct reader *in, struct array *array, size_t size) {
    if (!cs_arena_realloc(&array->items, &array->capacity, array->n + 1, size)) {
        cs_fail(in->error, CS_ERR_MEMORY, "out of memory for \"%s\"", in->name);
        return NULL;
    }
    return memset((char *)array->items + array->n++ * size, 0, size);
}

/* --- words --- */

static bool is_end(char c) {
    return c == '\n' || c == '\r';
}

/* Moves over the end of a line: LF, CR, or CR LF. */
static void skip_end(struct reader *in) {
    const bool both = *in->cursor == '\r' && in->cursor + 1 < in->end && in->cursor[1] == '\n';
    in->cursor += both ? 2 : 1;
}

/* Moves over blanks, and over ends of lines behind a backslash. */
static void skip_blanks(struct reader *in) {
    for (; in->cursor < in->end; in->cursor++) {
        if (*in->cursor == '\\' && in->cursor + 1 < in->end && is_end(in->cursor[1])) {
            in->cursor++;
            skip_end(in);
            in->cursor--;
            in->joined++;
        } else if (*in->cursor != ' ' && *in->cursor != '\t')
            return;
    }
}

static bool is_in_word(const struct reader *in) {
    return in->cursor < in->end && !strchr(" \t\r\n#", *in->cursor) &&
           !(*in->cursor == '\\' && in->cursor + 1 < in->end && is_end(in->cursor[1]));
}

/* Reads the next word of the line; empty at its end. A word that is too long gets a '?', which
 * no number has. */
static void next_word(struct reader *in, char word[WORD_MAX]) {
    size_t n = 0;
    skip_blanks(in);
    for (; is_in_word(in); in->cursor++) {
        if (n + 1 < WORD_MAX)
            word[n++] = *in->cursor;
        else
            word[n - 1] = '?';
    }
    word[n] = 0;
}

/* Reads at least `least` numbers, the first `most` of which are stored. */
static bool read_numbers(struct reader *in, const char *what, int least, int most,
                         double *values) {
    char word[WORD_MAX];
    int n = 0;
    for (next_word(in, word); *word; next_word(in, word), n++) {
        double value;
        if (!cs_parse_real(word, &value) || !(value >= -1e9 && value <= 1e9))
            return fault_at(in, in->line, "found \"%s\", expected a number (-1e9..1e9)", word);
        if (n < most)
            values[n] = value;
    }
    return n >= least ||
           fault_at(in, in->line, "%s has %d numbers, expected %d", what, n, least);
}

/* --- lines --- */

/* Adds the numbers of a line, 0 where they are missing: a faulty vertex keeps its number, or
 * later lines would be blamed. */
static void read_values(struct reader *in, const char *what, int least, int most,
                        struct array *array) {
    double values[3] = {0};
    read_numbers(in, what, least, most, values);
    double *to = append(in, array, (size_t)most * sizeof *to);
    if (to)
        memcpy(to, values, (size_t)most * sizeof *to);
}

/* Converts a number of a corner to one from 1; it is compared with the total at the end. */
static bool read_index(struct reader *in, const char *text, const char *what, size_t done,
                       uint32_t *index) {
    char *behind;
    const long value = strtol(text, &behind, 10);
    if (behind == text || *behind || value == 0)
        return fault_at(in, in->line, "found \"%s\", expected the number of a %s", text, what);
    if (value < 0 ? (size_t) - (value + 1) >= done : (uint64_t)value > UINT32_MAX)
        return fault_at(in, in->line, "%s %s does not exist (1..%zu)", what, text, done);
    *index = value < 0 ? (uint32_t)(done + 1 - (size_t)-value) : (uint32_t)value;
    return true;
}

/* Reads v, v/vt, v//vn, v/vt/vn, v/ or v//; the number of the normal is ignored. */
static bool read_corner(struct reader *in, char *word, struct cs_raw_corner *corner) {
    char *uv = strchr(word, '/');
    *corner = (struct cs_raw_corner){0};
    if (uv) {
        *uv++ = 0;
        uv[strcspn(uv, "/")] = 0;
    }
    return read_index(in, word, "vertex", in->positions.n, &corner->vertex) &&
           (!uv || !*uv || read_index(in, uv, "texture coordinate", in->uv.n, &corner->uv));
}

static void read_face(struct reader *in) {
    char word[WORD_MAX];
    struct cs_raw_corner corner;
    /* corners of a faulty face are given back */
    const size_t begin = in->corners.n;
    bool is_good = true;
    for (next_word(in, word); *word && is_good && !in->error->status; next_word(in, word)) {
        is_good = read_corner(in, word, &corner);
        struct cs_raw_corner *to = is_good ? append(in, &in->corners, sizeof corner) : NULL;
        if (to)
            *to = corner;
    }
    const size_t n = in->corners.n - begin;
    if (is_good && n < 3)
        is_good = fault_at(in, in->line, "a face has %zu corners, expected 3 or more", n);
    struct face *face = is_good ? append(in, &in->faces, sizeof *face) : NULL;
    if (!face) {
        in->corners.n = begin;
        return;
    }
    *face = (struct face){.begin = begin, .line = in->line};
    memcpy(face->labels, in->labels_now, sizeof face->labels);
}

/* Reads the names behind g, o or usemtl, for the faces that follow. */
static void read_label(struct reader *in, enum cs_label_kind kind) {
    struct cs_text names = {0};
    char word[WORD_MAX];
    in->labels_now[kind] = 0;
    for (next_word(in, word); *word; next_word(in, word))
        cs_text_add(&names, "%s%s", names.length ? " " : "", word);
    if (!names.length)
        return;
    struct cs_mesh_label *label = append(in, &in->labels, sizeof *label);
    char *copy = cs_arena_copy_text(in->arena, cs_text_get(&names), in->error);
    if (label && copy && !names.failed) {
        *label = (struct cs_mesh_label){copy, kind};
        in->labels_now[kind] = (uint32_t)in->labels.n;
    }
    cs_text_finish(&names);
}

/* Counts a line of another program, and keeps its word once. */
static void skip_line(struct reader *in, const char *word) {
    static const char *const silent[] = {"vn", "vp", "s", "mg", "mtllib", "l", "p"};
    char whole[WORD_MAX + 4];
    for (size_t k = 0; k < sizeof silent / sizeof *silent; k++)
        if (!strcmp(word, silent[k]))
            return;
    struct cs_text *skipped = &in->obj->skipped;
    snprintf(whole, sizeof whole, ", %s,", word);
    in->obj->n_skipped++;
    /* bytes that are no text are not repeated */
    if (word[strspn(word, "abcdefghijklmnopqrstuvwxyz_0123456789")] ||
        skipped->length > SKIPPED_BYTES)
        return;
    if (!strstr(cs_text_get(skipped), whole))
        cs_text_add(skipped, skipped->length ? " %s," : ", %s,", word);
}

static void read_line(struct reader *in) {
    char word[WORD_MAX];
    next_word(in, word);
    if (!strcmp(word, "v"))
        read_values(in, "a vertex", 3, 3, &in->positions);
    else if (!strcmp(word, "vt"))
        read_values(in, "a texture coordinate", 1, 2, &in->uv);
    else if (!strcmp(word, "f"))
        read_face(in);
    else if (!strcmp(word, "g"))
        read_label(in, CS_LABEL_GROUP);
    else if (!strcmp(word, "o"))
        read_label(in, CS_LABEL_OBJECT);
    else if (!strcmp(word, "usemtl"))
        read_label(in, CS_LABEL_MATERIAL);
    else if (*word)
        skip_line(in, word);
}

static void read_lines(struct reader *in) {
    if (in->end - in->cursor >= 3 && !memcmp(in->cursor, "\xef\xbb\xbf", 3))
        in->cursor += 3;
    for (in->line = 1; in->cursor < in->end && !in->error->status; in->line += 1 + in->joined) {
        in->joined = 0;
        read_line(in);
        while (in->cursor < in->end && !is_end(*in->cursor))
            in->cursor++;
        if (in->cursor < in->end)
            skip_end(in);
    }
}

/* --- triangles --- */

static size_t face_end(const struct reader *in, size_t f) {
    const struct face *faces = in->faces.items;
    return f + 1 < in->faces.n ? faces[f + 1].begin : in->corners.n;
}

/* Makes the numbers of corners indices from 0; texture coordinates stay from 1. */
static void check_corners(struct reader *in) {
    const struct face *faces = in->faces.items;
    struct cs_raw_corner *corners = in->corners.items;
    for (size_t f = 0; f < in->faces.n; f++)
        for (size_t c = faces[f].begin; c < face_end(in, f); c++) {
            if (corners[c].vertex > in->positions.n)
                fault_at(in, faces[f].line, "vertex %u does not exist (1..%zu)",
                         corners[c].vertex, in->positions.n);
            if (corners[c].uv > in->uv.n)
                fault_at(in, faces[f].line, "texture coordinate %u does not exist (1..%zu)",
                         corners[c].uv, in->uv.n);
            in->obj->is_textured = in->obj->is_textured || corners[c].uv;
            corners[c].vertex--;
        }
}

static enum cs_status fail_faults(struct reader *in) {
    if (in->n_faults > FAULTS_SHOWN)
        cs_text_add(&in->faults, "; and %u more", in->n_faults - FAULTS_SHOWN);
    return in->n_faults ? cs_fail(in->error, CS_ERR_FILE, "%s", cs_text_get(&in->faults))
                        : in->error->status;
}

/* Cuts a face of n corners and adds its triangles. scratch: (n, 3) positions, then numbers. */
static void add_triangles(struct reader *in, const struct face *face, uint32_t n,
                          double (*x)[3], uint32_t *numbers) {
    const struct cs_raw_corner *corners =
        (const struct cs_raw_corner *)in->corners.items + face->begin;
    const double(*positions)[3] = (const double(*)[3])in->positions.items;
    struct cs_raw_mesh *mesh = &in->obj->mesh;
    for (uint32_t i = 0; i < n; i++)
        memcpy(x[i], positions[corners[i].vertex], sizeof *x);
    if (!cs_polygon_cut((const double(*)[3])x, n, numbers, numbers + n))
        cs_mesh_fault_count(&in->obj->mends.crossed, &in->obj->mends.crossed_line, face->line);
    for (uint32_t t = 0; t < n - 2; t++) {
        struct cs_raw_triangle *to = mesh->triangles + mesh->n_triangles++;
        for (int k = 0; k < 3; k++)
            to->corners[k] = corners[numbers[n + 3 * t + (uint32_t)k]];
        to->line = face->line;
        memcpy(to->labels, face->labels, sizeof to->labels);
    }
}

static enum cs_status cut_faces(struct reader *in) {
    const struct face *faces = in->faces.items;
    const size_t total = in->corners.n - 2 * in->faces.n;
    size_t most = 3;
    for (size_t f = 0; f < in->faces.n; f++)
        most =
            most > face_end(in, f) - faces[f].begin ? most : face_end(in, f) - faces[f].begin;
    double(*x)[3] = calloc(most, sizeof *x);
    uint32_t *numbers = calloc(4 * most, sizeof *numbers);
    in->obj->mesh.triangles = calloc(total + 1, sizeof *in->obj->mesh.triangles);
    if (!x || !numbers || !in->obj->mesh.triangles)
        cs_fail(in->error, CS_ERR_MEMORY, "out of memory for \"%s\"", in->name);
    for (size_t f = 0; !in->error->status && f < in->faces.n; f++)
        add_triangles(in, faces + f, (uint32_t)(face_end(in, f) - faces[f].begin), x, numbers);
    free(x);
    free(numbers);
    return in->error->status;
}

/* Lists the vertices of all faces. */
static enum cs_status list_faces(const struct reader *in) {
    const struct face *faces = in->faces.items;
    const struct cs_raw_corner *corners = in->corners.items;
    struct cs_obj *obj = in->obj;
    obj->face_list = calloc(in->corners.n + in->faces.n + 1, sizeof *obj->face_list);
    if (!obj->face_list)
        return cs_fail(in->error, CS_ERR_MEMORY, "out of memory for \"%s\"", in->name);
    for (size_t f = 0; f < in->faces.n; f++) {
        for (size_t c = faces[f].begin; c < face_end(in, f); c++)
            obj->face_list[obj->n_face_list++] = corners[c].vertex;
        obj->face_list[obj->n_face_list++] = UINT32_MAX;
    }
    return CS_OK;
}

/* Passes arrays on, and turns faces into triangles. */
static enum cs_status make_mesh(struct reader *in) {
    struct cs_obj *obj = in->obj;
    if (in->positions.n > VERTICES_MAX)
        fault_at(in, in->line, "more than %d vertices", VERTICES_MAX);
    if (in->uv.n > TRIANGLES_MAX || in->corners.n > TRIANGLES_MAX)
        fault_at(in, in->line, "more than %d corners", TRIANGLES_MAX);
    check_corners(in);
    if (in->error->status || fail_faults(in))
        return in->error->status;
    obj->mesh.n_vertices = (uint32_t)in->positions.n;
    obj->mesh.n_uv = (uint32_t)in->uv.n;
    return cut_faces(in) ? in->error->status : list_faces(in);
}

enum cs_status cs_obj_read(const char *name, const char *text, size_t length,
                           struct cs_obj *out, struct cs_arena *arena, struct cs_error *error) {
    struct reader in = {.name = name,
                        .cursor = text,
                        .end = text + length,
                        .obj = out,
                        .arena = arena,
                        .error = error};
    if (length >= 4 && !memcmp(text, "glTF", 4))
        return cs_fail(
            error, CS_ERR_FILE,
            "%.128s: found glTF, expected OBJ: clothsim mesh FILE -o FILE.obj makes it", name);
    if (length && memchr(text, 0, length))
        return cs_fail(error, CS_ERR_FILE, "%s: found a zero byte, expected text", name);
    read_lines(&in);
    /* arrays are passed on whatever happens, for cs_obj_finish to free */
    if (!error->status)
        make_mesh(&in);
    out->mesh.positions = in.positions.items;
    out->mesh.uv = in.uv.items;
    out->labels = in.labels.items;
    out->n_labels = (uint32_t)in.labels.n;
    free(in.faces.items);
    free(in.corners.items);
    cs_text_finish(&in.faults);
    return error->status;
}

void cs_obj_finish(struct cs_obj *obj) {
    cs_raw_mesh_finish(&obj->mesh);
    free(obj->labels);
    free(obj->face_list);
    cs_text_finish(&obj->skipped);
    *obj = (struct cs_obj){0};
}
