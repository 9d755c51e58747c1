/* composition_sequences.h - the coefficients of composition.c. */
#ifndef COMPOSITION_SEQUENCES_H
#define COMPOSITION_SEQUENCES_H

#include <stddef.h>
#include <stdint.h>

enum { KICKS = 12 };

/* One set of coefficients. */
struct sequence {
    int kicks;           /* s */
    double kick[KICKS];  /* b_1 .. b_s */
    double drift[KICKS]; /* a_1 .. a_(s-1), then 0 */
    uint32_t order[3];   /* without damping; with it, by prediction and by quadrature */
    /* z and q of composition.c's limit: without quadrature, with it. A mode of frequency w is
     * stable for h w < z, by trial of the 2x2 matrix of a step. */
    double limit[2], damping[2];
    int degrees, conditions; /* of quadrature_weights() */
};

static const char *const methods[] = {"blanes-moan", "calvo-sanz-serna", "vefrl", NULL};

/* In the order of `methods`. */
static const struct sequence sequences[] = {
    /* order 6: Blanes, Moan 2002 (11 stages) */
    {.kicks = 12,
     .order = {6, 2, 5},
     .kick = {0.0414649985182624, 0.198128671918067, -0.0400061921041533, 0.0752539843015807,
              -0.0115113874206879, 0.2366699247869311, 0.2366699247869311, -0.0115113874206879,
              0.0752539843015807, -0.0400061921041533, 0.198128671918067, 0.0414649985182624},
     .drift = {0.123229775946271, 0.290553797799558, -0.127049212625417, -0.246331761062075,
               0.357208872795928, 0.20477705429147, 0.357208872795928, -0.246331761062075,
               -0.127049212625417, 0.290553797799558, 0.123229775946271},
     .limit = {9, 6.2},
     .damping = {1, 1.7},
     .degrees = 5,
     .conditions = 8},
    /* order 4, not symmetric: Calvo et al. 1993 */
    {.kicks = 5,
     .order = {4, 2, 4},
     .kick = {0.061758858135626325, 0.33897802655364334, 0.61479130717558371,
              -0.14054801465937337, 0.12501982279452613},
     .drift = {0.20517766154229387, 0.40302128160421459, -0.12092087633891008,
               0.51272193319240162},
     .limit = {3, 3},
     .damping = {1.3, 3.35},
     .degrees = 4,
     .conditions = 5},
    /* order 4: Omelyan, Mryglod, Folk 2002 (velocity extended Forest-Ruth-like) */
    {.kicks = 5,
     .order = {4, 2, 4},
     .kick = {0.164498651557576, 1.235692651138917, -1.800382605392986, 1.235692651138917,
              0.164498651557576},
     .drift = {0.5209433391039899, -0.02094333910398989, -0.02094333910398989,
               0.5209433391039899},
     .limit = {3.4, 3.4},
     .damping = {6, 5.1},
     .degrees = 3,
     .conditions = 4},
};

#endif
