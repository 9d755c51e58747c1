/* gl.h - the OpenGL 3.3 calls that drawing needs, loaded by name from whatever context there
 * is. */
#ifndef CS_DRAW_GL_H
#define CS_DRAW_GL_H

#include "base/status.h"

#include <GL/glcorearb.h>

/* clang-format off */
#define CS_GL_CALLS(X)                                                                             \
    X(ACTIVETEXTURE, ActiveTexture) X(ATTACHSHADER, AttachShader) X(BINDBUFFER, BindBuffer)        \
    X(BINDBUFFERBASE, BindBufferBase) X(BINDFRAMEBUFFER, BindFramebuffer)                          \
    X(BINDRENDERBUFFER, BindRenderbuffer) X(BINDTEXTURE, BindTexture)                              \
    X(BINDVERTEXARRAY, BindVertexArray) X(BLENDFUNCSEPARATE, BlendFuncSeparate)                                 \
    X(BUFFERDATA, BufferData)                                                                     \
    X(CHECKFRAMEBUFFERSTATUS, CheckFramebufferStatus) X(CLEAR, Clear)                              \
    X(COMPILESHADER, CompileShader) X(CREATEPROGRAM, CreateProgram) X(CREATESHADER, CreateShader)  \
    X(DELETESHADER, DeleteShader) X(DEPTHFUNC, DepthFunc) X(DEPTHMASK, DepthMask)                  \
    X(DISABLE, Disable) X(DRAWARRAYS, DrawArrays) X(DRAWARRAYSINSTANCED, DrawArraysInstanced)      \
    X(DRAWBUFFER, DrawBuffer) X(DRAWELEMENTS, DrawElements) X(ENABLE, Enable)                      \
    X(ENABLEVERTEXATTRIBARRAY, EnableVertexAttribArray)                                            \
    X(FRAMEBUFFERRENDERBUFFER, FramebufferRenderbuffer)                                            \
    X(FRAMEBUFFERTEXTURE2D, FramebufferTexture2D) X(GENBUFFERS, GenBuffers)                        \
    X(GENFRAMEBUFFERS, GenFramebuffers)                          \
    X(GENRENDERBUFFERS, GenRenderbuffers) X(GENTEXTURES, GenTextures)                              \
    X(GENVERTEXARRAYS, GenVertexArrays) X(GETERROR, GetError) X(GETINTEGERV, GetIntegerv)          \
    X(GETPROGRAMINFOLOG, GetProgramInfoLog) X(GETPROGRAMIV, GetProgramiv)                          \
    X(GETSHADERINFOLOG, GetShaderInfoLog) X(GETSHADERIV, GetShaderiv) X(GETSTRING, GetString)      \
    X(GETUNIFORMBLOCKINDEX, GetUniformBlockIndex) X(GETUNIFORMLOCATION, GetUniformLocation)        \
    X(LINKPROGRAM, LinkProgram) X(PIXELSTOREI, PixelStorei) X(READBUFFER, ReadBuffer)              \
    X(READPIXELS, ReadPixels) X(RENDERBUFFERSTORAGEMULTISAMPLE, RenderbufferStorageMultisample)    \
    X(SHADERSOURCE, ShaderSource) X(TEXIMAGE2D, TexImage2D)                                        \
    X(TEXIMAGE2DMULTISAMPLE, TexImage2DMultisample) X(TEXPARAMETERI, TexParameteri)                \
    X(UNIFORM1F, Uniform1f) X(UNIFORM1I, Uniform1i) X(UNIFORM3F, Uniform3f)                        \
    X(UNIFORM4F, Uniform4f) X(UNIFORMBLOCKBINDING, UniformBlockBinding)                            \
    X(USEPROGRAM, UseProgram) X(VERTEXATTRIBDIVISOR, VertexAttribDivisor)                          \
    X(VERTEXATTRIBPOINTER, VertexAttribPointer) X(VIEWPORT, Viewport)
/* clang-format on */

struct cs_gl_calls {
#define X(upper, name) PFNGL##upper##PROC name;
    CS_GL_CALLS(X)
#undef X
};
extern struct cs_gl_calls gl;

/* Loads all calls from the current context. CS_ERR_MODULE if it offers less than OpenGL 3.3. */
enum cs_status cs_gl_load(struct cs_error *error);

/* CS_ERR_MODULE if a call has failed since the last check; `during` names the task. */
enum cs_status cs_gl_check(const char *during, struct cs_error *error);

#endif
