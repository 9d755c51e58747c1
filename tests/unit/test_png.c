/* Pictures come back as they were, carry their origin, and bad ones are refused. */
#include "base/file.h"
#include "base/png.h"
#include "unit.h"

#include <signal.h>
#include <sys/resource.h>

static struct cs_image make_picture(uint32_t width, uint32_t height) {
    struct cs_image image = {width, height, malloc(3 * (size_t)width * height), NULL};
    ck_assert_ptr_nonnull(image.rgb);
    for (uint32_t i = 0; i < 3 * width * height; i++)
        image.rgb[i] = (uint8_t)(i * i / 7 + i);
    return image;
}

static void read_file(const char *path, unsigned char **bytes, size_t *length) {
    struct cs_error error = {0};
    cs_file_read(path, 1 << 20, (char **)bytes, length, &error);
    UNIT_ASSERT_OK(&error);
}

TEST(pixels_come_back) {
    static const uint32_t sizes[][2] = {{1, 1}, {7, 3}, {64, 48}, {1, 300}};
    for (size_t k = 0; k < sizeof sizes / sizeof *sizes; k++)
        for (int level = 0; level <= 9; level += 3) {
            struct cs_error error = {0};
            struct cs_image image = make_picture(sizes[k][0], sizes[k][1]), back;
            cs_png_write("p.png", &image, level, NULL, 0, &error);
            cs_png_read("p.png", &back, &error);
            UNIT_ASSERT_OK(&error);
            ck_assert_uint_eq(back.width, image.width);
            ck_assert_uint_eq(back.height, image.height);
            ck_assert_mem_eq(back.rgb, image.rgb, 3 * (size_t)image.width * image.height);
            free(image.rgb);
            free(back.rgb);
        }
}

/* the payload of the number-th chunk of a kind, NULL if there are fewer */
static const unsigned char *find_chunk(const unsigned char *bytes, size_t length,
                                       const char *kind, int number, uint32_t *size) {
    for (size_t at = 8; at + 12 <= length; at += *size + 12) {
        const unsigned char *c = bytes + at;
        *size = (uint32_t)c[0] << 24 | (uint32_t)c[1] << 16 | (uint32_t)c[2] << 8 | c[3];
        if (!memcmp(c + 4, kind, 4) && number-- == 0)
            return c + 8;
    }
    return NULL;
}

TEST(texts_are_in_the_file_and_no_time) {
    struct cs_error error = {0};
    struct cs_image image = make_picture(20, 10);
    const struct cs_png_text texts[] = {
        {"Software", "clothsim"}, {"state-hash", "00ff"}, {"e", ""}};
    cs_png_write("t.png", &image, 1, texts, 3, &error);
    UNIT_ASSERT_OK(&error);
    unsigned char *bytes;
    size_t length;
    uint32_t size;
    read_file("t.png", &bytes, &length);
    ck_assert_mem_eq(find_chunk(bytes, length, "tEXt", 0, &size), "Software\0clothsim", 17);
    ck_assert_uint_eq(size, 17);
    ck_assert_mem_eq(find_chunk(bytes, length, "tEXt", 1, &size),
                     "state-hash\0"
                     "00ff",
                     15);
    ck_assert_mem_eq(find_chunk(bytes, length, "tEXt", 2, &size), "e\0", 2);
    ck_assert_ptr_null(find_chunk(bytes, length, "tEXt", 3, &size));
    ck_assert_ptr_null(find_chunk(bytes, length, "tIME", 0, &size));
    /* 8 bits, RGB, not interlaced */
    ck_assert_mem_eq(find_chunk(bytes, length, "IHDR", 0, &size) + 8, "\x08\x02\0\0\0", 5);
    free(bytes);
    free(image.rgb);
}

TEST(texts_come_back) {
    static const char *const keys[] = {"state-hash", "none", "e"};
    struct cs_error error = {0};
    struct cs_image image = make_picture(20, 10), back;
    const struct cs_png_text texts[] = {
        {"Software", "clothsim"}, {"state-hash", "00ff"}, {"e", ""}};
    char *values[3];
    cs_png_write("t.png", &image, 1, texts, 3, &error);
    cs_png_read_texts("t.png", keys, 3, values, &back, &error);
    UNIT_ASSERT_OK(&error);
    ck_assert_str_eq(values[0], "00ff");
    ck_assert_ptr_null(values[1]);
    ck_assert_str_eq(values[2], "");
    ck_assert_mem_eq(back.rgb, image.rgb, cs_image_bytes(&image));
    free(back.rgb);
    free(values[0]);
    free(values[2]);
    free(image.rgb);
}

/* colours stay what they are behind what covers nothing, and the file says that there are four
 * channels */
