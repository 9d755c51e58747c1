/* Writes the collection that gives VTP files their times. */
#include "io/export/pvd.h"

#include "base/text.h"

static const char head[] = "<?xml version=\"1.0\"?>\n"
                           "<VTKFile type=\"Collection\" version=\"0.1\" "
                           "byte_order=\"LittleEndian\">\n<Collection>\n";
static const char tail[] = "</Collection>\n</VTKFile>\n";

/* Entries take the place of the file's end, which follows them again. */
static enum cs_status put(struct cs_pvd *pvd, struct cs_text *entries, struct cs_error *error) {
    const size_t length = entries->length;
    cs_text_add(entries, "%s", tail);
    if (entries->failed)
        cs_fail(error, CS_ERR_MEMORY, "out of memory for \"%s\"", pvd->file.path);
    else if (!cs_append_file_write(&pvd->file, pvd->end, entries->bytes, entries->length,
                                   error))
        pvd->end += length;
    cs_text_finish(entries);
    return error->status;
}

enum cs_status cs_pvd_open(struct cs_pvd *pvd, const char *folder, struct cs_error *error) {
    char path[CS_EXPORT_PATH];
    struct cs_text entries = {0};
    *pvd = (struct cs_pvd){0};
    if (cs_export_name(path, folder, "run.pvd", error) ||
        cs_append_file_open(&pvd->file, path, 0, error))
        return error->status;
    cs_text_add(&entries, "%s", head);
    return put(pvd, &entries, error);
}

enum cs_status cs_pvd_add(struct cs_pvd *pvd, const struct cs_export_mesh *const skins[2],
                          uint32_t number, double t, struct cs_error *error) {
    struct cs_text entries = {0};
    for (uint32_t part = 0; part < 2; part++) {
        const struct cs_export_mesh *skin = skins[part];
        if (skin->n == 0)
            continue;
        cs_text_add(&entries, "<DataSet timestep=\"");
        cs_text_add_real(&entries, t);
        cs_text_add(&entries, "\" part=\"%u\" file=\"%s_%05u.vtp\"/>\n", part, skin->name,
                    skin->is_moving ? number : 0);
    }
    return put(pvd, &entries, error);
}
