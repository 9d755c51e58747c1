/* Pins the driver of Mesa and its CPU instructions through the environment. */
#include "draw/gl/driver.h"

#include <stdlib.h>

static const char *in_force;

const char *cs_driver_pin(bool fast) {
    if (in_force)
        return in_force;
    setenv("GALLIUM_DRIVER", "llvmpipe", 1); // an unknown driver here would crash OSMesa
    setenv("LIBGL_ALWAYS_SOFTWARE", "1", 1);
    // nothing is written into the user's home; where a folder is named, shaders are kept there
    if (!getenv("MESA_SHADER_CACHE_DIR"))
        setenv("MESA_SHADER_CACHE_DISABLE", "true", 1);
    unsetenv("MESA_GL_VERSION_OVERRIDE");
    unsetenv("MESA_GLSL_VERSION_OVERRIDE");
    unsetenv("LP_NATIVE_VECTOR_WIDTH");
    // without AVX2 there is no fused multiply-add, which alone makes pixels differ between CPUs
    if (fast)
        unsetenv("GALLIUM_OVERRIDE_CPU_CAPS");
    else
        setenv("GALLIUM_OVERRIDE_CPU_CAPS", "sse4.1", 1);
    in_force = fast ? "caps=native" : "caps=sse4.1";
    return in_force;
}
