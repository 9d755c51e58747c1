/* scene_view.h - the struct of a scene, for studies and commands that look into it. It stands
 * apart from session.h, so that a new key of the root compiles only these. */
#ifndef CS_SCENE_VIEW_H
#define CS_SCENE_VIEW_H

#include "scene/scene.h"

#endif