TEST(pictures_may_have_alpha) {
    struct cs_error error = {0};
    struct cs_image image = make_picture(33, 7), back;
    uint8_t alpha[33 * 7];
    unsigned char *bytes;
    size_t length;
    uint32_t size;
    for (uint32_t i = 0; i < sizeof alpha; i++)
        alpha[i] = (uint8_t)(i * 37);
    image.alpha = alpha;
    cs_png_write("alpha.png", &image, 1, NULL, 0, &error);
    cs_png_read("alpha.png", &back, &error);
    UNIT_ASSERT_OK(&error);
    ck_assert_mem_eq(back.rgb, image.rgb, 3 * sizeof alpha);
    ck_assert_ptr_null(back.alpha);
    free(back.rgb);
    cs_png_read_on_white("alpha.png", &back, &error);
    UNIT_ASSERT_OK(&error);
    for (uint32_t i = 0; i < sizeof alpha; i++)
        for (uint32_t k = 3 * i; k < 3 * i + 3; k++)
            UNIT_ASSERT_OFTEN(alpha[i] == 255 ? back.rgb[k] == image.rgb[k]
                              : alpha[i] == 0 ? back.rgb[k] == 255
                                              : back.rgb[k] >= image.rgb[k]);
    read_file("alpha.png", &bytes, &length);
    ck_assert_mem_eq(find_chunk(bytes, length, "IHDR", 0, &size) + 8, "\x08\x06\0\0\0", 5);
    free(bytes);
    free(image.rgb);
    free(back.rgb);
}

TEST(same_picture_same_bytes) {
    struct cs_error error = {0};
    struct cs_image image = make_picture(50, 40);
    unsigned char *a, *b;
    size_t length_a, length_b;
    cs_png_write("a.png", &image, 1, NULL, 0, &error);
    cs_png_write("b.png", &image, 1, NULL, 0, &error);
    read_file("a.png", &a, &length_a);
    read_file("b.png", &b, &length_b);
    ck_assert_uint_eq(length_a, length_b);
    ck_assert_mem_eq(a, b, length_a);
    free(a);
    free(b);
    free(image.rgb);
}

/* A 2 x 1 picture of each kind of pixel, made by hand: signature, IHDR, PLTE and tRNS where the
 * kind has them, IDAT as a stored deflate block, IEND. */
static uint32_t crc_of(const unsigned char *bytes, size_t n) {
    uint32_t crc = 0xffffffff;
    for (size_t i = 0; i < n; i++) {
        crc ^= bytes[i];
        for (int k = 0; k < 8; k++)
            crc = crc & 1 ? 0xedb88320 ^ crc >> 1 : crc >> 1;
    }
    return ~crc;
}

static void add_number(unsigned char **at, uint32_t number) {
    for (int shift = 24; shift >= 0; shift -= 8)
        *(*at)++ = (unsigned char)(number >> shift);
}

static void add_chunk(unsigned char **at, const char *kind, const void *payload, size_t n) {
    add_number(at, (uint32_t)n);
    unsigned char *start = *at;
    memcpy(start, kind, 4);
    memcpy(start + 4, payload, n);
    *at += n + 4;
    add_number(at, crc_of(start, n + 4));
}

struct kind {
    unsigned char bits, type;
    uint32_t n_palette, n_row;
    unsigned char palette[6], row[16], expected[6], interlaced;
};

static size_t make_png(const struct kind *kind, uint32_t width, uint32_t height,
                       unsigned char *bytes) {
    unsigned char header[13], *at = header, data[64], *end = bytes;
    add_number(&at, width);
    add_number(&at, height);
    const unsigned char tail[5] = {kind->bits, kind->type, 0, 0, kind->interlaced};
    memcpy(at, tail, 5);
    memcpy(end, "\x89PNG\r\n\x1a\n", 8);
    end += 8;
    add_chunk(&end, "IHDR", header, 13);
    if (kind->n_palette)
        add_chunk(&end, "PLTE", kind->palette, 3 * kind->n_palette);

    /* zlib head, one stored block of the filter byte and the row, adler of both */
    const unsigned char n = (unsigned char)(kind->n_row + 1);
    const unsigned char head[8] = {0x78, 1, 1, n, 0, (unsigned char)~n, 0xff, 0};
    uint32_t low = 1, high = 1;
    memcpy(data, head, 8);
    memcpy(data + 8, kind->row, kind->n_row);
    for (uint32_t i = 0; i < kind->n_row; i++) {
        low = (low + kind->row[i]) % 65521;
        high = (high + low) % 65521;
    }
    at = data + 8 + kind->n_row;
    add_number(&at, high << 16 | low);
    add_chunk(&end, "IDAT", data, (size_t)(at - data));
    add_chunk(&end, "IEND", "", 0);
    return (size_t)(end - bytes);
}

