/* The rows of `colliders`, but for those of each shape, which are in shape_NAME.c. */
#include "scene/collider_keys.h"
#include "scene/table_rows.h"

static const double grey[3] = {0.32, 0.36, 0.42};
static const struct cs_option collider_rows[] = {
#define X(name, keys, text) TABLE(struct cs_collider, name, cs_##name##_keys, text),
    CS_SHAPE_LIST(X)
#undef X
        REAL(struct cs_collider, friction, "", 0, 0, 1000, "Coulomb coefficient"),
    REAL(struct cs_collider, absorption, "", 1, -1, 1,
         "fraction of the inward normal velocity that is removed; -e: reversed and multiplied "
         "by e (restitution)"),
    REAL(struct cs_collider, thickness, "m", 0, 0, BIG,
         "offset from the surface; for contact by force its range, 0: 0.4 of the shortest "
         "spring, less where a particle starts closer, or for a mesh collider the thickness of "
         "the body"),
    VECTOR(struct cs_collider, colour, 3, "", grey, 0, 1, "linear RGB"),
    BOOL(struct cs_collider, visible, 1, "draw it"),
};
const struct cs_table cs_collider_table = {ROWS(collider_rows),
                                           .size = sizeof(struct cs_collider), .one_of = true};
