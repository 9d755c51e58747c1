/* The rows that name particles, for bodies' pins and for events. */
#include "scene/scene.h"
#include "scene/table_rows.h"

const char *const cs_pin_names[] = {"top-left", "top-right", "bottom-left", "bottom-right",
                                    "top",      "bottom",    "left",        "right",
                                    "edges",    NULL};
static const struct cs_option box_rows[] = {
    VECTOR(struct cs_box, min, 3, "m", NULL, -BIG, BIG, "corner with the smallest coordinates"),
    VECTOR(struct cs_box, max, 3, "m", NULL, -BIG, BIG, "corner with the largest coordinates"),
};
static const struct cs_table box_table = {ROWS(box_rows), .size = sizeof(struct cs_box),
                                          .optional = true};
static const struct cs_option pin_rows[] = {
    CHOICE(struct cs_pin, at, cs_pin_names, -1,
           "a corner or an edge of the grid; a plain string means this"),
    INT(struct cs_pin, index, "", -1, 0, 4294967295.0,
        "a particle of the body, row * columns + column, or a vertex from 0; a plain number "
        "means "
        "this"),
    TABLE(struct cs_pin, box, box_table, "every particle that starts inside"),
};
const struct cs_table cs_pin_table = {ROWS(pin_rows), .size = sizeof(struct cs_pin),
                                      .one_of = true, .shorthand_text = "at",
                                      .shorthand_number = "index"};
