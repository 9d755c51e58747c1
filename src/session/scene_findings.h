/* scene_findings.h - findings about a scene before its run: keys that nothing reads, mistakes
 * in paths, bodies that overlap, obstacles beside coarse grids. */
#ifndef CS_SCENE_FINDINGS_H
#define CS_SCENE_FINDINGS_H

#include "scene/force_keys.h"
#include "session/session.h"

/* Adds the keys that have another value than their default, but no effect, one per line:
 * "bodies[0].thickness has no effect: ...". */
void cs_idle_keys_print(const struct cs_scene *scene, struct cs_text *out);

/* Returns the index of the rule about a key, "bodies[].springs.shear", or -1: each key of a
 * scene must have one, if only that it always acts. */
int cs_idle_keys_rule(const char *key);

/* A check of body or event k, which adds a line without its end, or nothing. */
typedef void cs_finding(const struct cs_system *system, uint32_t k, const void *arg,
                        struct cs_text *out);
/* Runs a check on 0 to n - 1: adds its first line, and on how many more it finds the same. */
void cs_findings_print(const struct cs_system *system, uint32_t n, cs_finding *check,
                       const void *arg, struct cs_text *out);

/* m, diagonal of the box of the first `count` vectors of x (3,n); low and high: its corners. */
double cs_findings_box_of(const double *x, size_t n, size_t count, double low[3],
                          double high[3]);
/* The same of a body at the start. */
double cs_findings_box(const struct cs_system *system, uint32_t b, double low[3],
                       double high[3]);

/* m, distance of neighbours in a grid; 0 for a mesh. */
double cs_findings_spacing(const struct cs_body *body);

/* Adds colliders above which coarse bodies hover, and those that fit between particles, which
 * are all that projection sees. */
void cs_contact_spacing_print(const struct cs_system *system, struct cs_text *out);

/* Adds colliders that go through held particles until the last event or that many seconds. */
void cs_motion_findings_print(const struct cs_session *session, double seconds,
                              struct cs_text *out);

/* Adds these, pins that hold nothing, seams over gaps, releases of what nothing holds, and
 * grabs that begin with a jump. The particles are at their start. Uses events->work. */
void cs_trajectory_findings_print(const struct cs_session *session, double seconds,
                                  struct cs_scene_findings *out);

/* m/s, mean speed of the first leg of a path. */
double cs_findings_first_speed(const struct cs_event *event, const struct cs_path_point *to,
                               const double from[3]);

/* Adds moves that jump. */
void cs_path_findings_print(const struct cs_system *system, struct cs_text *out);

/* --- bodies that overlap, or could collide during the run, while no contact is defined between
 * them --- */

/* Adds one line about the first pair, and how many more there are; nothing if there is none.
 *
 * Compared are the bounding boxes at the start, then boxes of all positions reachable within
 * that many seconds: along its fall for a free body, and for a pinned body within the distance
 * from its last pin to its farthest particle. Boxes are larger than bodies, so a warning can be
 * false. CS_ERR_MEMORY. */
enum cs_status cs_overlap_warning_print(const struct cs_scene *scene, double seconds,
                                        struct cs_text *out, struct cs_error *error);

/* Warns of colliders that are too small for the contact samples of a mesh.
 */

/* Adds one line about the first collider that can enter between the samples of the longest edge
 * (model/contact/contact_samples.h), and how many more there are. Nothing if there is none, or
 * without contact by force. */
void cs_sampling_warning_print(const struct cs_system *system, struct cs_text *out);

/* Warns of bodies that start inside a closed surface they collide with.
 */

/* Adds one line about the first body inside a closed body or mesh collider that it collides
 * with, and how many more there are; nothing if there is none. Contact prevents crossing, hence
 * such a body cannot get out. */
void cs_containment_warning_print(const struct cs_system *system, struct cs_text *out);

#endif
