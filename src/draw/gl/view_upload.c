/* Uploads the view block as the uniform buffer that all shaders read. */
#include "draw/gl/gl.h"
#include "draw/view.h"

void cs_view_upload(struct cs_view_state *view) {
    if (!view->buffer)
        gl.GenBuffers(1, &view->buffer);
    gl.BindBuffer(GL_UNIFORM_BUFFER, view->buffer);
    gl.BufferData(GL_UNIFORM_BUFFER, sizeof view->block, &view->block, GL_DYNAMIC_DRAW);
    gl.BindBufferBase(GL_UNIFORM_BUFFER, CS_VIEW_BINDING, view->buffer);
}
