/* film_report.h - reads what run.json says of the pictures of its folder. */
#ifndef CS_FILM_REPORT_H
#define CS_FILM_REPORT_H

#include "base/status.h"

#include <stdbool.h>
#include <stdint.h>

struct cs_film_picture {
    uint32_t number; /* of the file frame_NUMBER.png */
    double frame;    /* of the run */
    double range[2]; /* of its colours; both 0: they show no value */
};

struct cs_film_report {
    double fps;                       /* of the scene */
    int32_t look;                     /* enum cs_look */
    bool clear;                       /* the pictures have alpha */
    uint32_t n;                       /* at least one */
    struct cs_film_picture *pictures; /* (n), owned */
};

/* Reads FOLDER/run.json. CS_ERR_FILE: also where it is of a run that drew no pictures. On
 * failure *report is empty. */
enum cs_status cs_film_report_read(const char *folder, struct cs_film_report *report,
                                   struct cs_error *error);
/* Frees the list; the report is then empty. */
void cs_film_report_finish(struct cs_film_report *report);

/* Pictures a second: the scene's frames over those between the first two pictures. */
double cs_film_rate(const struct cs_film_report *report);

#endif
