/* Reads glTF 2.0 in its binary form: a header, a chunk of JSON, a chunk of bytes. Each number
 * of the JSON is below 2^32 or none, so that no sum or product of two overflows. */
#include "files/gltf_read.h"

#include "scene/file/json.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

enum { CORNERS_MAX = 1 << 24, DEPTH_MAX = 64, NODES_MAX = 1 << 14, TRIANGLES = 4 };
enum { HEAD = 12, CHUNK = 8, JSON_CHUNK = 0x4e4f534a };
enum { BYTES = 5121, SHORTS = 5123, FLOATS = 5126 }; /* types of components */
static const uint64_t none = UINT64_MAX;             /* no count */

struct glb {
    struct cs_json *root;
    const unsigned char *bin;
    uint64_t n_bin, n_vertices, n_corners, n_uv, n_nodes;
    struct cs_text *out;
};

/* The values of an accessor. */
struct column {
    const unsigned char *first;
    uint64_t stride, n, type;
};

static uint64_t little(const unsigned char *bytes, size_t n) {
    uint64_t value = 0;
    while (n--)
        value = value << 8 | bytes[n];
    return value;
}

/* A member that is a count; `absent` if there is none, none if it is something else. */
static uint64_t count_of(const struct cs_json *object, const char *key, uint64_t absent) {
    const struct cs_json *value = cs_json_find(object, key);
    const double x =
        value && cs_json_kind_of(value) == CS_JSON_NUMBER ? cs_json_number(value) : -1;
    return !value ? absent : x >= 0 && x < UINT32_MAX && floor(x) == x ? (uint64_t)x : none;
}

static const struct cs_json *first_of(const struct cs_json *object, const char *key) {
    const struct cs_json *list = cs_json_find_kind(object, key, CS_JSON_LIST);
    return list ? cs_json_first(list) : NULL;
}

static const struct cs_json *item_of(const struct glb *glb, const char *list, uint64_t number) {
    const struct cs_json *items = cs_json_find(glb->root, list);
    return number < UINT32_MAX ? cs_json_at(items, (uint32_t)number) : NULL;
}

/* Opens accessor `number` of n components; false if not all of it is in the chunk of bytes. */
static bool open_column(const struct glb *glb, uint64_t number, uint64_t n,
                        struct column *out) {
    static const char *const types[] = {"", "SCALAR", "VEC2", "VEC3"};
    const struct cs_json *of = item_of(glb, "accessors", number),
                         *view = item_of(glb, "bufferViews", count_of(of, "bufferView", none)),
                         *type = cs_json_find_kind(of, "type", CS_JSON_TEXT);
    const uint64_t begin = count_of(view, "byteOffset", 0), at = count_of(of, "byteOffset", 0),
                   length = count_of(view, "byteLength", none);
    out->type = count_of(of, "componentType", none);
    out->n = count_of(of, "count", none);
    const uint64_t size = n * (out->type == BYTES ? 1 : out->type == SHORTS ? 2 : 4);
    /* absent: values follow each other */
    out->stride = count_of(view, "byteStride", size);
    if (!type || strcmp(cs_json_text(type), types[n]) || cs_json_find(of, "sparse") ||
        count_of(view, "buffer", none) || begin == none || at == none || length == none ||
        out->n - 1 >= none - 1 || out->stride < size || out->stride == none ||
        begin + length > glb->n_bin || at + (out->n - 1) * out->stride + size > length)
        return false;
    out->first = glb->bin + begin + at;
    return true;
}

static double real_at(const struct column *column, uint64_t i, uint64_t component) {
    const uint32_t bits =
        (uint32_t)little(column->first + i * column->stride + 4 * component, 4);
    float value;
    memcpy(&value, &bits, sizeof value);
    return (double)value;
}

/* Adds a line of a keyword and a name, without characters that have a meaning in OBJ. */
static void add_name(const struct glb *glb, const char *word, const struct cs_json *named) {
    const struct cs_json *name = cs_json_find_kind(named, "name", CS_JSON_TEXT);
    cs_text_add(glb->out, "%s ", word);
    for (const char *c = name ? cs_json_text(name) : ""; *c; c++)
        cs_text_add(glb->out, "%c", (unsigned char)*c <= ' ' || strchr("#\\", *c) ? '_' : *c);
    cs_text_add(glb->out, "\n");
}

