/* Loads the OpenGL 3.3 calls by name, and turns OpenGL errors into messages. */
#include "draw/gl/gl.h"

#include "draw/gl/context.h"
#include "draw/view.h"

#include <stdio.h>
#include <string.h>

struct cs_gl_calls gl;

enum cs_status cs_gl_load(struct cs_error *error) {
#define X(upper, name) gl.name = (PFNGL##upper##PROC)cs_context_proc("gl" #name);
    CS_GL_CALLS(X)
#undef X

    // a loader gives an address for any name, so that only the version tells what is there
    GLint major = 0, minor = 0;
    if (gl.GetIntegerv && gl.GetString) {
        gl.GetIntegerv(GL_MAJOR_VERSION, &major);
        gl.GetIntegerv(GL_MINOR_VERSION, &minor);
    }
    if (major * 10 + minor < 33)
        return cs_fail(error, CS_ERR_MODULE,
                       "renderer osmesa: OpenGL %d.%d found, 3.3 expected", major, minor);
    return CS_OK;
}

enum cs_status cs_gl_check(const char *during, struct cs_error *error) {
    const GLenum code = gl.GetError();
    if (code == GL_NO_ERROR)
        return CS_OK;
    if (code == GL_OUT_OF_MEMORY)
        return cs_fail(error, CS_ERR_MEMORY, "renderer osmesa: out of memory while %s", during);
    return cs_fail(error, CS_ERR_MODULE, "renderer osmesa: OpenGL error 0x%04x while %s", code,
                   during);
}

/* Compiles and links shaders, and holds the GLSL that they share. */

#define GLSL(...) #__VA_ARGS__ "\n"
/* clang-format off */

static const char head[] = "#version 330 core\n";

// the fields are those of struct cs_view_block
static const char common[] = GLSL(
    struct Light {
        mat4 to_clip;
        vec4 place;
        vec4 diffuse;
        vec4 specular;
        vec4 shade;
    };
    layout(std140) uniform View {
        mat4 world_to_clip;
        vec4 eye;
        vec4 ambient;
        vec4 size;
        vec4 sky;
        vec4 above;
        vec4 below;
        vec4 stops[6];
        vec4 jitter;
        Light lights[4];
    };
    // for vertices: moves the picture by the jitter of the pass
    vec4 jittered(vec4 clip) {
        return clip + vec4(2.0 * jitter.xy / size.xy * clip.w, 0.0, 0.0);
    }
    vec3 encode(vec3 c) {
        vec3 curve = 1.055 * pow(max(c, 0.0031308), vec3(1.0 / 2.4)) - 0.055;
        return mix(curve, 12.92 * c, vec3(lessThan(c, vec3(0.0031308))));
    }
    vec3 map_colour(float value) {
        float at = clamp(value, 0.0, 1.0) * 5.0;
        int low = min(int(at), 4);
        return mix(stops[low].rgb, stops[low + 1].rgb, at - float(low));
    }
);

