/* picture_keys.h - the keys of pictures: camera, light, look, background, ground. */
#ifndef CS_PICTURE_KEYS_H
#define CS_PICTURE_KEYS_H

#include <clothsim/option.h>

enum cs_frame_kind { CS_FRAME_GIVEN, CS_FRAME_AUTO, CS_FRAME_START };
enum cs_projection { CS_PROJECTION_PERSPECTIVE, CS_PROJECTION_ORTHOGRAPHIC };
struct cs_camera_key {
    double at;                /* s; NAN: not given, refused */
    double eye[3], target[3]; /* m */
};
struct cs_camera {
    int32_t frame;                   /* enum cs_frame_kind */
    double eye[3], target[3], up[3]; /* m */
    double fov;                      /* degrees, vertical; orthographic: as wide at target */
    int32_t projection;              /* enum cs_projection */
    struct cs_list path;             /* struct cs_camera_key: instead of eye and target */
    int32_t motion;                  /* enum cs_motion, from key to key */
};

/* one of point and direction */
enum { CS_LIGHTS = 4 }; /* most of a scene: light and lights */
struct cs_light {
    double point[3];     /* m; first component NAN: absent */
    double direction[3]; /* from which the light travels; first component NAN: absent */
    double ambient[3], diffuse[3], specular[3]; /* intensities, linear RGB */
    double strength;                            /* factor of diffuse and specular */
    bool shadow;                                /* it casts shadows */
};

/* X(NAME, name): the looks; what each shows is in draw/look.c. */
#define CS_LOOK_LIST(X)                                                                        \
    X(LIT, lit)                                                                                \
    X(WIREFRAME, wireframe)                                                                    \
    X(SPRINGS, springs)                                                                        \
    X(FORCE, force)                                                                            \
    X(STRAIN, strain)                                                                          \
    X(GOALS, goals) X(CROSSINGS, crossings) X(STRESS, stress) X(NORMALS, normals) X(UV, uv)

enum cs_look {
#define X(NAME, name) CS_LOOK_##NAME,
    CS_LOOK_LIST(X)
#undef X
};
enum cs_background_kind { CS_BACKGROUND_GRADIENT, CS_BACKGROUND_FLAT, CS_BACKGROUND_NONE };
/* Drawn behind everything; colours are linear RGB. */
struct cs_background {
    int32_t kind; /* enum cs_background_kind */
    double colour[3];
    double below[3]; /* at the lower edge of a gradient; first component NAN: a darker colour */
};

/* particles that pictures mark */
struct cs_marks {
    int64_t body;
    struct cs_list particles; /* struct cs_pin; empty: none */
};

enum cs_palette { CS_PALETTE_AUTO, CS_PALETTE_GREEN_RED };
enum cs_ground_kind { CS_GROUND_AUTO, CS_GROUND_NONE, CS_GROUND_SHADOW, CS_GROUND_GRID };

struct cs_render {
    int64_t size[2]; /* pixels: width, height */
    int64_t samples; /* of each pixel: 1, 4 or 8 */
    int32_t look;    /* enum cs_look */
    double range[2]; /* of the colours of looks force [N], strain and stress [N/m]; NAN: from
                        the frame */
    struct cs_background background;
    int32_t palette;       /* enum cs_palette: colours of the looks force, strain and stress */
    bool pins;             /* show what is held */
    bool viewpoint_forces; /* show what viewpoint forces see, and from where */
    int32_t ground;        /* enum cs_ground_kind: what is drawn on a plane y = ground_height */
    double ground_height;  /* m; NAN: below all that moves */
    struct cs_marks marks;
};

/* The keys of camera, lights and looks. */
extern const struct cs_table cs_camera_table, cs_light_table, cs_lights_table, cs_render_table;
extern const char *const cs_look_names[];

#endif
