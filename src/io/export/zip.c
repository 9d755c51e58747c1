/* Writes ZIP archives (PKWARE's APPNOTE 6.3): every member stored, with sizes and places of 64
 * bits throughout, so that small and large archives go one way. */
#include "io/export/zip.h"

#include <endian.h>
#include <string.h>
#include <zlib.h>

/* extracted by version 4.5 on, which knows sizes of 64 bits; of 1 January 1980 */
enum { VERSION = 45, DATE = 1 << 5 | 1, LONG_EXTRA = 1, ELSEWHERE = 0xffff };
#define ELSEWHERE_LONG 0xffffffffu

static void put_16(struct cs_zip *zip, unsigned value) {
    const uint16_t word = htole16((uint16_t)value);
    zip->offset += fwrite(&word, 1, sizeof word, zip->file);
}

static void put_32(struct cs_zip *zip, uint32_t value) {
    const uint32_t word = htole32(value);
    zip->offset += fwrite(&word, 1, sizeof word, zip->file);
}

static void put_64(struct cs_zip *zip, uint64_t value) {
    const uint64_t word = htole64(value);
    zip->offset += fwrite(&word, 1, sizeof word, zip->file);
}

/* what a member's own header and its entry in the list have in common */
static void put_member(struct cs_zip *zip, const struct cs_zip_member *member,
                       unsigned extra_bytes) {
    put_16(zip, VERSION);
    put_16(zip, 0); /* flags */
    put_16(zip, 0); /* stored */
    put_16(zip, 0); /* time of day */
    put_16(zip, DATE);
    put_32(zip, member->crc);
    put_32(zip, ELSEWHERE_LONG); /* both sizes are in the extra field */
    put_32(zip, ELSEWHERE_LONG);
    put_16(zip, (unsigned)strlen(member->name));
    put_16(zip, extra_bytes + 4);
}

static void put_extra(struct cs_zip *zip, const struct cs_zip_member *member,
                      unsigned extra_bytes) {
    zip->offset += fwrite(member->name, 1, strlen(member->name), zip->file);
    put_16(zip, LONG_EXTRA);
    put_16(zip, extra_bytes);
    put_64(zip, member->bytes);
    put_64(zip, member->bytes);
}

static void put_header(struct cs_zip *zip, const struct cs_zip_member *member) {
    put_32(zip, 0x04034b50);
    put_member(zip, member, 16);
    put_extra(zip, member, 16);
}

void cs_zip_begin(struct cs_zip *zip, const char *name, uint64_t bytes) {
    CS_ASSERT(zip->n < CS_ZIP_MEMBERS_MAX);
    struct cs_zip_member *member = zip->members + zip->n++;
    *member = (struct cs_zip_member){
        .offset = zip->offset, .bytes = bytes, .crc = (uint32_t)crc32(0, NULL, 0)};
    snprintf(member->name, sizeof member->name, "%s", name);
    put_header(zip, member);
}

void cs_zip_put(struct cs_zip *zip, const void *bytes, size_t n) {
    struct cs_zip_member *member = zip->members + zip->n - 1;
    member->crc = (uint32_t)crc32_z(member->crc, bytes, n);
    zip->offset += fwrite(bytes, 1, n, zip->file);
}

void cs_zip_end(struct cs_zip *zip) {
    struct cs_zip_member *member = zip->members + zip->n - 1;
    const uint64_t end = zip->offset;
    /* only now is the checksum known; a failure shows in what follows, or when the file is
     * finished */
    if (!fseeko(zip->file, (off_t)member->offset, SEEK_SET))
        put_header(zip, member);
    fseeko(zip->file, (off_t)end, SEEK_SET);
    zip->offset = end;
}

static void put_entry(struct cs_zip *zip, const struct cs_zip_member *member) {
    put_32(zip, 0x02014b50);
    put_16(zip, VERSION); /* made by */
    put_member(zip, member, 24);
    put_16(zip, 0); /* no comment, one disk, no attributes */
    put_16(zip, 0);
    put_16(zip, 0);
    put_32(zip, 0);
    put_32(zip, ELSEWHERE_LONG);
    put_extra(zip, member, 24);
    put_64(zip, member->offset);
}

/* The end of 64 bits, where it is, and the end that older readers look for. */
static void put_ends(struct cs_zip *zip, uint64_t list, uint64_t end) {
    put_32(zip, 0x06064b50);
    put_64(zip, 44); /* bytes of it that follow */
    put_16(zip, VERSION);
    put_16(zip, VERSION);
    put_64(zip, 0); /* this disk, and that of the list */
    put_64(zip, zip->n);
    put_64(zip, zip->n);
    put_64(zip, end - list);
    put_64(zip, list);

    put_32(zip, 0x07064b50);
    put_32(zip, 0);
    put_64(zip, end);
    put_32(zip, 1); /* disks */

    put_32(zip, 0x06054b50);
    put_32(zip, 0);
    put_16(zip, ELSEWHERE);
    put_16(zip, ELSEWHERE);
    put_32(zip, ELSEWHERE_LONG);
    put_32(zip, ELSEWHERE_LONG);
    put_16(zip, 0); /* no comment */
}

void cs_zip_finish(struct cs_zip *zip) {
    const uint64_t list = zip->offset;
    for (unsigned k = 0; k < zip->n; k++)
        put_entry(zip, zip->members + k);
    put_ends(zip, list, zip->offset);
}
