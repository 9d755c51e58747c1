/* Memory by lifetime: aligned, zeroed, apart from each other, and counted. */
#include "base/arena.h"
#include "unit.h"

#include <stdbool.h>
#include <stdint.h>

static bool is_zero(const unsigned char *bytes, size_t n) {
    for (size_t i = 0; i < n; i++)
        if (bytes[i])
            return false;
    return true;
}

/* sizes round the alignment and round a block, each filled with its own number */
TEST(pieces_are_aligned_zeroed_and_apart) {
    static const size_t sizes[] = {1,     63,    64,    65,    0,       1000, 65536 - 64,
                                   65536, 65537, 40000, 40000, 1000000, 64,   3};
    enum { N = sizeof sizes / sizeof *sizes };
    struct cs_arena arena = {0};
    struct cs_error error = {0};
    unsigned char *pieces[N];
    size_t sum = 0;
    for (size_t k = 0; k < N; k++) {
        pieces[k] = cs_arena_alloc(&arena, sizes[k], &error);
        ck_assert_ptr_nonnull(pieces[k]);
        ck_assert_uint_eq((uintptr_t)pieces[k] % 64, 0);
        ck_assert(is_zero(pieces[k], sizes[k]));
        memset(pieces[k], (int)k + 1, sizes[k]);
        sum += sizes[k];
    }
    for (size_t k = 0; k < N; k++)
        for (size_t i = 0; i < sizes[k]; i++)
            UNIT_ASSERT_OFTEN(pieces[k][i] == k + 1);
    ck_assert_uint_eq(arena.used, sum);
    UNIT_ASSERT_OK(&error);
    cs_arena_finish(&arena);
}

/* the same takes, part by part; what was refused is in none */
TEST(parts_are_counted) {
    struct cs_arena arena = {0};
    struct cs_error error = {0};
    size_t parts[2] = {0, 5};
    cs_arena_alloc(&arena, 10, &error);
    arena.part = parts;
    cs_arena_alloc(&arena, 20, &error);
    cs_arena_alloc(&arena, SIZE_MAX, &error);
    arena.part = parts + 1;
    cs_arena_alloc_array(&arena, 10, 3, &error);
    ck_assert_uint_eq(parts[0], 20);
    ck_assert_uint_eq(parts[1], 35);
    ck_assert_uint_eq(arena.used, 60);
    cs_arena_finish(&arena);
    ck_assert_ptr_null(arena.part);
}

/* and the arena can be used again; what it gives is zeroed again */
TEST(finish_empties) {
    struct cs_arena arena = {0};
    struct cs_error error = {0};
    for (int round = 0; round < 3; round++) {
        unsigned char *bytes = cs_arena_alloc(&arena, 200000, &error);
        ck_assert(is_zero(bytes, 200000));
        memset(bytes, 0xff, 200000);
        cs_arena_finish(&arena);
        ck_assert_uint_eq(arena.used, 0);
        ck_assert_ptr_null(arena.blocks);
    }
    cs_arena_finish(&arena);
}

/* a sanitizer would stop the program instead of refusing */
const char *__asan_default_options(void);
const char *__asan_default_options(void) {
    return "allocator_may_return_null=1";
}

/* no sum of sizes wraps round to a small piece; the first message stays */
TEST(impossible_sizes_are_refused) {
    static const size_t sizes[][2] = {{SIZE_MAX, 1},
                                      {SIZE_MAX - 63, 1},
                                      {SIZE_MAX / 2, 1},
                                      {SIZE_MAX / 8 + 1, 8},
                                      {SIZE_MAX, SIZE_MAX}};
    for (size_t k = 0; k < sizeof sizes / sizeof *sizes; k++) {
        struct cs_arena arena = {0};
        struct cs_error error = {0};
        ck_assert_ptr_nonnull(cs_arena_alloc(&arena, 8, &error));
        ck_assert_ptr_null(cs_arena_alloc_array(&arena, sizes[k][0], sizes[k][1], &error));
        UNIT_ASSERT_FAILED(&error, CS_ERR_MEMORY, "out of memory");
        ck_assert_uint_eq(arena.used, 8);
        // what it held is still there, and it goes on
        struct cs_error later = {0};
        ck_assert_ptr_nonnull(cs_arena_alloc(&arena, 8, &later));
        UNIT_ASSERT_OK(&later);
        cs_arena_finish(&arena);
    }
}

TEST(text_is_copied) {
    struct cs_arena arena = {0};
    struct cs_error error = {0};
    char text[] = "particle";
    char *copy = cs_arena_copy_text(&arena, text, &error);
    text[0] = 'x';
    ck_assert_str_eq(copy, "particle");
    ck_assert_str_eq(cs_arena_copy_text(&arena, "", &error), "");
    cs_arena_finish(&arena);
}

static void write_text(const char *path, const char *text) {
    FILE *file = fopen(path, "w");
    ck_assert_ptr_nonnull(file);
    fputs(text, file);
    fclose(file);
}

/* a machine made of files: the least limit counts, and is named */
TEST(memory_left_is_the_least_that_is_known) {
    static const char *const folders[] = {
        "m",        "m/proc",          "m/proc/self",       "m/sys",
        "m/sys/fs", "m/sys/fs/cgroup", "m/sys/fs/cgroup/a", "m/sys/fs/cgroup/a/b"};
    const char *limit = "";
    ck_assert(cs_memory_left("m", &limit) > 1e30);
    for (size_t k = 0; k < sizeof folders / sizeof *folders; k++)
        ck_assert_int_eq(mkdir(folders[k], 0755), 0);
    write_text("m/proc/meminfo",
               "MemTotal: 9000 kB\nMemAvailable: 2000 kB\nSwapFree: 500 kB\n");
    ck_assert_double_eq(cs_memory_left("m", &limit), 2500 * 1024);
    ck_assert_str_eq(limit, "the free memory of the machine");
    // a group without a limit below one with: what it uses but can drop counts as free
    write_text("m/proc/self/cgroup", "3:cpu:/a\n0::/a/b\n");
    write_text("m/sys/fs/cgroup/a/b/memory.max", "max\n");
    write_text("m/sys/fs/cgroup/a/b/memory.current", "1000\n");
    ck_assert_double_eq(cs_memory_left("m", &limit), 2500 * 1024);
    write_text("m/sys/fs/cgroup/a/memory.max", "1000000\n");
    write_text("m/sys/fs/cgroup/a/memory.current", "400000\n");
    write_text("m/sys/fs/cgroup/a/memory.stat", "anon 7\ninactive_file 1000\n");
    ck_assert_double_eq(cs_memory_left("m", &limit), 601000);
    ck_assert_str_eq(limit, "the memory limit of the control group");
    // one that is used up
    write_text("m/sys/fs/cgroup/a/b/memory.max", "900\n");
    ck_assert_double_eq(cs_memory_left("m", &limit), 0);
    // the first version
    ck_assert_int_eq(mkdir("m/sys/fs/cgroup/memory", 0755), 0);
    write_text("m/proc/self/cgroup", "7:cpu,memory:/elsewhere\n");
    write_text("m/sys/fs/cgroup/memory/memory.limit_in_bytes", "5000\n");
    write_text("m/sys/fs/cgroup/memory/memory.usage_in_bytes", "1000\n");
    ck_assert_double_eq(cs_memory_left("m", &limit), 4000);
}
