/* clothsim mesh: prints what a mesh file holds and how it was mended, and writes it mended. */
#include "base/file.h"
#include "cli/commands.h"
#include "cli/file_conflicts.h"
#include "cli/line/print.h"
#include "cli/run_folder.h"
#include "files/gltf_read.h"
#include "scene/file/mesh_read.h"
#include "scene/mesh_keys.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { BYTES_MAX = 1 << 30 };

struct options {
    const char *out;
    bool weld, overwrite;
};
static const struct options defaults = {.weld = true};

static const struct cs_arg rows[] = {
    {"out", 'o', "FILE", "write the mended mesh as OBJ", CS_ARG_INTO(struct options, out)},
    {"overwrite", 'y', NULL, "replace an existing file",
     CS_ARG_INTO(struct options, overwrite)},
    {"no-weld", 0, NULL, "keep duplicate vertices", CS_ARG_INTO(struct options, weld)},
};

/* Sets the sides of the box of all positions; returns the longest. */
static double measure_sides(const struct cs_trimesh *mesh, double sides[3]) {
    for (size_t c = 0; c < 3; c++) {
        const double *x = mesh->positions + c * mesh->n;
        double low = x[0], high = x[0];
        for (size_t i = 1; i < mesh->n; i++) {
            low = fmin(low, x[i]);
            high = fmax(high, x[i]);
        }
        sides[c] = high - low;
    }
    return fmax(sides[0], fmax(sides[1], sides[2]));
}

/* A name of faces, and how many have it. */
struct name {
    struct cs_mesh_label label;
    uint32_t faces;
};

static int by_name(const void *left, const void *right) {
    const struct name *a = left, *b = right;
    return a->label.kind != b->label.kind ? (int)a->label.kind - (int)b->label.kind
                                          : strcmp(a->label.names, b->label.names);
}

/* Adds a line for each name: "group waist, 12 triangles". */
static enum cs_status add_names(const struct cs_trimesh *mesh, struct cs_text *out,
                                struct cs_error *error) {
    static const char *const kinds[] = {"group", "object", "material"};
    struct name *names = calloc((size_t)mesh->n_labels + 1, sizeof *names);
    if (!names)
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for the names of a mesh");
    for (uint32_t k = 0; k < mesh->n_labels; k++)
        names[k].label = mesh->labels[k];
    for (size_t k = 0; mesh->n_labels && k < CS_LABEL_KINDS * (size_t)mesh->n_triangles; k++) {
        const uint32_t label = mesh->triangle_labels[k / CS_LABEL_KINDS][k % CS_LABEL_KINDS];
        names[label ? label - 1 : mesh->n_labels].faces++;
    }
    /* a file may give a name many times: equal ones become neighbours */
    qsort(names, mesh->n_labels, sizeof *names, by_name);
    for (uint32_t k = 0, faces = 0; k < mesh->n_labels; k++) {
        faces += names[k].faces;
        if (k + 1 < mesh->n_labels && !by_name(names + k, names + k + 1))
            continue;
        cs_text_add(out, "%-11s %s, %u triangle%s\n", kinds[names[k].label.kind],
                    names[k].label.names, faces, faces == 1 ? "" : "s");
        faces = 0;
    }
    free(names);
    return CS_OK;
}

static void add_report(const struct cs_trimesh *mesh, struct cs_text *out) {
    double sides[3];
    const double longest = measure_sides(mesh, sides);
    cs_text_add(out, "vertices    %u, in the file %u\ntriangles   %u\n", mesh->n, mesh->n_file,
                mesh->n_triangles);
    cs_text_add(out, "edges       %u, %u of them open, %.3g long in the mean\n", mesh->n_edges,
                mesh->n_open, mesh->edge);
    cs_text_add(out, "pieces      %u\nsize        %.4g x %.4g x %.4g\n", mesh->pieces, sides[0],
                sides[1], sides[2]);
    /* bodies and garments are from a hand's breadth to a few metres long */
    cs_text_add(out, "units       likely %s\n",
                longest >= 500  ? "mm"
                : longest >= 10 ? "cm"
                                : "m");
    cs_text_add(out, "mended      %s\n", *mesh->mends ? mesh->mends : "nothing");
}

