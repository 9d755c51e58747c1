/* GLSL of cloth and colliders: Blinn-Phong per fragment (cloth thesis,
 * eq. 4.15) with a soft shadow, the looks that colour by a value, and the depth pass of the
 * shadow. */
#include "draw/gl/gl.h"

#define OVERLAY_GLSL(...) #__VA_ARGS__ "\n"

/* clang-format off */

// one triangle that covers the picture
static const char sky_vertex[] = OVERLAY_GLSL(
    out float up;
    void main() {
        vec2 p = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);
        up = 0.5 + 0.5 * p.y;
        gl_Position = vec4(p, 0.0, 1.0);
    }
);

static const char sky_fragment[] = OVERLAY_GLSL(
    in float up;
    out vec4 colour;
    void main() {
        vec4 c = clamp(mix(below, above, up), 0.0, 1.0);
        colour = vec4(encode(c.rgb) + dither(), c.a);
    }
);

// with the vertices of the sky
static const char sample_fragment[] = OVERLAY_GLSL(
    uniform sampler2DMS picture;
    uniform int number;
    out vec4 colour;
    void main() {
        colour = texelFetch(picture, ivec2(gl_FragCoord.xy), number);
    }
);

/* Each instance is a line with round ends, drawn as a rectangle about it. `lift` brings its
 * depth nearer to the eye, so that it shows on its surface. flat_: ends are pixels from top
 * left */
static const char line_vertex[] = OVERLAY_GLSL(
    layout(location = 0) in vec3 in_a;
    layout(location = 1) in vec3 in_b;
    uniform float half_width;
    uniform float lift;
    uniform int flat_;
    flat out vec4 ends;
    vec4 project(vec3 p) {
        if (flat_ == 1)
            return vec4(2.0 * p.x / size.x - 1.0, 1.0 - 2.0 * p.y / size.y, 0.0, 1.0);
        return world_to_clip * vec4(p, 1.0);
    }
    float lifted(vec3 p, vec4 clip) {
        vec4 near = project(p + lift * normalize(eye.xyz - eye.w * p));
        return near.w > 0.0 ? near.z / near.w * clip.w : clip.z;
    }
    void main() {
        vec4 a = project(in_a);
        vec4 b = project(in_b);
        float near = size.z;
        vec3 pa = in_a;
        vec3 pb = in_b;
        ends = vec4(0.0);
        gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
        // an end behind the near plane is moved onto it: dividing by its w would flip the line
        if (a.w < near && b.w < near)
            return;
        if (a.w < near)
            pa = mix(in_a, in_b, (near - a.w) / (b.w - a.w));
        if (b.w < near)
            pb = mix(in_b, in_a, (near - b.w) / (a.w - b.w));
        a = project(pa);
        b = project(pb);
        ends = vec4((a.xy / a.w * 0.5 + 0.5) * size.xy, (b.xy / b.w * 0.5 + 0.5) * size.xy);
        vec2 along = ends.zw - ends.xy;
        float n = length(along);
        along = n > 1e-6 ? along / n : vec2(1.0, 0.0);
        bool first = gl_VertexID < 2;
        float side = gl_VertexID % 2 == 0 ? 1.0 : -1.0;
        // half a pixel more on all sides for the smooth edge, and the farthest sample of it
        float reach = half_width + 1.5;
        vec2 pixel = first ? ends.xy - reach * along : ends.zw + reach * along;
        pixel += side * reach * vec2(-along.y, along.x);
        vec4 end = first ? a : b;
        if (flat_ == 0)
            end.z = lifted(first ? pa : pb, end);
        gl_Position = jittered(vec4((pixel / size.xy * 2.0 - 1.0) * end.w, end.z, end.w));
    }
);

static const char line_fragment[] = OVERLAY_GLSL(
    flat in vec4 ends;
    uniform float half_width;
    uniform vec4 paint;
    out vec4 colour;
    void main() {
        vec2 along = ends.zw - ends.xy;
        vec2 from = gl_FragCoord.xy - ends.xy;
        float at = clamp(dot(from, along) / max(dot(along, along), 1e-6), 0.0, 1.0);
        // below half a pixel a line gets paler instead of thinner
        float wide = max(half_width, 0.5);
        float cover = clamp(wide + 0.5 - length(from - at * along), 0.0, 1.0);
        colour = vec4(encode(paint.rgb), paint.a * cover * half_width / wide);
    }
);

