/* shade.c - Blinn-Phong (cloth thesis, eq. 4.15; Blinn 1977) with a soft shadow, and the looks
 * that colour by a value: the formulas of the OpenGL shaders, over arrays.
 *
 * With unit vectors n (normal), l (to the light), v (to the eye) and h = (l + v) / |l + v|:
 *   colour = a(n, v) fold k_a A b + sum over lights V (k_d max(n.l, 0) D b + k_s max(n.h, 0)^s
 * S) b is the base colour, A, D, S the ambient, diffuse and specular light, V the visibility of
 * a light (shadow_map.h). All of them are linear; sRGB is encoded last.
 *
 * Interpolation: planes hold 1/w and attribute/w (triangle.c). The view depth of a fragment is
 * t = 1/(1/w), its position is eye + t d with the ray d of its pixel, and an attribute is
 * (attribute/w) t. The normal needs no t, because it is normalised.
 *
 * Each loop does one thing to all fragments, which compilers turn into vectors. A square root
 * of a choice is not vectorised, so choices are stored before. */
#include "draw/cpu/shade.h"

#include "draw/cpu/triangle.h"

#include <math.h>

enum { N = CS_FRAGMENTS };

/* Light above which highlights bend, chosen by trial; also in gl/shader_sources.c. */
#define CS_KNEE 0.6f

// shininess is rounded to 1/256; attributes are computed only as far as the mode reads them

void cs_shading_material_make(struct cs_shading_material *material,
                              const struct cs_surface_style *style) {
    for (int i = 0; i < 3; i++) {
        material->base[0][i] = (float)style->front_colour[i];
        material->base[1][i] = (float)style->back_colour[i];
    }
    material->mode = style->mode;
    material->has_ambient_occlusion = style->has_ambient_occlusion;
    // the ground has one normal, which is in its style
    material->attributes =
        style->ground.radius > 0                                             ? 0
        : style->mode == CS_SURFACE_TEXTURED || style->mode == CS_SURFACE_UV ? CS_ATTRIBUTES
        : style->mode == CS_SURFACE_VALUE || style->has_ambient_occlusion    ? 4
                                                                             : 3;
    material->ambient = (float)style->ambient;
    material->diffuse = (float)style->diffuse;
    material->specular = (float)style->specular;
    const int parts = (int)(style->shininess * 256 + 0.5);
    material->shininess_int = parts / 256;
    material->shininess_fraction = parts % 256;
    material->ground = style->ground;
    material->depth_bias = (float)style->depth_bias;
}

// positions and view directions of parallel rays, whose view depth is stored
static void find_parallel_places(const struct cs_shading_context *shading,
                                 const struct cs_fragments *f, struct cs_shading_work *w) {
    const struct cs_rays *r = &shading->rays;
    for (int i = 0; i < N; i++) {
        float d[3];
        cs_ray_direction(shading, f->x[i], f->y[i], d);
        for (int k = 0; k < 3; k++) {
            w->view[k][i] = r->back[k];
            w->place[k][i] = r->eye[k] + d[k] - f->view_depth[i] * r->back[k];
        }
    }
}

