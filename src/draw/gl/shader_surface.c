/* GLSL of cloth and colliders: Blinn-Phong per fragment (cloth thesis,
 * eq. 4.15) with a soft shadow, the looks that colour by a value, and the depth pass of the
 * shadow. */
#include "draw/gl/shader.h"

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
    out vec3 place;
    out vec3 normal;
    out vec2 uv;
    out float value;
    void main() {
        place = in_place;
        normal = in_normal;
        uv = in_uv;
        value = in_value;
        gl_Position = world_to_clip * vec4(place, 1.0);
        vec4 behind = world_to_clip * vec4(place + sink * normalize(eye.w * place - eye.xyz), 1.0);
        if (sink > 0.0 && gl_Position.w > 0.0 && behind.w > 0.0)
            gl_Position.z = behind.z / behind.w * gl_Position.w;
    }
);

// mode: 0 plain, 1 textured, 2 by value, 3 faint
static const char surface_fragment[] = GLSL(
    in vec3 place;
    in vec3 normal;
    in vec2 uv;
    in float value;
    uniform int mode;
    uniform vec3 front;
    uniform vec3 back;
    uniform vec4 coefficients;
    uniform sampler2D picture;
    uniform float fade;
    out vec4 colour;

    vec3 blinn_phong(vec3 base, vec3 n, vec3 v) {
        // ambient light is 1 on an upright surface seen straight on; more from above and less
        // towards the outline, or folds without direct light would be one flat patch
        float around = 0.7 + 0.3 * dot(n, v) + 0.35 * n.y;
        // and less in folds, whose values those of vertices are here
        float deep = max(gl_FrontFacing ? value : -value, 0.0);
        around *= inversesqrt(1.0 + deep * deep);
        vec3 c = max(around, 0.0) * coefficients.x * light_ambient.rgb * base;
        vec3 l = normalize(light.xyz - light.w * place);
        float facing = dot(n, l);
        if (facing > 0.0) {
            float share = lit_share(place, n, facing);
            float shine = pow(max(dot(n, normalize(l + v)), 0.0), coefficients.w);
            c += share * (coefficients.y * facing * light_diffuse.rgb * base +
                          coefficients.z * shine * light_specular.rgb);
        }
        return c;
    }

    void main() {
        vec3 n = normalize(gl_FrontFacing ? normal : -normal);
        vec3 v = normalize(eye.xyz - eye.w * place);
        vec3 base = gl_FrontFacing ? front : back;
        float towards = abs(dot(n, v));
        if (mode == 1)
            base *= texture(picture, uv).rgb;
        vec3 c;
        if (mode < 2)
            c = blinn_phong(base, n, v);
        else if (mode == 2)
            c = map_colour(value) * (0.5 + 0.5 * towards);
        else
            c = mix(sky.rgb, vec3(1.0), 0.45) * (0.62 + 0.38 * towards);
        // a floor has no end: its square melts into the background
        float whole = fade > 0.0 ? 1.0 - smoothstep(0.35, 1.0, length(place.xz) / fade) : 1.0;
        colour = vec4(encode(clamp(c, 0.0, 1.0)), whole);
    }
);

static const char shadow_vertex[] = GLSL(
    layout(location = 0) in vec3 in_place;
    void main() {
        gl_Position = world_to_light * vec4(in_place, 1.0);
    }
);

static const char shadow_fragment[] = GLSL(
    void main() {
    }
);
/* clang-format on */

const struct cs_shader_text cs_shader_surface = {"surface", surface_vertex, surface_fragment};
const struct cs_shader_text cs_shader_shadow = {"shadow", shadow_vertex, shadow_fragment};
