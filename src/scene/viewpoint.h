/* viewpoint.h - an eye, what it looks at, and which way is up: of cameras and of forces from a
 * viewpoint. */
#ifndef CS_VIEWPOINT_H
#define CS_VIEWPOINT_H

/* What is wrong with a view, or NULL; *key is then "target" or "up". */
const char *cs_viewpoint_fault(const double eye[3], const double target[3], const double up[3],
                               const char **key);

#endif