// positions and view directions of a perspective, from 1/w
CS_INLINE void find_positions(const struct cs_shading_context *shading,
                              const struct cs_fragments *f, struct cs_shading_work *w) {
    for (int i = 0; i < N; i++) {
        const float t = 1 / f->inverse[i];
        float d[3];
        cs_ray_direction(shading, f->x[i], f->y[i], d);
        const float length = 1 / sqrtf(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
        for (int k = 0; k < 3; k++) {
            w->place[k][i] = shading->rays.eye[k] + t * d[k];
            w->view[k][i] = -d[k] * length;
        }
    }
}

// unit normals; a normal of length 0 stays 0 instead of becoming NaN
CS_INLINE void find_normals(const struct cs_fragments *f, struct cs_shading_work *w) {
    const struct cs_ground_style *ground = &f->material->ground;
    for (int k = 0; k < 3 && ground->radius > 0; k++)
        for (int i = 0; i < N; i++)
            w->normal[k][i] = f->side ? -ground->normal[k] : ground->normal[k];
    if (ground->radius > 0)
        return;
    for (int i = 0; i < N; i++) {
        const float x = f->attributes[0][i], y = f->attributes[1][i], z = f->attributes[2][i];
        const float square = x * x + y * y + z * z;
        w->facing[i] = square > 1e-30f ? square : 1e-30f;
    }
    for (int i = 0; i < N; i++) {
        const float length = 1 / sqrtf(w->facing[i]);
        for (int k = 0; k < 3; k++)
            w->normal[k][i] = f->attributes[k][i] * length;
    }
}

// directions to the light and n.l; light[3] is 1 for a lamp at a place, 0 for one at infinity
CS_INLINE void find_light(const float lamp[4], struct cs_shading_work *w) {
    const float x = lamp[0], y = lamp[1], z = lamp[2], near = lamp[3];
    for (int i = 0; i < N; i++) {
        const float a = x - near * w->place[0][i], b = y - near * w->place[1][i];
        const float c = z - near * w->place[2][i];
        const float length = 1 / sqrtf(a * a + b * b + c * c);
        w->light[0][i] = a * length;
        w->light[1][i] = b * length;
        w->light[2][i] = c * length;
        w->facing[i] = w->normal[0][i] * w->light[0][i] + w->normal[1][i] * w->light[1][i] +
                       w->normal[2][i] * w->light[2][i];
    }
}

/* max(n.h, 0)^s. The whole part of s is a power by repeated squaring. The fraction is a product
 * of the roots x^(1/2), x^(1/4), ... x^(1/256) of its bits; rounding to 1/256 is an error of
 * the exponent of at most 1/512. Powers below 1e-18 become 0 before their squares are denormal,
 * because arithmetic on denormals is slow. */
CS_INLINE void find_shine(const struct cs_shading_material *material,
                          struct cs_shading_work *w) {
    float power[N];
    for (int i = 0; i < N; i++) {
        float h[3], square = 0, along = 0;
        for (int k = 0; k < 3; k++) {
            h[k] = w->light[k][i] + w->view[k][i];
            square += h[k] * h[k];
            along += h[k] * w->normal[k][i];
        }
        power[i] = square > 1e-30f ? square : 1e-30f;
        w->shine[i] = along;
    }
    for (int i = 0; i < N; i++) {
        const float cosine = w->shine[i] / sqrtf(power[i]);
        power[i] = cosine > 0 ? cosine : 0;
        w->shine[i] = 1;
    }
    for (int bit = 128; bit && material->shininess_fraction; bit >>= 1) {
        float root[N];
        // from the half on, each root is one of the one before
        for (int i = 0; i < N; i++)
            root[i] = bit == 128 ? power[i] : w->cover[i];
        for (int i = 0; i < N; i++)
            w->cover[i] = sqrtf(root[i]);
        for (int i = 0; i < N && (material->shininess_fraction & bit); i++)
            w->shine[i] *= w->cover[i];
    }
    for (int left = material->shininess_int; left; left >>= 1) {
        for (int i = 0; i < N && (left & 1); i++)
            w->shine[i] *= power[i];
        for (int i = 0; i < N; i++) {
            const float square = power[i] * power[i];
            power[i] = square > 1e-18f ? square : 0;
        }
    }
}

// multiplies the base colour by the texture
static void paint_base(const struct cs_fragments *f, struct cs_shading_work *w) {
    for (int i = 0; i < f->n; i++) {
        const float t = 1 / f->inverse[i];
        float rgb[3];
        cs_mipmap_sample(f->material->mips, f->attributes[4][i] * t, f->attributes[5][i] * t,
                         f->footprints + i, rgb);
        for (int k = 0; k < 3; k++)
            w->base[k][i] *= rgb[k];
    }
}

/* Ambient fraction in folds, 1 / sqrt(1 + depth^2) for a fold of positive depth (mesh.h). Seen
 * from behind, a fold is a ridge and the other way round. */
CS_INLINE void find_folds(const struct cs_fragments *f, float folds[N]) {
    const float side = f->side ? -1 : 1;
    if (!f->material->has_ambient_occlusion) {
        for (int i = 0; i < N; i++)
            folds[i] = 1;
        return;
    }
    for (int i = 0; i < N; i++) {
        const float deep = side * f->attributes[3][i] / f->inverse[i];
        const float least = deep > 0 ? deep : 0;
        folds[i] = 1 + least * least;
    }
    for (int i = 0; i < N; i++)
        folds[i] = 1 / sqrtf(folds[i]);
}

/* Adds the light number l of the view. */
CS_INLINE void add_light(const struct cs_shading_context *shading, int l,
                         const struct cs_fragments *f, struct cs_shading_work *w) {
    const struct cs_shading_material *material = f->material;
    const struct cs_view_light *light = shading->view->lights + l;
    find_light(light->place, w);
    const struct cs_shadow_query query = cs_shading_query(w, w->share, f->n);
    cs_shadow_map_sample(shading->shadow_maps + l, &query);
    for (int i = f->n; i < N; i++)
        w->share[i] = 0;
    if (material->specular > 0)
        find_shine(material, w);
    for (int i = 0; i < N && !(material->specular > 0); i++)
        w->shine[i] = 0;
    for (int k = 0; k < 3; k++) {
        const float diffuse = light->diffuse[k], specular = light->specular[k];
        for (int i = 0; i < N; i++) {
            const float facing = w->facing[i] > 0 ? w->facing[i] : 0;
            w->colour[k][i] +=
                w->share[i] * (material->diffuse * facing * diffuse * w->base[k][i] +
                               material->specular * w->shine[i] * specular);
        }
    }
}

/* Bends light above the knee k towards 1 instead of cutting it off there: with o = (c - k) /
 * (1 - k), k + (1 - k) o / (1 + o), of slope 1 at the knee (after Reinhard et al. 2002). */
CS_INLINE void bend_highlights(struct cs_shading_work *w) {
    for (int k = 0; k < 3; k++) {
        for (int i = 0; i < N; i++) {
            const float over = w->colour[k][i] - CS_KNEE;
            w->shine[i] = over > 0 ? over : 0;
        }
        for (int i = 0; i < N; i++) {
            const float over = w->shine[i];
            w->colour[k][i] += over / (1 + over * (1 / (1 - CS_KNEE))) - over;
        }
    }
}

CS_INLINE void shade_lit(const struct cs_shading_context *shading, const struct cs_fragments *f,
                         struct cs_shading_work *w) {
    float folds[N];
    find_folds(f, folds);
    for (int k = 0; k < 3; k++) {
        const float ambient = shading->view->ambient[k];
        for (int i = 0; i < N; i++) {
            // ambient light is 1 on an upright surface seen straight on; more from above and
            // less towards the outline, or folds without direct light would be one flat patch
            const float across = w->normal[0][i] * w->view[0][i] +
                                 w->normal[1][i] * w->view[1][i] +
                                 w->normal[2][i] * w->view[2][i];
            const float around = 0.7f + 0.3f * across + 0.35f * w->normal[1][i];
            w->colour[k][i] = (around > 0 ? around : 0) * folds[i] * f->material->ambient *
                              ambient * w->base[k][i];
        }
    }
    for (int l = 0; l < (int)shading->view->size[3]; l++)
        add_light(shading, l, f, w);
    bend_highlights(w);
}

// |n.v|: 1 seen straight on, 0 at the outline
CS_INLINE void n_dot_view(struct cs_shading_work *w) {
    for (int i = 0; i < N; i++) {
        const float across = w->normal[0][i] * w->view[0][i] + w->normal[1][i] * w->view[1][i] +
                             w->normal[2][i] * w->view[2][i];
        w->share[i] = across < 0 ? -across : across;
    }
}

// colour of a value 0..1: linear between six stops, darker towards the outline to show the
// shape
static void shade_value(const struct cs_shading_context *shading, const struct cs_fragments *f,
                        struct cs_shading_work *w) {
    n_dot_view(w);
    for (int i = 0; i < N; i++) {
        float c[3];
        cs_ramp_colour(shading, f->attributes[3][i] / f->inverse[i], c);
        for (int k = 0; k < 3; k++)
            w->colour[k][i] = c[k] * (0.5f + 0.5f * w->share[i]);
    }
}

// components of the normal towards the eye, or texture coordinates, as colours
static void shade_coordinates(const struct cs_fragments *f, struct cs_shading_work *w) {
    for (int i = 0; i < f->n; i++)
        for (int k = 0; k < 3; k++) {
            const float at = k < 2 ? f->attributes[4 + k][i] / f->inverse[i] : 0.25f;
            const float c = f->material->mode == CS_SURFACE_UV ? at - floorf(at)
                                                               : 0.5f + 0.5f * w->normal[k][i];
            w->colour[k][i] = c * c; // so that bytes are about linear
        }
}

// a pale colour between the sky's and white, without light or shadow
CS_INLINE void shade_faint(const struct cs_shading_context *shading,
                           struct cs_shading_work *w) {
    n_dot_view(w);
    for (int k = 0; k < 3; k++) {
        const float pale = shading->view->sky[k] * 0.55f + 0.45f;
        for (int i = 0; i < N; i++)
            w->colour[k][i] = pale * (0.62f + 0.38f * w->share[i]);
    }
}

CS_CLONES static void shade(const struct cs_shading_context *shading, struct cs_fragments *f,
                            struct cs_shading_work *w) {
    // unused fragments up to N are shaded too, with harmless values, for whole vectors
    for (int i = f->n; i < N; i++) {
        f->x[i] = f->y[i] = 0;
        f->inverse[i] = 1;
        f->view_depth[i] = 1;
        for (int k = 0; k < CS_ATTRIBUTES; k++)
            f->attributes[k][i] = 1;
    }
    if (shading->rays.parallel)
        find_parallel_places(shading, f, w);
    else
        find_positions(shading, f, w);
    find_normals(f, w);
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < N; i++)
            w->base[k][i] = f->material->base[f->side][k];
    if (f->material->mode == CS_SURFACE_TEXTURED)
        paint_base(f, w);
    const struct cs_ground_style *ground = &f->material->ground;
    if (ground->radius > 0)
        cs_shade_pattern(shading, f, w);
    if (ground->radius > 0 && ground->shadow > 0)
        cs_shade_shadows(shading, f, w);
    else if (f->material->mode <= CS_SURFACE_TEXTURED)
        shade_lit(shading, f, w);
    else if (f->material->mode == CS_SURFACE_VALUE)
        shade_value(shading, f, w);
    else if (f->material->mode != CS_SURFACE_FAINT)
        shade_coordinates(f, w);
    else
        shade_faint(shading, w);
    if (ground->radius > 0)
        cs_shade_haze(shading, f, w);
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < N; i++)
            w->colour[k][i] = cs_clamp(w->colour[k][i], 0, 1);
}

void cs_shade(const struct cs_shading_context *shading, struct cs_fragments *f,
              uint32_t *colours) {
    struct cs_shading_work w;
    if (f->n == 0)
        return;
    shade(shading, f, &w);
    for (int i = 0; i < f->n; i++) {
        // of all surfaces, the ground alone may let light through
        const uint32_t clear =
            f->material->ground.radius > 0 ? 255 - (uint32_t)(w.cover[i] * 255 + 0.5f) : 0;
        colours[f->colour_index[i]] =
            cs_srgb_pack(shading->srgb, w.colour[0][i], w.colour[1][i], w.colour[2][i]) |
            clear << 24;
    }
    f->n = 0;
}
