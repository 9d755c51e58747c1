/* scene_doctor.h - tells before the first step of a run where a scene will go wrong, with the
 * value that would do. */
#ifndef CS_SCENE_DOCTOR_H
#define CS_SCENE_DOCTOR_H

#include "study/scene_findings.h"
#include "study/session.h"

/* Checks a session whose system is built, over the given time in s. Changes nothing, and reads
 * the state of the start only. CS_ERR_MEMORY. */
enum cs_status cs_scene_doctor_check(const struct cs_session *session, double seconds,
                                     struct cs_scene_findings *out, struct cs_error *error);
void cs_scene_findings_finish(struct cs_scene_findings *findings);

/* Appends why "automatic" chose the method, without an end of line; nothing if it was named. */
void cs_session_print_choice(const struct cs_session *session, struct cs_text *out);

#endif