/* Adds the lines that give a triangle its names, where they differ from those before. */
static void add_labels(const struct cs_trimesh *mesh, uint32_t t, struct cs_text *out) {
    static const char *const words[] = {"g", "o", "usemtl"};
    for (int kind = 0; kind < CS_LABEL_KINDS && mesh->n_labels; kind++) {
        const uint32_t label = mesh->triangle_labels[t][kind];
        if (label != (t ? mesh->triangle_labels[t - 1][kind] : 0))
            cs_text_add(out, "%s%s%s\n", words[kind], label ? " " : "",
                        label ? mesh->labels[label - 1].names : "");
    }
}

/* Adds the mesh as OBJ: a texture coordinate for each corner, if there are any. */
static void add_obj(const struct cs_trimesh *mesh, struct cs_text *out) {
    for (size_t i = 0; i < mesh->n; i++) {
        cs_text_add(out, "v");
        for (size_t c = 0; c < 3; c++) {
            cs_text_add(out, " ");
            cs_text_add_real(out, mesh->positions[c * mesh->n + i]);
        }
        cs_text_add(out, "\n");
    }
    /* rows of pictures are counted from the top, those of OBJ from the bottom */
    for (size_t k = 0; mesh->uv && k < 3 * (size_t)mesh->n_triangles; k++)
        cs_text_add(out, "vt %.9g %.9g\n", (double)mesh->uv[2 * k],
                    1 - (double)mesh->uv[2 * k + 1]);
    for (uint32_t t = 0; t < mesh->n_triangles; t++) {
        add_labels(mesh, t, out);
        cs_text_add(out, "f");
        for (uint32_t k = 3 * t; k < 3 * t + 3; k++)
            cs_text_add(out, mesh->uv ? " %u/%u" : " %u", mesh->triangles[k] + 1, k + 1);
        cs_text_add(out, "\n");
    }
}

/* Reads OBJ, or glTF by way of it. */
static enum cs_status read_mesh(const char *path, const struct cs_mesh_source *source,
                                struct cs_trimesh *mesh, struct cs_arena *arena,
                                struct cs_error *error) {
    char *bytes;
    size_t length;
    struct cs_text obj = {0};
    if (cs_file_read(path, BYTES_MAX, &bytes, &length, error))
        return error->status;
    if (!cs_gltf_is(bytes, length))
        cs_mesh_read_text(path, bytes, length, source, mesh, arena, error);
    else if (!cs_gltf_to_obj(path, bytes, length, &obj, error))
        cs_mesh_read_text(path, cs_text_get(&obj), obj.length, source, mesh, arena, error);
    cs_text_finish(&obj);
    free(bytes);
    return error->status;
}

static enum cs_status mesh(struct cs_args *args, struct cs_error *error) {
    const struct options *options = args->options;
    const struct cs_mesh_source source = {.scale = {1, 1, 1}, .weld = options->weld};
    const char *path = args->operands[0];
    struct cs_trimesh mesh;
    struct cs_text out = {0}, obj = {0};
    if (cs_file_conflicts_pair(options->out, "--out", path, "the mesh", error) ||
        (options->out && !options->overwrite && cs_output_check_file(options->out, error)) ||
        read_mesh(path, &source, &mesh, &args->arena, error))
        return error->status;
    /* what fails leaves no report behind */
    add_report(&mesh, &out);
    if (options->out)
        add_obj(&mesh, &obj);
    if (add_names(&mesh, &out, error) ||
        (options->out && cs_file_write_text(options->out, &obj, error))) {
        cs_text_finish(&out);
        cs_text_finish(&obj);
        return error->status;
    }
    return cs_print_out(stdout, &out, error);
}

const struct cs_command cs_command_mesh = {
    .name = "mesh",
    .operands = "FILE",
    .summary = "print what a mesh file holds, and write it as OBJ",
    .notes = "Example: clothsim mesh skirt.obj -o mended.obj\n",
    CS_COMMAND_OPTIONS(rows, defaults),
    .operands_min = 1,
    .operands_max = 1,
    .main = mesh,
};
