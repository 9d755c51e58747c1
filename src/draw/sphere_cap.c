/* sphere_cap.c - makes the visible side of a sphere: rings about the line of sight, the last on
 * the outline.
 *
 * From distance D the lines of sight touch a sphere of radius r at the angle a from the axis,
 * with cos a = r / D; from far away cos a = 0. Rings are at a k / 16. All angles come from
 * halving,
 *   cos(t / 2) = sqrt((1 + cos t) / 2),   sin(t / 2) = sqrt((1 - cos t) / 2),
 * and from the addition theorems, so the vertices have the same bits on every machine. A round
 * outline matters more than a round inside: the outline has four times the corners. */
#include "draw/sphere_cap.h"

#include "draw/matrix.h"

enum { STEP = CS_SPHERE_CAP_OUTLINE / CS_SPHERE_CAP_SECTORS }; // outline corners per sector

// cosine and sine of an angle
struct turn {
    double cosine, sine;
};

// a sphere and the directions that its vertices are made from
struct ball {
    const double *centre;
    double radius, across[3], third[3], along[3]; // unit vectors, the last towards the eye
    struct turn rings[CS_SPHERE_CAP_STACKS + 1];  // from the middle to the outline
    struct turn spokes[CS_SPHERE_CAP_OUTLINE];
    struct cs_vertex *out; // the next vertex
};

// half of an angle of 0..pi
static struct turn halved(struct turn t) {
    return (struct turn){sqrt((1 + t.cosine) / 2), sqrt((1 - t.cosine) / 2)};
}

// the sum of two angles
static struct turn sum(struct turn a, struct turn b) {
    return (struct turn){a.cosine * b.cosine - a.sine * b.sine,
                         a.sine * b.cosine + a.cosine * b.sine};
}

// the first n multiples of an angle, from 0 on
static void fill_turns(struct turn step, int n, struct turn *turns) {
    turns[0] = (struct turn){1, 0};
    for (int k = 1; k < n; k++)
        turns[k] = sum(turns[k - 1], step);
}

// sets the axis to the eye, and the angles of rings and spokes
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

// the vertex on a ring and a spoke
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

// triangles between two spokes and two rings, the outer side divided into `parts`
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
