/* zip.h - uncompressed ZIP archives of any size, written in one pass. */
#ifndef CS_EXPORT_ZIP_H
#define CS_EXPORT_ZIP_H

#include "base/file.h"

#include <stdint.h>

enum { CS_ZIP_MEMBERS_MAX = 24 };

/* An entry of the central directory, kept until the archive is finished. */
struct cs_zip_member {
    char name[40];
    uint64_t offset, bytes; /* of its local header in the file; length of its data */
    uint32_t crc;           /* CRC-32 of the data so far */
};

/* An archive that is being written; all but `file` zeroed at the start. */
struct cs_zip {
    FILE *file;      /* borrowed, seekable; failures to write are found when it is finished */
    uint64_t offset; /* bytes written */
    unsigned n;
    struct cs_zip_member members[CS_ZIP_MEMBERS_MAX];
};

/* Begins a member of exactly `bytes` bytes, which cs_zip_put then writes. The name is copied.
 */
void cs_zip_begin(struct cs_zip *zip, const char *name, uint64_t bytes);
/* Appends n bytes to the member. */
void cs_zip_put(struct cs_zip *zip, const void *bytes, size_t n);
/* Ends the member, whose bytes are all written: completes its header. */
void cs_zip_end(struct cs_zip *zip);

/* Writes the central directory; the caller finishes the file. */
void cs_zip_finish(struct cs_zip *zip);

#endif
