/* Reads triangle meshes from Wavefront OBJ files in two passes: one counts, one fills. */
#include "scene/file/mesh_read.h"

#include "base/file.h"
#include "base/text.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Limits against hostile files. */
enum {
    MESH_BYTES_MAX = 1 << 30,
    VERTICES_MAX = 1 << 24,
    TRIANGLES_MAX = 1 << 26,
    WORD_MAX = 64 /* the longest number */
};

/* Numbers of the elements of a file. */
struct counts {
    uint32_t places, uv, triangles;
};

/* State of the two passes over a file. */
struct obj {
    const char *name, *cursor, *end; /* end of the text */
    uint32_t line;
    struct counts total, done; /* of the whole file; of this pass until now */
    bool textured;             /* faces name texture coordinates */
    const double *scale;
    double *uv;              /* (total.uv, 2) */
    uint32_t *lines;         /* (total.triangles) */
    struct cs_trimesh *mesh; /* NULL in the pass that counts */
    struct cs_error *error;
};

/* One corner of a face: indices from 0. */
struct corner {
    uint32_t place, uv;
    bool textured;
};

/* Fails at the current line. */
static enum cs_status fail(const struct obj *obj, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
static enum cs_status fail(const struct obj *obj, const char *format, ...) {
    char message[256];
    va_list args;
    va_start(args, format);
    vsnprintf(message, sizeof message, format, args);
    va_end(args);
    return cs_fail(obj->error, CS_ERR_FILE, "%s:%u: %s", obj->name, obj->line, message);
}

static bool is_blank(char c) {
    return c == ' ' || c == '\t' || c == '\r';
}

/* Reads the next word of the line; empty at its end. A word that is too long gets a '?', which
 * no number has. */
static void next_word(struct obj *obj, char word[WORD_MAX]) {
    size_t n = 0;
    while (obj->cursor < obj->end && is_blank(*obj->cursor))
        obj->cursor++;
    while (obj->cursor < obj->end && !is_blank(*obj->cursor) && *obj->cursor != '\n' &&
           *obj->cursor != '#') {
        if (n + 1 < WORD_MAX)
            word[n++] = *obj->cursor;
        else
            word[n - 1] = '?';
        obj->cursor++;
    }
    word[n] = 0;
}

/* Reads `least` to `most` numbers up to the end of the line. */
static enum cs_status read_numbers(struct obj *obj, const char *what, int least, int most,
                                   double *values) {
    char word[WORD_MAX];
    int n = 0;
    for (next_word(obj, word); *word; next_word(obj, word), n++) {
        double value;
        if (n == most)
            return fail(obj, "%s has more than %d numbers", what, most);
        if (!cs_parse_real(word, &value) || !(value >= -1e9 && value <= 1e9))
            return fail(obj, "found \"%s\", expected a number (-1e9..1e9)", word);
        values[n] = value;
    }
    return n < least ? fail(obj, "%s has %d numbers, expected %d", what, n, least) : CS_OK;
}

/* Reads a vertex; stores it, scaled, in the second pass. */
static enum cs_status read_position(struct obj *obj) {
    double place[3];
    if (read_numbers(obj, "a vertex", 3, 3, place))
        return obj->error->status;
    if (obj->done.places == VERTICES_MAX)
        return fail(obj, "more than %d vertices", VERTICES_MAX);
    for (size_t c = 0; obj->mesh && c < 3; c++)
        obj->mesh->positions[c * obj->total.places + obj->done.places] =
            place[c] * obj->scale[c];
    obj->done.places++;
    return CS_OK;
}

/* Reads a texture coordinate; a missing v is 0, a third number is ignored. */
static enum cs_status read_uv(struct obj *obj) {
    double uv[3] = {0};
    if (read_numbers(obj, "a texture coordinate", 1, 3, uv))
        return obj->error->status;
    if (obj->done.uv == TRIANGLES_MAX)
        return fail(obj, "more than %d texture coordinates", TRIANGLES_MAX);
    if (obj->uv)
        memcpy(obj->uv + 2 * (size_t)obj->done.uv, uv, 2 * sizeof *uv);
    obj->done.uv++;
    return CS_OK;
}

/* Converts a number of a corner to an index: from 1, or negative from the last element back.
 * Its range is checked in the second pass, which knows the total. */
static enum cs_status read_index(const struct obj *obj, const char *text, const char *what,
                                 uint32_t done, uint32_t total, uint32_t *index) {
    char *behind;
    const long value = strtol(text, &behind, 10);
    if (behind == text || *behind || value == 0)
        return fail(obj, "found \"%s\", expected the number of a %s", text, what);
    if (obj->mesh && (value > (long)total || (value < 0 && -value > (long)done)))
        return fail(obj, "%s %ld does not exist (1..%u)", what, value, total);
    *index = (uint32_t)(value > 0 ? value - 1 : (long)done + value);
    return CS_OK;
}

/* Reads v, v/vt, v//vn or v/vt/vn; ignores the number of the normal. */
static enum cs_status read_corner(const struct obj *obj, char *word, struct corner *corner) {
    char *uv = strchr(word, '/');
    corner->textured = false;
    if (uv) {
        *uv++ = 0;
        char *normal = strchr(uv, '/');
        if (normal)
            *normal = 0;
        corner->textured = *uv || !normal;
    }
    if (read_index(obj, word, "vertex", obj->done.places, obj->total.places, &corner->place))
        return obj->error->status;
    return corner->textured ? read_index(obj, uv, "texture coordinate", obj->done.uv,
                                         obj->total.uv, &corner->uv)
                            : CS_OK;
}

/* Stores a triangle with its line and texture coordinates. */
static void set_triangle(struct obj *obj, const struct corner corners[3]) {
    const size_t t = obj->done.triangles;
    obj->lines[t] = obj->line;
    for (size_t k = 0; k < 3; k++) {
        obj->mesh->triangles[3 * t + k] = corners[k].place;
        if (!obj->textured)
            continue;
        /* an OBJ's rows are counted from the bottom, a picture's from the top */
        const double *uv = obj->uv + 2 * (size_t)corners[k].uv;
        obj->mesh->uv[6 * t + 2 * k] = (float)uv[0];
        obj->mesh->uv[6 * t + 2 * k + 1] = (float)(1 - uv[1]);
    }
}

/* Reads a face of three or more corners as a fan. */
static enum cs_status read_face(struct obj *obj) {
    char word[WORD_MAX];
    struct corner fan[3];
    uint32_t n = 0;
    for (next_word(obj, word); *word; next_word(obj, word), n++) {
        /* three corners are enough: polygons become a fan around their first corner */
        struct corner *corner = fan + (n < 2 ? n : 2);
        if (read_corner(obj, word, corner))
            return obj->error->status;
        /* texture coordinates are all or none: the first corner of the file decides */
        if (obj->done.triangles == 0 && n == 0)
            obj->textured = corner->textured;
        if (corner->textured != obj->textured)
            return fail(obj, "a corner %s texture coordinate, unlike earlier corners",
                        corner->textured ? "has a" : "has no");
        if (n < 2)
            continue;
        if (obj->done.triangles == TRIANGLES_MAX)
            return fail(obj, "more than %d triangles", TRIANGLES_MAX);
        if (obj->mesh)
            set_triangle(obj, fan);
        obj->done.triangles++;
        /* the next triangle starts at the edge that this one ended with */
        fan[1] = fan[2];
    }
    return n < 3 ? fail(obj, "a face has %u corners, expected 3 or more", n) : CS_OK;
}

/* Reads a line by its first word. */
static enum cs_status read_line(struct obj *obj) {
    static const char *const passed_over[] = {"vn", "o", "g", "s", "usemtl", "mtllib"};
    char word[WORD_MAX];
    next_word(obj, word);
    if (!strcmp(word, "v"))
        return read_position(obj);
    if (!strcmp(word, "vt"))
        return read_uv(obj);
    if (!strcmp(word, "f"))
        return read_face(obj);
    if (!*word)
        return CS_OK;
    for (size_t k = 0; k < sizeof passed_over / sizeof *passed_over; k++)
        if (!strcmp(word, passed_over[k]))
            return CS_OK;
    return fail(obj, "found \"%.20s\", expected v, vt, vn, f, o, g, s, usemtl or mtllib", word);
}

/* Reads all lines once. */
static enum cs_status parse_pass(struct obj *obj, const char *text) {
    obj->done = (struct counts){0};
    obj->line = 1;
    for (obj->cursor = text; obj->cursor < obj->end; obj->line++) {
        if (read_line(obj))
            return obj->error->status;
        const char *newline = memchr(obj->cursor, '\n', (size_t)(obj->end - obj->cursor));
        obj->cursor = newline ? newline + 1 : obj->end;
    }
    return CS_OK;
}

enum cs_status cs_mesh_read_text(const char *name, const char *text, size_t length,
                                 const double scale[3], struct cs_trimesh *mesh,
                                 struct cs_arena *arena, struct cs_error *error) {
    struct obj obj = {.name = name, .end = text + length, .scale = scale, .error = error};
    if (memchr(text, 0, length))
        return cs_fail(error, CS_ERR_FILE, "%s: found a zero byte, expected text", name);
    /* the first pass only counts, since obj.mesh is still NULL */
    if (parse_pass(&obj, text))
        return error->status;
    obj.total = obj.done;
    if (cs_trimesh_init(mesh, obj.total.places, obj.total.triangles, obj.textured, arena,
                        error))
        return error->status;
    obj.mesh = mesh;
    /* one spare element each: calloc of nothing may return NULL */
    obj.uv = calloc((size_t)obj.total.uv + 1, 2 * sizeof *obj.uv);
    obj.lines = calloc((size_t)obj.total.triangles + 1, sizeof *obj.lines);
    if (!obj.uv || !obj.lines)
        cs_fail(error, CS_ERR_MEMORY, "out of memory for \"%s\"", name);
    else if (!parse_pass(&obj, text))
        cs_trimesh_finish(mesh, name, obj.lines, arena, error);
    free(obj.uv);
    free(obj.lines);
    return error->status;
}

enum cs_status cs_mesh_read(const char *path, const char *name, const double scale[3],
                            struct cs_trimesh *mesh, struct cs_arena *arena,
                            struct cs_error *error) {
    char *text;
    size_t length;
    if (!cs_file_read(path, MESH_BYTES_MAX, &text, &length, error) &&
        !cs_mesh_read_text(name, text, length, scale, mesh, arena, error))
        cs_hash_bytes(text, length, mesh->file_hash);
    free(text);
    return error->status;
}
