/* stability_map.h - maps of clothsim stability: made, printed and written to a folder. */
#ifndef CS_STABILITY_MAP_H
#define CS_STABILITY_MAP_H

#include "cli/stability_args.h"

/* One method, settings->session.integrator. */
enum cs_status cs_stability_map_one(const struct cs_args *args,
                                    const struct cs_stability_settings *settings,
                                    const char *folder, struct cs_error *error);

/* Every method with a fixed step; the others are named. */
enum cs_status cs_stability_map_all(const struct cs_args *args,
                                    struct cs_stability_settings *settings, const char *folder,
                                    struct cs_error *error);

#endif
