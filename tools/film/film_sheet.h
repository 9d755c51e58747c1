/* film_sheet.h - contact sheets: pictures of a run side by side on one, and what run.json says
 * of them. */
#ifndef CS_FILM_SHEET_H
#define CS_FILM_SHEET_H

#include "base/image.h"
#include "base/status.h"

#include <stdbool.h>
#include <stdint.h>

/* A picture of a run. */
struct cs_film_picture {
    uint32_t number; /* of the file frame_NUMBER.png */
    double frame;    /* of the run */
    double range[2]; /* of its colours; both 0: they show no value */
};

/* Contents of run.json about the pictures of its folder. */
struct cs_film_report {
    double fps;                       /* of the scene */
    int32_t look;                     /* enum cs_look */
    bool clear;                       /* the pictures have alpha */
    char method[64];                  /* with its first option, for titles */
    double seconds;                   /* of the method */
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

/* Plays the pictures in the terminal at `rate` per second, until the last or an interruption.
 * Those that a slow terminal would show too late are left out, but for the last.
 * CS_ERR_USAGE: no terminal; CS_ERR_FILE, CS_ERR_MEMORY, CS_ERR_INTERRUPT. */
enum cs_status cs_film_show(const char *folder, const struct cs_film_report *report,
                            double rate, struct cs_error *error);

/* Layout of a sheet. */
struct cs_contact_sheet {
    uint32_t columns, rows; /* at most; then as they came out */
    uint32_t tile;          /* pixels of a picture's width at most */
    bool colour_bar;        /* set by make: it has a colour bar */
    uint32_t captions;      /* set by make: lines of text at each picture */
};

/* Makes a sheet of pictures that are evenly spaced over a run, from the first to the last, each
 * shrunk in linear light and with its time below. There are as many columns and rows, up to
 * those asked for, as the pictures fill. A colour bar stands beside them where all pictures
 * have one range of colours. The caller frees image->rgb. CS_ERR_FILE: a picture is missing, or
 * of another size than the first; the sheet is too large. CS_ERR_MEMORY. */
enum cs_status cs_contact_sheet_make(struct cs_contact_sheet *sheet, const char *folder,
                                     const struct cs_film_report *report,
                                     struct cs_image *image, struct cs_error *error);

/* Pictures of several runs side by side at one time, with titles above if asked for: the
 * method, its seconds, and the root mean square distance to the first run, where both wrote
 * their states into their folders (run --states). */
struct cs_film_tiles {
    uint32_t n, tile;                     /* runs; pixels of a picture's width at most */
    const char *const *folders;           /* (n) borrowed */
    const struct cs_film_report *reports; /* (n) borrowed */
    bool titles;
};

/* Makes the image of picture k of all runs, or of the last of a run that has fewer. The caller
 * frees image->rgb. CS_ERR_FILE, as for sheets; CS_ERR_MEMORY. */
enum cs_status cs_film_tiles_make(const struct cs_film_tiles *tiles, uint32_t k,
                                  struct cs_image *image, struct cs_error *error);

#endif
