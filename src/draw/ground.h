/* ground.h - the ground below a scene: its floor, or a plane of the pictures alone. */
#ifndef CS_DRAW_GROUND_H
#define CS_DRAW_GROUND_H

#include "draw/look.h"
#include "draw/view.h"
#include "model/contact/posed_collider.h"
#include "model/system/particle_system.h"
#include "scene/collider_keys.h"

/* The ground of a scene, which must not move in memory once it is made. */
struct cs_ground {
    bool present;                    /* it is drawn as one more collider, `pose` */
    bool follows_lowest;             /* it moves below anything lower */
    double height;                   /* m, without anything lower */
    struct cs_ground_style style;    /* of this ground and of floors */
    const struct cs_collider *floor; /* the one that serves as ground; NULL: none */
    float shadow;                    /* 0..1: opacity if it shows shadows alone; 0: it is lit */
    struct cs_collider collider;
    struct cs_posed_collider pose; /* of this frame */
};

/* Makes the ground that the scene wants; tiles have a power of ten of 1 m that fits its extent.
 * colliders (scene->colliders.n) at the start. */
void cs_ground_make(struct cs_ground *ground, const struct cs_system *system,
                    const struct cs_posed_collider *colliders,
                    const struct cs_bounding_sphere *sphere);

/* Places the ground below everything in a frame. */
void cs_ground_aim(struct cs_ground *ground, const struct cs_bounding_sphere *sphere);

/* Makes the style of a floor or of the ground itself that of ground; leaves others. */
void cs_ground_style_of(const struct cs_ground *ground,
                        const struct cs_posed_collider *collider,
                        struct cs_surface_style *style);

/* Returns true for the ground, and for the floors and planes that are drawn to the horizon:
 * level ones, and the first with a normal that points up. */
bool cs_ground_is(const struct cs_ground *ground, const struct cs_posed_collider *collider);

#endif