static void add_vertices(const struct glb *glb, const struct column *x, const double m[3][4]) {
    for (uint64_t i = 0; i < x->n; i++) {
        cs_text_add(glb->out, "v");
        for (size_t c = 0; c < 3; c++) {
            cs_text_add(glb->out, " ");
            cs_text_add_real(glb->out, m[c][0] * real_at(x, i, 0) + m[c][1] * real_at(x, i, 1) +
                                           m[c][2] * real_at(x, i, 2) + m[c][3]);
        }
        cs_text_add(glb->out, "\n");
    }
}

/* Adds a primitive of triangles, placed by the rows m; returns what is wrong with it, or NULL.
 */
static const char *add_primitive(struct glb *glb, const struct cs_json *primitive,
                                 const double m[3][4]) {
    const struct cs_json *names = cs_json_find(primitive, "attributes");
    const uint64_t uv_number = count_of(names, "TEXCOORD_0", none),
                   indices = count_of(primitive, "indices", none);
    const double flips = m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
                         m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
                         m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
    struct column x, uv = {0}, index = {0};
    if (count_of(primitive, "mode", TRIANGLES) < TRIANGLES)
        return NULL;
    if (count_of(primitive, "mode", TRIANGLES) > TRIANGLES)
        return "a mode other than triangles, expected 4";
    if (!open_column(glb, count_of(names, "POSITION", none), 3, &x) || x.type != FLOATS ||
        (cs_json_find(primitive, "indices") && !open_column(glb, indices, 1, &index)) ||
        index.type == FLOATS)
        return "an accessor of positions or indices that is compressed, sparse or not in it";
    /* coordinates of other types than floats are rare, and do without */
    if (!open_column(glb, uv_number, 2, &uv) || uv.type != FLOATS || uv.n != x.n)
        uv.n = 0;
    const size_t size = index.type == BYTES ? 1 : index.type == SHORTS ? 2 : 4;
    const uint64_t corners = index.n ? index.n : x.n;
    /* nodes may repeat a mesh without end */
    if ((glb->n_corners += corners + x.n) > CORNERS_MAX)
        return "more than 16777216 corners and vertices";
    add_name(glb, "usemtl", item_of(glb, "materials", count_of(primitive, "material", none)));
    add_vertices(glb, &x, m);
    for (uint64_t i = 0; i < uv.n; i++)
        cs_text_add(glb->out, "vt %.9g %.9g\n", real_at(&uv, i, 0), 1 - real_at(&uv, i, 1));
    for (uint64_t k = 0; k + 3 <= corners; k += 3) {
        cs_text_add(glb->out, "f");
        for (size_t c = 0; c < 3; c++) {
            const uint64_t i = k + (flips < 0 ? 2 - c : c);
            const uint64_t v = index.n ? little(index.first + i * index.stride, size) : i;
            if (v >= x.n)
                return "an index beyond its vertices";
            cs_text_add(glb->out, uv.n ? " %" PRIu64 "/%" PRIu64 : " %" PRIu64,
                        glb->n_vertices + v + 1, glb->n_uv + v + 1);
        }
        cs_text_add(glb->out, "\n");
    }
    glb->n_vertices += x.n;
    glb->n_uv += uv.n;
    return NULL;
}

/* Sets values to those of a list of n numbers; false if it is another one. */
static bool read_list(const struct cs_json *object, const char *key, size_t n, double *values) {
    const struct cs_json *list = cs_json_find(object, key), *item = first_of(object, key);
    bool fits = !list || (item && cs_json_count(list) == n);
    for (; fits && item; item = cs_json_next(item)) {
        fits = cs_json_kind_of(item) == CS_JSON_NUMBER;
        *values++ = fits ? cs_json_number(item) : 0;
    }
    return fits;
}

