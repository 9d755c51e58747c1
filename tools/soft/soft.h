/* soft.h - measures the cost of soft bodies: spring networks and shape matching, over the
 * number of springs and of vertices.
 *
 * The first body of one scene is a generated mesh with a spring network. It is run with varying
 * resolution and density, and with shape matching in place of its springs. The soft-body thesis
 * (ch. 5) counts pictures per second with one step per picture, although stable steps may be
 * shorter. Here both are measured: one step per picture, and the steps that a frame needs to be
 * stable. */
#ifndef CS_SOFT_H
#define CS_SOFT_H

#include "base/text.h"
#include "session/session.h"

/* Series of the diagrams. */
enum cs_soft_series {
    CS_SOFT_SMALL,    /* over springs: the smaller body */
    CS_SOFT_LARGE,    /* over springs: the larger body */
    CS_SOFT_SURFACE,  /* over vertices: springs on the surface only, the fewest there can be */
    CS_SOFT_NETWORK,  /* over vertices: inner springs as the scene has them */
    CS_SOFT_IMPLICIT, /* the same network, by one implicit step a frame */
    CS_SOFT_MATCHED,  /* over vertices: shape matching instead of springs */
    CS_SOFT_SERIES
};

extern const char *const cs_soft_names[];

/* One body, run for some frames. Times are medians over frames, or over pictures. */
struct cs_soft_row {
    enum cs_soft_series series;
    uint32_t vertices, springs;
    double steps;        /* of the method in one frame */
    double step_seconds; /* processor time of one step */
    double draw_seconds; /* wall time of one picture; 0: none was drawn */
    enum cs_outcome outcome;
};

/* Pictures per second with one step each, as the thesis counts; and with the steps of a frame.
 */
double cs_soft_rate_one_step(const struct cs_soft_row *row);
double cs_soft_rate(const struct cs_soft_row *row);

enum { CS_SOFT_ROWS_MAX = 64 };

/* Request and results; pointers are borrowed. */
struct cs_soft {
    struct cs_session_settings session; /* scene, overrides, plugins, stop */
    double seconds;                     /* processor time that a row is measured for, about */
    bool draw;                          /* pictures too */
    void (*progress)(void *ctx, uint32_t done, uint32_t total);
    void *ctx;
    struct cs_soft_row rows[CS_SOFT_ROWS_MAX]; /* out, series by series */
    uint32_t n;
};

/* Checks that the scene has such a body. CS_ERR_SCENE, or the errors of reading it. */
enum cs_status cs_soft_check(const struct cs_soft *soft, struct cs_error *error);

/* Measures all rows of a checked scene in sequence. CS_ERR_MODULE without a renderer;
 * CS_ERR_INTERRUPT keeps the finished rows. */
enum cs_status cs_soft_run(struct cs_soft *soft, struct cs_error *error);

/* Exponent p of time = c x^p over a series, by least squares of the logarithms. x is the number
 * of springs, or of vertices for CS_SOFT_MATCHED. NAN with fewer than two different x. */
double cs_soft_growth(const struct cs_soft *soft, enum cs_soft_series series);

/* Print the rows: tables and what they say; a CSV, a row a line. */
void cs_soft_print(const struct cs_soft *soft, struct cs_text *out);
void cs_soft_print_csv(const struct cs_soft *soft, struct cs_text *out);

#endif
