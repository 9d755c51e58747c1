/* run.h - steps a system with a method, frame by frame.
 *
 * One run is begin, any number of frames, finish. Its host lies on the heap and never moves,
 * since the method keeps a pointer to it; struct cs_run must stay where it is too. */
#ifndef CS_RUN_H
#define CS_RUN_H

#include "base/hash.h"
#include "base/serialise.h"
#include "model/force/diagnostics.h"
#include "sim/run_state.h"

/* The text of an outcome, a constant: "finished", "blew up: not finite". */
const char *cs_outcome_text(enum cs_outcome outcome);
/* The present text of an outcome read from a file, which the last release may have written. */
const char *cs_outcome_current(const char *text);
extern const char *const cs_stage_names[]; /* closed by NULL */

/* Creates the method on the system with filled options (integrator->options_size bytes), and
 * restarts it at time 0. The system is borrowed until finish, and its state is the run's. On
 * failure *run is empty: CS_ERR_MODULE with the method's message, or CS_ERR_MEMORY. */
enum cs_status cs_run_begin(struct cs_run *run, struct cs_system *system,
                            const struct cs_integrator *integrator, const void *options,
                            const struct cs_run_settings *settings, struct cs_error *error);

/* Steps to the next frame, t = (frame + 1) / fps. A blow-up, an interrupt, the end of the
 * budget or a method that gives up sets run->outcome and returns CS_OK with run->frame
 * unchanged; the state is then the one of the last commit. CS_ERR_MODULE: the method failed;
 * the message says when and why. */
enum cs_status cs_run_frame(struct cs_run *run, struct cs_error *error);

/* The two calls of the method that make up a frame, alone: no events, no clock. The caller
 * may move the state before restart. CS_ERR_MODULE as above. */
enum cs_status cs_run_restart(struct cs_run *run, double t, struct cs_error *error);
enum cs_status cs_run_advance(struct cs_run *run, double from, double to,
                              struct cs_error *error);

/* The method's save or load, guarded as its other calls. CS_ERR_MODULE as above. */
typedef enum cs_step cs_archive_call(void *self, const struct cs_archive *archive);
enum cs_status cs_run_archive(struct cs_run *run, cs_archive_call *call,
                              const struct cs_archive *archive, struct cs_error *error);

/* The calls as the method sees them, valid until finish. */
const struct cs_host *cs_run_calls(const struct cs_run *run);
/* Makes every linear solve of the host fail from now on, to test what a method does then. */
void cs_run_fail_solves(struct cs_run *run);

/* True if a method has goals, the points that shape matching draws particles to. cs_run_goals
 * writes them for the present state to g (3,n) in m, and changes nothing of the run. */
bool cs_run_has_goals(const struct cs_integrator *integrator);
void cs_run_goals(const struct cs_run *run, double *g);
/* Bytes of all arrays of the run: the system's, the meshes', the solver's and the method's.
 * Exact, and the same on every machine with the same number of threads. The private memory of
 * foreign libraries is not included. */
size_t cs_run_bytes(const struct cs_run *run);

/* Hash of the state, as 32 hexadecimal digits: that of x and v, and in a scene with friction
 * that sticks the hash of that hash and the one of all anchors; if stitches broke the hash of
 * that one and the one of the broken. */
void cs_run_hash(const struct cs_run *run, char digits[CS_HASH_DIGITS]);

/* Adds a remark to the report, as the method does by host->note. */
void cs_run_note(struct cs_run *run, const char *format, ...) CS_PRINTF(2, 3);

/* Destroys the method and frees its memory; *run is then empty. Safe on an empty run. */
void cs_run_finish(struct cs_run *run);

/* --- a run between two frames as bytes, for a checkpoint --- */

/* True if the method has save and load. A method without them is restarted whenever a record
 * is made, in the unbroken run too: both runs then continue with the same bits. */
bool cs_run_method_has_history(const struct cs_integrator *integrator);

/* Writes everything that the next frame depends on: state, time, counts, events, contact, and
 * the method's history. May restart the method, see above. CS_ERR_MEMORY, or CS_ERR_MODULE
 * with the method's message. */
enum cs_status cs_run_save(struct cs_run *run, struct cs_serialiser *serialiser,
                           struct cs_error *error);

/* Reads a record into a run that was begun in the same way and has made no frame yet. After a
 * failure (CS_ERR_FILE: bytes of another run; CS_ERR_MODULE) the run must not be used. */
enum cs_status cs_run_load(struct cs_run *run, struct cs_serialiser *serialiser,
                           struct cs_error *error);

#endif
