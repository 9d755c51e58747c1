/* viewpoint.h - check of a view: an eye, its target, and the direction up. */
#ifndef CS_VIEWPOINT_H
#define CS_VIEWPOINT_H

/* Returns the fault of a view, or NULL; *key is then "target" or "up". */
const char *cs_viewpoint_fault(const double eye[3], const double target[3], const double up[3],
                               const char **key);

#endif