// for fragment shaders: dither, and the share of light k that comes through; facing: n . direction of the light,
// shade: size of a shadow texel in the light's picture, then in m, then 1 where there is a shadow
static const char shadow[] = GLSL(
    uniform sampler2DShadow depth0;
    uniform sampler2DShadow depth1;
    uniform sampler2DShadow depth2;
    uniform sampler2DShadow depth3;
    // a varying in the middle of the pixel of a picture without jitter: v / w and 1 / w are linear
    vec3 unmoved(vec3 v) {
        vec4 over = vec4(v, 1.0) * gl_FragCoord.w;
        over += jitter.x * dFdx(over) + jitter.y * dFdy(over);
        return over.xyz / max(over.w, 1e-6);
    }
    // what an ordered dither of 16 rows adds to a channel (srgb.h: cs_srgb_dither)
    float dither() {
        int y = int(size.y - gl_FragCoord.y);
        int v = 0;
        for (int k = 0; k < 4; k++)
            v = 2 * v + ((y >> k) & 1);
        return ((float(v) + 0.5) / 16.0 - 0.5) / 255.0;
    }
    float tap(int k, vec3 q) {
        if (k == 0)
            return texture(depth0, q);
        if (k == 1)
            return texture(depth1, q);
        return k == 2 ? texture(depth2, q) : texture(depth3, q);
    }
    float lit_share(int k, vec3 p, vec3 n, float facing) {
        vec4 shade = lights[k].shade;
        // off the surface by as much as a slope rises under the texels that are read
        float off = 1.9 + 5.0 * sqrt(max(1.0 - facing * facing, 0.0));
        vec4 at = lights[k].to_clip * vec4(p + off * shade.y * n, 1.0);
        vec3 q = at.xyz / at.w * 0.5 + 0.5;
        bool outside = any(lessThan(q, vec3(0.0))) || any(greaterThan(q.xy, vec2(1.0)));
        if (shade.z < 0.5 || at.w <= 0.0 || outside)
            return 1.0;
        // what lies farther away than all that casts shadow still catches it
        q.z = min(q.z, 1.0);
        float sum = 0.0;
        for (int i = -2; i <= 2; i++)
            for (int j = -2; j <= 2; j++)
                sum += float((3 - abs(i)) * (3 - abs(j))) *
                       tap(k, vec3(q.xy + shade.x * vec2(i, j), q.z));
        return sum / 81.0;
    }
);
/* clang-format on */

// a driver's log in one line, so that it fits into a message
static void flatten(char *log) {
    for (char *c = log; *c; c++)
        if (*c == '\n' || *c == '\r' || *c == '\t')
            *c = ' ';
    for (size_t n = strlen(log); n && log[n - 1] == ' '; n--)
        log[n - 1] = '\0';
}

static enum cs_status compile(GLuint program, GLenum stage, const char *name, const char *text,
                              struct cs_error *error) {
    const bool is_vertex = stage == GL_VERTEX_SHADER;
    /* only fragments look up the shadow */
    const char *parts[] = {head, common, is_vertex ? "" : shadow, text};
    char log[600] = "";
    GLint done = 0;
    const GLuint shader = gl.CreateShader(stage);
    gl.ShaderSource(shader, 4, parts, NULL);
    gl.CompileShader(shader);
    gl.GetShaderiv(shader, GL_COMPILE_STATUS, &done);
    if (done) {
        gl.AttachShader(program, shader);
    } else {
        gl.GetShaderInfoLog(shader, sizeof log, NULL, log);
        flatten(log);
        cs_fail(error, CS_ERR_MODULE, "%s shader of %s does not compile: %s",
                is_vertex ? "vertex" : "fragment", name, log);
    }
    /* an attached shader lives on until its program is deleted */
    gl.DeleteShader(shader);
    return error->status;
}

static void bind_inputs(GLuint program) {
    const GLuint block = gl.GetUniformBlockIndex(program, "View");
    if (block != GL_INVALID_INDEX)
        gl.UniformBlockBinding(program, block, CS_VIEW_BINDING);
    gl.UseProgram(program);
    gl.Uniform1i(gl.GetUniformLocation(program, "picture"), 0);
    for (int k = 0; k < CS_LIGHTS; k++) {
        char name[8];
        snprintf(name, sizeof name, "depth%d", k);
        gl.Uniform1i(gl.GetUniformLocation(program, name), 1 + k);
    }
}

enum cs_status cs_shader_make(const struct cs_shader_text *text, unsigned *program,
                              struct cs_error *error) {
    char log[600] = "";
    GLint done = 0;
    *program = gl.CreateProgram();
    if (compile(*program, GL_VERTEX_SHADER, text->name, text->vertex, error) != CS_OK ||
        compile(*program, GL_FRAGMENT_SHADER, text->name, text->fragment, error) != CS_OK)
        return error->status;
    gl.LinkProgram(*program);
    gl.GetProgramiv(*program, GL_LINK_STATUS, &done);
    if (!done) {
        gl.GetProgramInfoLog(*program, sizeof log, NULL, log);
        flatten(log);
        return cs_fail(error, CS_ERR_MODULE, "shaders of %s do not link: %s", text->name, log);
    }
    bind_inputs(*program);
    return CS_OK;
}