/* The rows of a node's transform, below those of its parent. */
static bool place_node(const struct cs_json *node, const double up[3][4], double m[3][4]) {
    double a[16] = {0}, t[3] = {0}, q[4] = {0, 0, 0, 1}, s[3] = {1, 1, 1};
    if (!read_list(node, "matrix", 16, a) || !read_list(node, "translation", 3, t) ||
        !read_list(node, "rotation", 4, q) || !read_list(node, "scale", 3, s))
        return false;
    for (int c = 0; c < 3 && !cs_json_find(node, "matrix"); c++) {
        /* column c of the rotation: e_c turned by the unit quaternion */
        const int d = (c + 1) % 3, e = (c + 2) % 3;
        a[4 * c + c] = s[c] * (1 - 2 * (q[d] * q[d] + q[e] * q[e]));
        a[4 * c + d] = s[c] * 2 * (q[c] * q[d] + q[3] * q[e]);
        a[4 * c + e] = s[c] * 2 * (q[c] * q[e] - q[3] * q[d]);
        a[12 + c] = t[c];
    }
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 4; c++) {
            m[r][c] = c == 3 ? up[r][3] : 0;
            for (int k = 0; k < 3; k++)
                m[r][c] += up[r][k] * a[4 * c + k];
        }
    return true;
}

static const char *add_node(struct glb *glb, const struct cs_json *number,
                            const double up[3][4], int depth) {
    const bool counts =
        cs_json_kind_of(number) == CS_JSON_NUMBER && cs_json_number(number) >= 0;
    const struct cs_json *node =
        counts ? item_of(glb, "nodes", (uint64_t)fmin(cs_json_number(number), UINT32_MAX))
               : NULL;
    const struct cs_json *mesh = item_of(glb, "meshes", count_of(node, "mesh", none));
    const struct cs_json *item = first_of(mesh, "primitives");
    /* what stands below a node moves with it */
    double m[3][4];
    const char *fault = !node || !place_node(node, up, m) ? "a node that is none" : NULL;
    if (!fault && (depth == DEPTH_MAX || glb->n_nodes++ == NODES_MAX))
        return "nodes below themselves, or more than 16384";
    if (item && !fault)
        add_name(glb, "g", node);
    for (; item && !fault; item = cs_json_next(item))
        fault = add_primitive(glb, item, (const double(*)[4])m);
    item = first_of(node, "children");
    for (; item && !fault; item = cs_json_next(item))
        fault = add_node(glb, item, (const double(*)[4])m, depth + 1);
    return fault;
}

bool cs_gltf_is(const char *bytes, size_t length) {
    return length >= 4 && !memcmp(bytes, "glTF", 4);
}

/* Finds the two chunks, and adds the scene. */
static const char *add_scene(struct glb *glb, const unsigned char *bytes, size_t length) {
    static const double whole[3][4] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}};
    struct cs_json_fault fault;
    const char *wrong = NULL;
    const size_t begin = HEAD + CHUNK, n = length < begin ? 0 : little(bytes + HEAD, 4);
    if (length < begin || little(bytes + 4, 4) != 2 ||
        little(bytes + HEAD + 4, 4) != JSON_CHUNK || n > length - begin)
        return "no chunk of JSON of version 2";
    if (length - begin - n >= CHUNK) {
        glb->bin = bytes + begin + n + CHUNK;
        glb->n_bin = little(bytes + begin + n, 4);
        if (glb->n_bin > length - begin - n - CHUNK)
            return "fewer bytes than its length";
    }
    /* the parser wants a zero behind the text */
    struct cs_text text = {0};
    cs_text_add_bytes(&text, bytes + begin, n);
    const enum cs_status status =
        text.failed ? CS_ERR_MEMORY : cs_json_parse(cs_text_get(&text), n, &glb->root, &fault);
    if (status)
        wrong = status == CS_ERR_MEMORY ? "" : "JSON that is none";
    const struct cs_json *scene = item_of(glb, "scenes", count_of(glb->root, "scene", 0));
    const struct cs_json *node = first_of(scene, "nodes");
    for (; node && !wrong; node = cs_json_next(node))
        wrong = add_node(glb, node, whole, 0);
    cs_json_destroy(glb->root);
    cs_text_finish(&text);
    return wrong;
}

enum cs_status cs_gltf_to_obj(const char *name, const char *bytes, size_t length,
                              struct cs_text *obj, struct cs_error *error) {
    struct glb glb = {.out = obj};
    const char *wrong = add_scene(&glb, (const unsigned char *)bytes, length);
    if (obj->failed || (wrong && !*wrong))
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for \"%.200s\"", name);
    return wrong ? cs_fail(error, CS_ERR_FILE, "%.200s: found %s, expected glTF 2.0 (.glb)",
                           name, wrong)
                 : CS_OK;
}
