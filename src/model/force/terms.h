/* terms.h - the forces: each a table of functions in a file of its own, and their sum. */
#ifndef CS_TERMS_H
#define CS_TERMS_H

#include "model/system/system.h"

struct cs_term {
    uint32_t parts;          /* enum cs_part that the term adds to */
    enum cs_feature feature; /* of the plan; a scene without it never calls the term */
    /* f (3,n) += force of the chosen parts at the particles of a block */
    void (*add_force)(const struct cs_system *system, double t, const double *x,
                      const double *v, uint32_t parts, const struct cs_block *block, double *f);
    /* potential energy in J; NULL: the force has none */
    double (*energy)(const struct cs_system *system, const double *x);
    /* df (3,n) += (df/dx) dx + (df/dv) dv there; directions may be NULL; NULL: the force is
     * constant */
    void (*add_jvp)(const struct cs_system *system, double t, const double *x, const double *v,
                    uint32_t parts, const double *dx, const double *dv,
                    const struct cs_block *block, double *df);
    /* own blocks (6,n) of df/dx and df/dv; NULL: none, or not in CS_PART_LINEARISED */
    void (*add_diagonal)(const struct cs_system *system, const double *x, double *kxx,
                         double *dvv);
};

/* In the order in which forces are summed. */
extern const struct cs_term cs_term_springs, cs_term_gravity, cs_term_drag, cs_term_wind,
    cs_term_push;
extern const struct cs_term *const cs_terms[];
enum { CS_TERMS = 5 };

/* f (3,n) = sum of the chosen parts, 0 on pinned particles; by all threads. With wind among
 * them the normals of x must be fresh (cs_normals_update). */
void cs_terms_force(const struct cs_system *system, double t, const double *x, const double *v,
                    uint32_t parts, double *f);
/* df (3,n), 0 on pinned particles. Fresh normals as above. */
void cs_terms_jvp(const struct cs_system *system, double t, const double *x, const double *v,
                  uint32_t parts, const double *dx, const double *dv, double *df);
/* kxx, dvv (6,n). */
void cs_terms_diagonal(const struct cs_system *system, const double *x, double *kxx,
                       double *dvv);

/* true if the chosen parts need the particle normals in this scene */
bool cs_terms_need_normals(const struct cs_system *system, uint32_t parts);

#endif
