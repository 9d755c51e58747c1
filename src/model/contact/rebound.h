/* rebound.h - particles in impact with colliders, stepped alone within a linearised step.
 *
 * A linearised step of implicit Euler that is long against range/speed keeps about a third of
 * the energy of an impact, whatever slope of the force it takes: it loses m (dv)^2/2. So where
 * contact outweighs all else that acts on a particle, its motion along the normal is integrated
 * over the step by itself, by many short steps of its own, with all other forces constant. The
 * linear system is given the impulse and the end of this flight instead of force and slope at
 * the begin of the step, so that the neighbours feel it, and the particle them.
 *
 * At the begin of a step of length h, for a particle of mass m at a plane, sphere, capsule or
 * box: distance d with gradient g, u = g.(v - w) with w the velocity of the surface, F and K
 * the law at d, f0 = g.(all other forces), E = m u^2/2 + psi(d). The flight
 *
 *   m w' = F(d) - tau K w + f0        over h, by Verlet, gives d1, w1, J = m (w1 - u) - h f0
 *
 * with m/g.g for m and g.f/g.g for forces where g is no unit vector, as in the smoothed bands
 * at the edges of a box. The particle is in impact if |f0| h < J/2, or it leaves with a
 * momentum above 2 |f0| h, which a linear law would hold back; and if the linear model misses
 * more than 0.01 E: of the energy of contact along the way without contact, or along its own
 * way, or of the whole energy against that of the flight. Then, with K1 = K(d1), contact has in
 * A dv = b
 *
 *   block   h^2 K1 g g' + h r (I - g g')
 *   b       (J + h^2 K1 (w1 - u)) g - m l T/|T| - h r T,    T the velocity along the surface
 *
 * and the particle moves by h v' + (d1 - d - h w1) g. K1 answers what the neighbours add.
 * Coulomb's impulse mu J takes s = mu J/m from the speed |T|: by the impulse m l, l = min(s,
 * |T| - ev), as far as the particle alone slides, and the rest by a drag, r = (m/h) (s -
 * l)/sqrt(T^2 + ev^2). Neighbours that pull it on at |T| then feel mu J in all. A drag that
 * brings it to rest took up to 0.14 m/s too much from a sheet at 2 m/s.
 *
 * With c the change of velocity by the flight, (w1 - u) g + T1 - T, what is solved is A (dv -
 * c) = b - A c. Otherwise c would be most of b, and what a relative residual allows would be
 * large against friction and neighbours.
 *
 * After the step a particle in impact must end near d1 (step_check.h). Meshes meet particles in
 * pairs, which are not stepped alone.
 */
#ifndef CS_CONTACT_REBOUND_H
#define CS_CONTACT_REBOUND_H

#include "model/contact/step_check.h"
#include "model/spring/spring_runs.h"
#include "model/system/particle_system.h"

/* True if a scene has contact by force with a collider that is no mesh. */
bool cs_rebounds_possible(const struct cs_scene *scene);

/* Sets system->rebounds, with memory of the arena. CS_ERR_MEMORY. */
enum cs_status cs_rebounds_init(struct cs_system *system, struct cs_arena *arena,
                                struct cs_error *error);

/* Finds the particles in impact of a step of h from (t, x, v); f (3,n) in N: all forces there.
 * Each takes the first collider that it is in impact with. */
void cs_rebounds_find(const struct cs_system *system, double t, double h, const double *x,
                      const double *v, const double *f);

/* v (3,n) += c, and x += what particles in impact move beyond h v' without c, for v' = v +
 * (dv - c). The next test of a step is about this one. */
void cs_rebounds_move(const struct cs_system *system, double h, double *x, double *v);

/* Work in J that colliders do on the particles in impact: m c.w, with the velocity w of the
 * surface at (t, x). */
double cs_rebounds_work(const struct cs_system *system, double t, const double *x);

/* The impact of particle i with a collider in this matrix, or NULL. */
static inline const struct cs_rebound *cs_rebound_of(const struct cs_system *system,
                                                     const struct cs_matrix *matrix,
                                                     uint32_t collider, size_t i) {
    if (!matrix->rebounds || system->rebounds->list[i].collider != collider + 1)
        return NULL;
    return system->rebounds->list + i;
}

/* Moves *i on to the first particle from *i on and before `end` that is in impact with this
 * collider, or CS_ANY_COLLIDER; returns false if there is none. */
#define CS_ANY_COLLIDER UINT32_MAX
bool cs_rebound_next(const struct cs_system *system, uint32_t collider, size_t end, size_t *i);

/* Adds the block of an impact to b: xx, xy, xz, yy, yz, zz. */
void cs_rebound_add_block(const struct cs_rebound *rebound, const struct cs_matrix *matrix,
                          double b[6]);

#endif