// box: left, top, width, height in pixels from top left
static const char bar_vertex[] = OVERLAY_GLSL(
    uniform vec4 box;
    out float value;
    void main() {
        vec2 corner = vec2(gl_VertexID % 2, gl_VertexID / 2);
        vec2 pixel = box.xy + box.zw * corner;
        value = 1.0 - corner.y;
        vec2 at = 2.0 * pixel / size.xy - 1.0;
        gl_Position = jittered(vec4(at.x, -at.y, 0.0, 1.0));
    }
);

static const char bar_fragment[] = OVERLAY_GLSL(
    in float value;
    out vec4 colour;
    void main() {
        colour = vec4(encode(map_colour(value)), 1.0);
    }
);

/* clang-format on */

const struct cs_shader_text cs_shader_sample = {"samples", sky_vertex, sample_fragment};

const struct cs_shader_text cs_shader_sky = {"sky", sky_vertex, sky_fragment};

const struct cs_shader_text cs_shader_line = {"line", line_vertex, line_fragment};

const struct cs_shader_text cs_shader_bar = {"bar", bar_vertex, bar_fragment};

#define GLSL(...) #__VA_ARGS__ "\n"

/* clang-format off */

/* `sink` moves only the depth away from the eye: between its particles a cloth is a chord that
 * cuts into the ball it lies on, and would show specks of it */
static const char surface_vertex[] = GLSL(
    layout(location = 0) in vec3 in_place;
    layout(location = 1) in vec3 in_normal;
    layout(location = 2) in vec2 in_uv;
    layout(location = 3) in float in_value;
    uniform float sink;
    out vec3 moved_place;
    out vec3 moved_normal;
    out vec3 moved_other;
    void main() {
        moved_place = in_place;
        moved_normal = in_normal;
        moved_other = vec3(in_uv, in_value);
        gl_Position = world_to_clip * vec4(in_place, 1.0);
        vec4 behind = world_to_clip * vec4(in_place + sink * normalize(eye.w * in_place - eye.xyz), 1.0);
        if (sink > 0.0 && gl_Position.w > 0.0 && behind.w > 0.0)
            gl_Position.z = behind.z / behind.w * gl_Position.w;
        gl_Position = jittered(gl_Position);
    }
);

