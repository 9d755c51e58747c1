/* State files hold what NumPy expects, byte for byte. */
#include "base/file.h"
#include "export/npy.h"
#include "unit.h"

#include <signal.h>
#include <sys/resource.h>

static char *read_all(const char *path, size_t expected) {
    struct cs_error error = {0};
    char *bytes;
    size_t length;
    cs_file_read(path, 1 << 20, &bytes, &length, &error);
    UNIT_ASSERT_OK(&error);
    ck_assert_uint_eq(length, expected);
    return bytes;
}

/* Format 1.0: magic, version, little-endian length of the header's rest, and that rest ends in
 * a newline at a multiple of 64. */
TEST(header_is_format_1_0) {
    struct cs_error error = {0};
    const double a[6] = {0};
    cs_npy_write("h.npy", a, 2, &error);
    UNIT_ASSERT_OK(&error);
    char *bytes = read_all("h.npy", 128 + 48);
    static const char start[] = "\x93NUMPY\x01\x00\x76\x00{'descr': '<f8', "
                                "'fortran_order': False, 'shape': (2, 3), } ";
    ck_assert_mem_eq(bytes, start, sizeof start - 1);
    for (size_t i = sizeof start - 1; i < 127; i++)
        ck_assert_int_eq(bytes[i], ' ');
    ck_assert_int_eq(bytes[127], '\n');
    free(bytes);
}

/* component-major in memory, one row a particle in the file, little-endian */
TEST(rows_are_particles) {
    struct cs_error error = {0};
    const double a[6] = {1, 2, /* x */ 3, 4, /* y */ -0.5, 1e300 /* z */};
    static const unsigned char rows[2][3][8] = {
        {{0, 0, 0, 0, 0, 0, 0xf0, 0x3f},
         {0, 0, 0, 0, 0, 0, 8, 0x40},
         {0, 0, 0, 0, 0, 0, 0xe0, 0xbf}},
        {{0, 0, 0, 0, 0, 0, 0, 0x40},
         {0, 0, 0, 0, 0, 0, 0x10, 0x40},
         {0x9c, 0x75, 0x00, 0x88, 0x3c, 0xe4, 0x37, 0x7e}}};
    cs_npy_write("r.npy", a, 2, &error);
    UNIT_ASSERT_OK(&error);
    char *bytes = read_all("r.npy", 128 + 48);
    ck_assert_mem_eq(bytes + 128, rows, sizeof rows);
    free(bytes);
}

/* sizes round the blocks in which rows are written */
TEST(every_particle_arrives) {
    static const uint32_t counts[] = {0, 1, 511, 512, 513, 1024, 1500};
    for (size_t k = 0; k < sizeof counts / sizeof *counts; k++) {
        struct cs_error error = {0};
        const uint32_t n = counts[k];
        double *a = malloc((3 * n + 1) * sizeof *a);
        for (uint32_t i = 0; i < 3 * n; i++)
            a[i] = i;
        cs_npy_write("n.npy", a, n, &error);
        UNIT_ASSERT_OK(&error);
        char *bytes = read_all("n.npy", 128 + 24 * (size_t)n);
        for (uint32_t i = 0; i < n; i++)
            for (uint32_t c = 0; c < 3; c++) {
                uint64_t word = 0, expected;
                for (int b = 7; b >= 0; b--)
                    word = word << 8 | (unsigned char)bytes[128 + 24 * i + 8 * c + (uint32_t)b];
                memcpy(&expected, a + c * n + i, 8);
                ck_assert_uint_eq(word, expected);
            }
        free(bytes);
        free(a);
    }
}

TEST(failure_leaves_no_file) {
    struct cs_error missing = {0}, limited = {0};
    double *a = calloc(3000, sizeof *a);
    cs_npy_write("none/x.npy", a, 10, &missing);
    UNIT_ASSERT_FAILED(&missing, CS_ERR_FILE, "none/x.npy");

    signal(SIGXFSZ, SIG_IGN);
    ck_assert_int_eq(mkdir("small", 0777), 0);
    ck_assert_int_eq(setrlimit(RLIMIT_FSIZE, &(struct rlimit){5000, 5000}), 0);
    cs_npy_write("small/x.npy", a, 1000, &limited);
    UNIT_ASSERT_FAILED(&limited, CS_ERR_FILE, "File too large");
    ck_assert_int_eq(unit_count_files("small"), 0);
    free(a);
}
