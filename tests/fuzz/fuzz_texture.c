/* Any bytes as a texture: an image or a refusal. Once as they are, and once with the checksums
 * of the chunks put right, since else hardly any damage gets behind them. */
#include "base/png.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t length);

static uint32_t read_number(const uint8_t *at) {
    return (uint32_t)at[0] << 24 | (uint32_t)at[1] << 16 | (uint32_t)at[2] << 8 | at[3];
}

static uint32_t crc_of(const uint8_t *bytes, size_t n) {
    uint32_t crc = 0xffffffff;
    for (size_t i = 0; i < n; i++) {
        crc ^= bytes[i];
        for (int k = 0; k < 8; k++)
            crc = crc & 1 ? 0xedb88320 ^ crc >> 1 : crc >> 1;
    }
    return ~crc;
}

static void repair_checksums(uint8_t *bytes, size_t length) {
    for (size_t at = 8; at + 12 <= length;) {
        const size_t size = read_number(bytes + at);
        if (size > length - at - 12)
            return;
        const uint32_t crc = crc_of(bytes + at + 4, size + 4);
        for (int b = 0; b < 4; b++)
            bytes[at + 8 + size + (size_t)b] = (uint8_t)(crc >> (24 - 8 * b));
        at += size + 12;
    }
}

static void read_image(const uint8_t *bytes, size_t length) {
    struct cs_image image;
    struct cs_error error = {0};
    const enum cs_status status = cs_png_read_bytes("fuzz.png", bytes, length, &image, &error);
    CS_ASSERT(status == error.status);
    CS_ASSERT(status ? !image.rgb : image.rgb != NULL);
    /* every pixel belongs to the image */
    volatile uint8_t sum = 0;
    for (size_t i = 0; !status && i < 3 * (size_t)image.width * image.height; i++)
        sum = (uint8_t)(sum + image.rgb[i]);
    free(image.rgb);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t length) {
    uint8_t *copy = malloc(length ? length : 1);
    if (!copy)
        return 0;
    memcpy(copy, bytes, length);
    repair_checksums(copy, length);
    read_image(bytes, length);
    read_image(copy, length);
    free(copy);
    return 0;
}