// mode: 0 plain, 1 textured, 2 by value, 3 faint, 4 normals, 5 texture coordinates
static const char surface_fragment[] = GLSL(
    in vec3 moved_place;
    in vec3 moved_normal;
    in vec3 moved_other;
    vec3 place;
    vec3 normal;
    vec2 uv;
    float value;
    uniform int mode;
    uniform vec3 front;
    uniform vec3 back;
    uniform vec4 coefficients;
    uniform sampler2D picture;
    // of the ground, as struct cs_ground_style: centre, radius and tile; ink and shadow
    uniform vec4 span;
    uniform vec4 ink;
    uniform int has_lines;
    out vec4 colour;

    vec2 wave_integral(vec2 u) {
        return 1.0 - abs(2.0 * fract(0.5 * u) - 1.0);
    }
    float lines(vec2 wide, float step, float half_width) {
        vec2 at = place.xz / step;
        vec2 pixel = max(wide / step, 1e-6);
        vec2 off = abs(at - floor(at + 0.5)) / pixel;
        vec2 cover = clamp(half_width + 0.5 - off, 0.0, 1.0);
        // where lines come close they melt into a tint instead of a moire pattern
        cover *= clamp(0.5 / pixel - 0.6, 0.0, 1.0);
        return max(cover.x, cover.y);
    }
    float pattern() {
        vec2 wide = fwidth(place.xz);
        float tile = span.w;
        if (has_lines == 1)
            return 0.55 * max(0.5 * lines(wide, tile, 0.45), lines(wide, 10.0 * tile, 0.7));
        vec2 width = max(wide / tile, 0.01);
        vec2 u = place.xz / tile;
        vec2 mean = (wave_integral(u + 0.5 * width) - wave_integral(u - 0.5 * width)) / width;
        return mean.x * mean.y;
    }
    // a ground of shadows and lines alone: its opacity
    float shadow_cover() {
        float lit = 0.0;
        for (int k = 0; k < int(size.w); k++)
            lit += lights[k].shade.w * lit_share(k, place, vec3(0.0, 1.0, 0.0), 1.0);
        float dark = ink.w * (1.0 - lit);
        return dark + (1.0 - dark) * (span.w > 0.0 ? pattern() : 0.0);
    }
    // bends light above the knee towards 1
    vec3 bend(vec3 c) {
        vec3 over = max(c - 0.6, 0.0);
        return c - over + over / (1.0 + over / 0.4);
    }
    // mean over parts of the longer side of the pixel's footprint, at most 8 (mipmap.h)
    vec3 textured() {
        vec2 wide = vec2(textureSize(picture, 0));
        // of the lower row and the left column of the pixel's block of 2 x 2, for all of it
        vec2 odd = mod(floor(gl_FragCoord.xy), 2.0);
        vec2 steps[2] = vec2[2](dFdx(uv - odd.y * dFdy(uv)), dFdy(uv - odd.x * dFdx(uv)));
        vec2 squares = vec2(dot(wide * steps[0], wide * steps[0]),
                            dot(wide * steps[1], wide * steps[1]));
        vec2 side = squares.x > squares.y ? steps[0] : steps[1];
        float square = max(squares.x, squares.y);
        float least = max(min(squares.x, squares.y), 1.0);
        float parts = clamp(ceil(sqrt(square / least)), 1.0, 8.0);
        float part = parts > 1.0 ? sqrt(max(1.0 / (parts * parts), least / square)) : 1.0;
        vec3 sum = vec3(0.0);
        for (float i = 0.5; i < parts; i += 1.0)
            sum += textureGrad(picture, uv + (i / parts - 0.5) * side, part * side, vec2(0.0)).rgb;
        return sum / parts;
    }
    vec3 blinn_phong(vec3 base, vec3 n, vec3 v) {
        // ambient light is 1 on an upright surface seen straight on; more from above and less
        // towards the outline, or folds without direct light would be one flat patch
        float around = 0.7 + 0.3 * dot(n, v) + 0.35 * n.y;
        // and less in folds, whose values those of vertices are here
        float deep = max(gl_FrontFacing ? value : -value, 0.0);
        around *= inversesqrt(1.0 + deep * deep);
        vec3 c = max(around, 0.0) * coefficients.x * ambient.rgb * base;
        for (int k = 0; k < int(size.w); k++) {
            vec3 l = normalize(lights[k].place.xyz - lights[k].place.w * place);
            float facing = dot(n, l);
            if (facing > 0.0) {
                float share = lit_share(k, place, n, facing);
                float shine = pow(max(dot(n, normalize(l + v)), 0.0), coefficients.w);
                c += share * (coefficients.y * facing * lights[k].diffuse.rgb * base +
                              coefficients.z * shine * lights[k].specular.rgb);
            }
        }
        return c;
    }

    void main() {
        place = unmoved(moved_place);
        normal = unmoved(moved_normal);
        vec3 other = unmoved(moved_other);
        uv = other.xy;
        value = other.z;
        vec3 n = normalize(gl_FrontFacing ? normal : -normal);
        vec3 v = normalize(eye.xyz - eye.w * place);
        vec3 base = gl_FrontFacing ? front : back;
        float towards = abs(dot(n, v));
        if (mode == 1)
            base *= textured();
        if (span.z > 0.0 && ink.w <= 0.0 && span.w > 0.0)
            base += pattern() * (has_lines == 1 ? ink.rgb - base : 0.06 * base);
        vec3 c;
        float whole = 1.0;
        if (span.z > 0.0 && ink.w > 0.0)
            c = ink.rgb;
        else if (mode < 2)
            c = bend(blinn_phong(base, n, v));
        else if (mode == 2)
            c = map_colour(value) * (0.5 + 0.5 * towards);
        else if (mode == 3)
            c = mix(sky.rgb, vec3(1.0), 0.45) * (0.62 + 0.38 * towards);
        else
            c = mode == 4 ? 0.5 + 0.5 * n : vec3(fract(uv), 0.25);
        if (mode > 3)
            c *= c;
        if (span.z > 0.0) {
            // haze: the ground fades into the background, or into nothing without one
            vec2 d = (place.xz - span.xy) / span.z;
            float left = clamp(1.0 - dot(d, d), 0.0, 1.0);
            left *= left * (ink.w > 0.0 ? shadow_cover() : 1.0);
            if (above.w > 0.0)
                c = mix(clamp(mix(below, above, gl_FragCoord.y / size.y), 0.0, 1.0).rgb, c, left);
            else
                whole = left;
        }
        vec3 byte = encode(clamp(c, 0.0, 1.0)) + (span.z > 0.0 ? dither() : 0.0);
        colour = vec4(byte * whole, whole);
    }
);

static const char shadow_vertex[] = GLSL(
    layout(location = 0) in vec3 in_place;
    uniform int number;
    void main() {
        gl_Position = lights[number].to_clip * vec4(in_place, 1.0);
    }
);

static const char shadow_fragment[] = GLSL(
    void main() {
    }
);

/* clang-format on */

const struct cs_shader_text cs_shader_surface = {"surface", surface_vertex, surface_fragment};

const struct cs_shader_text cs_shader_shadow = {"shadow", shadow_vertex, shadow_fragment};
