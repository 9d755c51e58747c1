/* zip.h - archives of members as they are, not packed, of any size. */
#ifndef CS_EXPORT_ZIP_H
#define CS_EXPORT_ZIP_H

#include "base/file.h"

#include <stdint.h>

enum { CS_ZIP_MEMBERS_MAX = 24 };

struct cs_zip_member {
    char name[40];
    uint64_t offset, bytes; /* where its header is, and how long its data are */
    uint32_t crc;
};

/* An archive under way. */
struct cs_zip {
    FILE *file; /* borrowed; failures to write are seen when it is finished */
    uint64_t offset;
    unsigned n;
    struct cs_zip_member members[CS_ZIP_MEMBERS_MAX];
};

/* Begins a member of so many bytes, which are then put. */
void cs_zip_begin(struct cs_zip *zip, const char *name, uint64_t bytes);
void cs_zip_put(struct cs_zip *zip, const void *bytes, size_t n);
/* When all of its bytes are there. */
void cs_zip_end(struct cs_zip *zip);

/* Writes the list of all members. */
void cs_zip_finish(struct cs_zip *zip);

#endif
