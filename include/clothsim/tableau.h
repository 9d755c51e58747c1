/* SPDX-License-Identifier: MIT */
/* tableau.h - a Runge-Kutta method whose coefficients come from a file. */
#ifndef CLOTHSIM_TABLEAU_H
#define CLOTHSIM_TABLEAU_H

#ifdef __cplusplus
extern "C" {
#endif

enum { CS_TABLEAU_STAGES = 35 };

/* Butcher's tableau; stage i uses stages 0 to i, itself if a[i][i] > 0. */
struct cs_tableau {
    int stages, order;
    double a[CS_TABLEAU_STAGES][CS_TABLEAU_STAGES], b[CS_TABLEAU_STAGES], c[CS_TABLEAU_STAGES];
    double difference[CS_TABLEAU_STAGES]; /* b minus that of the embedded method, or 0 */
};

/* Given to the module `tableau` of clothsim in place of options. */
struct cs_tableau_channel {
    const struct cs_tableau *tableau;
    const void *options;
};

#ifdef __cplusplus
}
#endif

#endif
