/* Writes ZIP archives (PKWARE's APPNOTE 6.3), members stored without compression. Sizes and
 * offsets have 64 bits throughout (Zip64), so small and large archives use one code path.
 * Numbers are little-endian; bytes in parentheses:
 *
 *   local header   04034b50 (4), version (2), flags (2), method (2), time (2), date (2), CRC
 * (4),
 *                  sizes ffffffff (4, 4), length of name (2), of extra field (2), name, extra
 *   data
 *   central entry  02014b50 (4), made by (2), the fields from version on as above, comment (2),
 *                  disk (2), attributes (2, 4), offset ffffffff (4), name, extra
 *   extra field    id 1 (2), length (2), both sizes (8, 8), in a central entry also offset (8)
 *   Zip64 end      06064b50 (4), length 44 (8), versions (2, 2), disks (4, 4), counts (8, 8),
 *                  size and offset of the directory (8, 8)
 *   locator        07064b50 (4), disk (4), offset of the Zip64 end (8), disks (4)
 *   end            06054b50 (4), disks (2, 2), counts ffff (2, 2), ffffffff (4, 4), comment (2)
 *
 * All ones in a field mean that the Zip64 field holds the number. Dates are fixed, so equal
 * runs give equal archives.
 */
#include "export/writer.h"

#include "base/hash.h"

#include <endian.h>
#include <errno.h>
#include <string.h>

/* version 4.5 is the first with sizes of 64 bits; the date is 1 January 1980 */
enum { VERSION = 45, DATE = 1 << 5 | 1, LONG_EXTRA = 1, ELSEWHERE = 0xffff };
#define ELSEWHERE_LONG 0xffffffffu

/* Writers of little-endian numbers; they count the bytes. */
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

/* Writes the fields that a local header and a central entry have in common. */
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

/* Writes the name and the Zip64 extra field; a central entry appends its offset. */
static void put_extra(struct cs_zip *zip, const struct cs_zip_member *member,
                      unsigned extra_bytes) {
    zip->offset += fwrite(member->name, 1, strlen(member->name), zip->file);
    put_16(zip, LONG_EXTRA);
    put_16(zip, extra_bytes);
    put_64(zip, member->bytes);
    put_64(zip, member->bytes);
}

/* Writes a local header of fixed length, so that it can be written again with the checksum. */
static void put_header(struct cs_zip *zip, const struct cs_zip_member *member) {
    put_32(zip, 0x04034b50);
    put_member(zip, member, 16);
    put_extra(zip, member, 16);
}

void cs_zip_begin(struct cs_zip *zip, const char *name, uint64_t bytes) {
    CS_ASSERT(zip->n < CS_ZIP_MEMBERS_MAX);
    struct cs_zip_member *member = zip->members + zip->n++;
    *member = (struct cs_zip_member){
        .offset = zip->offset,
        .bytes = bytes,
    };
    snprintf(member->name, sizeof member->name, "%s", name);
    put_header(zip, member);
}

void cs_zip_put(struct cs_zip *zip, const void *bytes, size_t n) {
    struct cs_zip_member *member = zip->members + zip->n - 1;
    member->crc = cs_hash_crc32(member->crc, bytes, n);
    zip->offset += fwrite(bytes, 1, n, zip->file);
}

void cs_zip_end(struct cs_zip *zip) {
    struct cs_zip_member *member = zip->members + zip->n - 1;
    const uint64_t end = zip->offset;
    /* the checksum is known only now */
    if (fseeko(zip->file, (off_t)member->offset, SEEK_SET))
        zip->seek_error = errno;
    put_header(zip, member);
    if (fseeko(zip->file, (off_t)end, SEEK_SET))
        zip->seek_error = errno;
    zip->offset = end;
}

/* Writes an entry of the central directory. */
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

/* Writes the Zip64 end, its locator, and the end record that readers search from the back. */
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
