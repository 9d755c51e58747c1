/* Makes the seen side of a sphere: rings about the line of sight, the last on its outline. */
#include "draw/sphere_cap.h"

#include "draw/matrix.h"

enum { STEP = CS_SPHERE_CAP_OUTLINE / CS_SPHERE_CAP_SECTORS };

struct turn {
    double cosine, sine;
};

struct ball {
    const double *centre;
    double radius, across[3], third[3], along[3]; // unit vectors, the last towards the eye
    struct turn rings[CS_SPHERE_CAP_STACKS + 1];  // from the middle to the outline
    struct turn spokes[CS_SPHERE_CAP_OUTLINE];
    struct cs_vertex *out; // the next vertex
};

// of an angle of 0..pi
static struct turn halved(struct turn t) {
    return (struct turn){sqrt((1 + t.cosine) / 2), sqrt((1 - t.cosine) / 2)};
}

static struct turn sum(struct turn a, struct turn b) {
    return (struct turn){a.cosine * b.cosine - a.sine * b.sine,
                         a.sine * b.cosine + a.cosine * b.sine};
}

// all multiples of an angle, from 0 on
static void fill_turns(struct turn step, int n, struct turn *turns) {
    turns[0] = (struct turn){1, 0};
    for (int k = 1; k < n; k++)
        turns[k] = sum(turns[k - 1], step);
}

static void aim(struct ball *ball, const float eye[4]) {
    const double far = (double)eye[3];
    for (int i = 0; i < 3; i++)
        ball->along[i] = (double)eye[i] - far * ball->centre[i];
    const double distance = cs_length(ball->along);
    cs_normalise(ball->along);
    cs_frame_from_direction(ball->along, ball->across, ball->third);
    // the outline is where sight touches the sphere
    const double least = far > 0 ? ball->radius : 0;
    const double cosine = distance > least ? least / distance : -1;
    struct turn ring = {cosine, 0}, spoke = {0, 1};
    for (int n = CS_SPHERE_CAP_STACKS; n > 1; n /= 2)
        ring = halved(ring);
    for (int n = CS_SPHERE_CAP_OUTLINE; n > 4; n /= 2)
        spoke = halved(spoke);
    fill_turns(ring, CS_SPHERE_CAP_STACKS + 1, ball->rings);
    fill_turns(spoke, CS_SPHERE_CAP_OUTLINE, ball->spokes);
}

static void add_vertex(struct ball *ball, int ring, int spoke) {
    const struct turn out = ball->rings[ring],
                      around = ball->spokes[spoke % CS_SPHERE_CAP_OUTLINE];
    struct cs_vertex *vertex = ball->out++;
    for (int i = 0; i < 3; i++) {
        const double side = around.cosine * ball->across[i] + around.sine * ball->third[i];
        const double d = out.cosine * ball->along[i] + out.sine * side;
        vertex->position[i] = (float)(ball->centre[i] + ball->radius * d);
        vertex->normal[i] = (float)d;
    }
    vertex->value = 0;
}

// between two spokes and two rings; the outer side in so many parts
static void add_cell(struct ball *ball, int ring, int spoke, int parts) {
    for (int k = 0; k < parts; k++) {
        add_vertex(ball, ring, spoke);
        add_vertex(ball, ring + 1, spoke + k * (STEP / parts));
        add_vertex(ball, ring + 1, spoke + (k + 1) * (STEP / parts));
    }
    // in the middle the inner side is a point
    if (ring == 0)
        return;
    add_vertex(ball, ring, spoke);
    add_vertex(ball, ring + 1, spoke + STEP);
    add_vertex(ball, ring, spoke + STEP);
}

void cs_sphere_cap_fill(const double centre[3], double radius, const float eye[4],
                        struct cs_vertex *out) {
    struct ball ball = {.centre = centre, .radius = radius, .out = out};
    aim(&ball, eye);
    for (int ring = 0; ring < CS_SPHERE_CAP_STACKS; ring++)
        for (int spoke = 0; spoke < CS_SPHERE_CAP_OUTLINE; spoke += STEP)
            add_cell(&ball, ring, spoke, ring + 1 < CS_SPHERE_CAP_STACKS ? 1 : STEP);
}
