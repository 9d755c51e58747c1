/* Any chunks, a kind and a length and bytes each, in a picture: of those that a run wrote only
 * tEXt is read, and what it says is read as the provenance of a picture is. */
#include "base/png.h"
#include "folder.h"
#include "reproduce/provenance_read.h"

#include <stdint.h>

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t length);

enum { KINDS = 4, KEYS = 3 };
static const char *const kinds[KINDS] = {"tEXt", "zTXt", "iTXt", "abCd"};
static const char *const keys[KEYS] = {"clothsim:frame", "clothsim:pixel-hash", "clothsim:run"};

static void add_number(struct cs_text *out, uint32_t value) {
    const uint8_t big_endian[] = {(uint8_t)(value >> 24), (uint8_t)(value >> 16),
                                  (uint8_t)(value >> 8), (uint8_t)value};
    cs_text_add_bytes(out, big_endian, sizeof big_endian);
}

static void add_chunk(struct cs_text *out, const char *kind, const void *bytes, size_t n) {
    uint32_t crc = 0xffffffff;
    add_number(out, (uint32_t)n);
    const size_t from = out->length;
    cs_text_add(out, "%s", kind);
    cs_text_add_bytes(out, bytes, n);
    for (size_t i = from; i < out->length; i++) {
        crc ^= (uint8_t)out->bytes[i];
        for (int k = 0; k < 8; k++)
            crc = crc & 1 ? 0xedb88320 ^ crc >> 1 : crc >> 1;
    }
    add_number(out, ~crc);
}

/* The chunks of the input between those of a picture of one grey pixel; *n_texts: of tEXt. */
static void make_picture(const uint8_t *bytes, size_t length, struct cs_text *out,
                         uint32_t *n_texts) {
    static const uint8_t head[] = {0, 0, 0, 1, 0, 0, 0, 1, 8, 0, 0, 0, 0};
    static const uint8_t pixel[] = {0x78, 0xda, 0x63, 0x60, 0, 0, 0, 2, 0, 1};
    cs_text_add_bytes(out, "\x89PNG\r\n\x1a\n", 8);
    add_chunk(out, "IHDR", head, sizeof head);
    for (size_t at = 0, n; at + 3 <= length; at += n + 3) {
        n = (size_t)bytes[at + 1] << 8 | bytes[at + 2];
        n = n < length - at - 3 ? n : length - at - 3;
        add_chunk(out, kinds[bytes[at] % KINDS], bytes + at + 3, n);
        *n_texts += bytes[at] % KINDS == 0;
    }
    add_chunk(out, "IDAT", pixel, sizeof pixel);
    add_chunk(out, "IEND", NULL, 0);
}

static void read_provenance(const char *text) {
    struct cs_provenance provenance = {0};
    struct cs_error error = {0};
    const enum cs_status status =
        cs_provenance_read_text(&provenance, "fuzz.png", text, &error);
    CS_ASSERT(status == error.status);
    CS_ASSERT(status ? status == CS_ERR_FILE && strstr(error.message, "fuzz.png")
                     : *provenance.scene_file != 0);
    cs_provenance_finish(&provenance);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t length) {
    struct cs_text picture = {0};
    struct cs_image image;
    struct cs_error error = {0};
    uint32_t n_texts = 0;
    char *values[KEYS];
    double frame;
    make_picture(bytes, length, &picture, &n_texts);
    const char *path = fuzz_write("fuzz.png", cs_text_get(&picture), picture.length);
    const enum cs_status status = cs_png_read_texts(path, keys, KEYS, values, &image, &error);
    CS_ASSERT(status == error.status);
    /* a damaged text is no reason to refuse the pixels */
    CS_ASSERT(!status && image.width == 1 && image.rgb);
    for (int k = 0; k < KEYS; k++)
        CS_ASSERT(!values[k] || n_texts);
    if (values[0])
        cs_parse_real(values[0], &frame);
    if (values[KEYS - 1])
        read_provenance(values[KEYS - 1]);
    for (int k = 0; k < KEYS; k++)
        free(values[k]);
    free(image.rgb);
    cs_text_finish(&picture);
    return 0;
}