TEST(every_kind_becomes_rgb) {
    static const struct kind kinds[] = {
        {8, 2, 0, 6, {0}, {1, 2, 3, 4, 5, 6}, {1, 2, 3, 4, 5, 6}, 0},       /* RGB */
        {8, 6, 0, 8, {0}, {1, 2, 3, 0, 4, 5, 6, 9}, {1, 2, 3, 4, 5, 6}, 0}, /* RGBA */
        {8, 0, 0, 2, {0}, {7, 200}, {7, 7, 7, 200, 200, 200}, 0},           /* grey */
        {8, 4, 0, 4, {0}, {7, 1, 200, 2}, {7, 7, 7, 200, 200, 200}, 0},     /* grey, alpha */
        {1, 0, 0, 1, {0}, {0x40}, {0, 0, 0, 255, 255, 255}, 0},             /* bits */
        {8, 3, 2, 2, {9, 8, 7, 1, 2, 3}, {1, 0}, {1, 2, 3, 9, 8, 7}, 0},    /* palette */
        {16, 0, 0, 4, {0}, {255, 255, 0x80, 0x80}, {255, 255, 255, 128, 128, 128}, 0},
        /* two passes of one pixel, each with its filter byte */
        {8, 2, 0, 7, {0}, {1, 2, 3, 0, 4, 5, 6}, {1, 2, 3, 4, 5, 6}, 1},
    };
    for (size_t k = 0; k < sizeof kinds / sizeof *kinds; k++) {
        struct cs_error error = {0};
        unsigned char bytes[512];
        struct cs_image image;
        cs_png_read_bytes("k", bytes, make_png(kinds + k, 2, 1, bytes), &image, &error);
        UNIT_ASSERT_OK(&error);
        ck_assert_mem_eq(image.rgb, kinds[k].expected, 6);
        free(image.rgb);
    }
}

/* a claim of size that the file cannot hold costs no memory; sides beyond the limit are refused
 */
TEST(huge_claims_are_refused) {
    static const struct kind rgb = {8, 2, 0, 6, {0}, {1, 2, 3, 4, 5, 6}, {0}, 0};
    static const struct {
        uint32_t width, height;
    } sizes[] = {{16384, 16384}, {16385, 1}, {1, 16385}, {0x7fffffff, 0x7fffffff}, {0, 1}};
    for (size_t k = 0; k < sizeof sizes / sizeof *sizes; k++) {
        struct cs_error error = {0};
        unsigned char bytes[512];
        struct cs_image image;
        const size_t length = make_png(&rgb, sizes[k].width, sizes[k].height, bytes);
        cs_png_read_bytes("huge.png", bytes, length, &image, &error);
        UNIT_ASSERT_FAILED(&error, CS_ERR_FILE, "cannot read \"huge.png\" as PNG");
        ck_assert_ptr_null(image.rgb);
    }
}

TEST(truncated_anywhere_is_refused) {
    struct cs_error made = {0};
    struct cs_image image = make_picture(16, 16);
    const struct cs_png_text text = {"Source", "0123"};
    unsigned char *bytes;
    size_t length;
    cs_png_write("c.png", &image, 6, &text, 1, &made);
    read_file("c.png", &bytes, &length);
    for (size_t n = 0; n < length; n++) {
        struct cs_error error = {0};
        struct cs_image back;
        /* a copy of just that length, so that a sanitiser sees a read behind it */
        unsigned char *part = malloc(n + 1);
        memcpy(part, bytes, n);
        ck_assert_int_eq(cs_png_read_bytes("c", part, n, &back, &error), CS_ERR_FILE);
        ck_assert_ptr_null(back.rgb);
        free(part);
    }
    free(bytes);
    free(image.rgb);
}

/* a flipped bit is refused or leaves the pixels alone (in a text), and never crashes */
TEST(flipped_bits_do_not_pass) {
    struct cs_error made = {0};
    struct cs_image image = make_picture(16, 16);
    unsigned char *bytes;
    size_t length;
    cs_png_write("f.png", &image, 6, NULL, 0, &made);
    read_file("f.png", &bytes, &length);
    for (size_t bit = 0; bit < 8 * length; bit++) {
        struct cs_error error = {0};
        struct cs_image back;
        bytes[bit / 8] ^= (unsigned char)(1 << bit % 8);
        if (!cs_png_read_bytes("f", bytes, length, &back, &error))
            ck_assert_mem_eq(back.rgb, image.rgb, 16 * 16 * 3);
        free(back.rgb);
        bytes[bit / 8] ^= (unsigned char)(1 << bit % 8);
    }
    free(bytes);
    free(image.rgb);
}

TEST(failure_leaves_no_file) {
    struct cs_error missing = {0}, limited = {0}, absent = {0}, other = {0};
    struct cs_image image = make_picture(200, 200), none;
    cs_png_write("none/x.png", &image, 1, NULL, 0, &missing);
    UNIT_ASSERT_FAILED(&missing, CS_ERR_FILE, "cannot write \"none/x.png\"");
    cs_png_read("none.png", &none, &absent);
    UNIT_ASSERT_FAILED(&absent, CS_ERR_FILE, "cannot read \"none.png\"");
    cs_png_read_bytes("scene.json", "{\"bodies\": []}", 14, &none, &other);
    UNIT_ASSERT_FAILED(&other, CS_ERR_FILE, "it is not a PNG file");

    signal(SIGXFSZ, SIG_IGN);
    ck_assert_int_eq(mkdir("small", 0777), 0);
    ck_assert_int_eq(setrlimit(RLIMIT_FSIZE, &(struct rlimit){5000, 5000}), 0);
    cs_png_write("small/x.png", &image, 0, NULL, 0, &limited);
    UNIT_ASSERT_FAILED(&limited, CS_ERR_FILE, "cannot write \"small/x.png\": File too large");
    ck_assert_int_eq(unit_count_files("small"), 0);
    free(image.rgb);
}
