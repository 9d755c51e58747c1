/* film_sheet.h - contact sheets: pictures of a run side by side on one. */
#ifndef CS_FILM_SHEET_H
#define CS_FILM_SHEET_H

#include "base/image.h"
#include "cli/film/film_report.h"

#include <stdbool.h>

struct cs_contact_sheet {
    uint32_t columns, rows; /* at most; then as they came out */
    uint32_t tile;          /* pixels of a picture's width at most */
    bool colour_bar;        /* set by make: it has a colour bar */
};

/* Makes a sheet of pictures that are evenly spaced over a run, from the first to the last, each
 * shrunk in linear light and with its time below. There are as many columns and rows, up to
 * those asked for, as the pictures fill. A colour bar stands beside them where all pictures
 * have one range of colours. The caller frees image->rgb. CS_ERR_FILE: a picture is missing, or
 * of another size than the first; the sheet is too large. CS_ERR_MEMORY. */
enum cs_status cs_contact_sheet_make(struct cs_contact_sheet *sheet, const char *folder,
                                     const struct cs_film_report *report,
                                     struct cs_image *image, struct cs_error *error);

#endif
