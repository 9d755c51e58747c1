/* made_scene.h - a small scene out of any bytes, by the tables that scenes are read by. */
#ifndef MADE_SCENE_H
#define MADE_SCENE_H

#include "base/text.h"

#include <clothsim/option.h>
#include <stdint.h>

/* Bytes that decide, one after the other; behind the last all are 0. */
struct choices {
    const uint8_t *bytes;
    size_t n;
};

uint8_t choose(struct choices *choices);

/* A number within a row's range: small where it is a count, mostly near the default else. */
double choose_number(struct choices *choices, const struct cs_option *row);

/* Adds a scene as JSON. 0 leaves a key out, so that few bytes make a plain sheet. Its values
 * are within their ranges; keys may still not suit each other. */
void make_scene(struct choices *choices, struct cs_text *out);

#endif
