/* pvd.h - the PVD file that says when each VTP file was, for ParaView. */
#ifndef CS_EXPORT_PVD_H
#define CS_EXPORT_PVD_H

#include "io/export/append_file.h"
#include "io/export/export_mesh.h"

/* FOLDER/run.pvd, whole after each sample. Zeroed: closed. */
struct cs_pvd {
    struct cs_append_file file;
    uint64_t end; /* of its entries */
};

enum cs_status cs_pvd_open(struct cs_pvd *pvd, const char *folder, struct cs_error *error);

/* Adds a sample of both skins, if they have points; one that never moves has one file, of
 * number 0. */
enum cs_status cs_pvd_add(struct cs_pvd *pvd, const struct cs_export_mesh *const skins[2],
                          uint32_t number, double t, struct cs_error *error);

#endif
