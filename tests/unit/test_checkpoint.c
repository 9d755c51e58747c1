/* A checkpoint gives back what was recorded, and no damaged or foreign one is taken. */
#include "base/file.h"
#include "cli/run/checkpoint.h"
#include "unit.h"

static const struct cs_checkpoint_key keys[] = {{"scene", "{\n  \"dt\": 0.001,\n  \"n\": 3\n}"},
                                                {"method", "rk4:dt=0.001"}};
enum { FACTS = sizeof keys / sizeof *keys };

struct memory {
    double x[3];
    unsigned count;
};

static void record_memory(struct memory *memory, struct cs_serialiser *serialiser) {
    CS_SERIALISER(serialiser, memory->x);
    CS_SERIALISER(serialiser, memory->count);
}

static void write_one(void) {
    struct cs_error error = {0};
    struct cs_serialiser serialiser = {0};
    struct memory memory = {{0.1, -0.0, 1e300}, 7};
    record_memory(&memory, &serialiser);
    cs_checkpoint_write("c", keys, FACTS, &serialiser, "a.json\n-n\n3\n", &error);
    UNIT_ASSERT_OK(&error);
    cs_serialiser_finish(&serialiser);
}

static void expect_refusal(const struct cs_checkpoint_key *expected, uint32_t n,
                           const char *part) {
    struct cs_error error = {0};
    struct cs_serialiser serialiser;
    cs_checkpoint_read("c", expected, n, &serialiser, &error);
    UNIT_ASSERT_FAILED(&error, CS_ERR_FILE, part);
    cs_serialiser_finish(&serialiser);
}

TEST(it_comes_back) {
    struct cs_error error = {0};
    struct cs_serialiser serialiser;
    struct memory memory = {0};
    const double expected[3] = {0.1, -0.0, 1e300};
    write_one();
    cs_checkpoint_read("c", keys, FACTS, &serialiser, &error);
    UNIT_ASSERT_OK(&error);
    record_memory(&memory, &serialiser);
    ck_assert(cs_serialiser_is_done(&serialiser));
    ck_assert_mem_eq(memory.x, expected, sizeof expected);
    ck_assert_uint_eq(memory.count, 7);
    ck_assert_int_eq(unit_count_files("."), 1);
    // more is asked for than there is: said, and nothing is written
    CS_SERIALISER(&serialiser, memory.count);
    ck_assert(serialiser.failed && memory.count == 7);
    cs_serialiser_finish(&serialiser);
}

TEST(what_differs_is_told) {
    struct cs_checkpoint_key others[FACTS] = {keys[0], keys[1]};
    write_one();
    others[0].value = "{\n  \"dt\": 0.002,\n  \"n\": 3\n}";
    expect_refusal(
        others, FACTS,
        "\"c\" was written for a different scene: found \"dt\": 0.001, expected \"dt\": 0.002");
    others[0].value = keys[0].value;
    others[1].value = "rk4:dt=0.001,more";
    expect_refusal(others, FACTS,
                   "different method: found rk4:dt=0.001, expected rk4:dt=0.001,more");
    others[1] = (struct cs_checkpoint_key){"plugin", ""};
    expect_refusal(others, FACTS, "does not state the plugin");
    expect_refusal(keys, 1, "it contains no record");
}

/* every byte turned, in each of its bits, and every length but the whole */
TEST(damage_is_noticed) {
    struct cs_error error = {0};
    char *bytes;
    size_t length;
    write_one();
    cs_file_read("c", 1 << 16, &bytes, &length, &error);
    UNIT_ASSERT_OK(&error);
    for (size_t i = 0; i < length; i++) {
        const char turned = (char)(1 << i % 8);
        bytes[i] ^= turned;
        cs_file_write("c", bytes, length, &error);
        expect_refusal(keys, FACTS, "\"c\": it is ");
        bytes[i] ^= turned;
        cs_file_write("c", bytes, i, &error);
        expect_refusal(keys, FACTS, "\"c\": it is ");
    }
    UNIT_ASSERT_OK(&error);
    free(bytes);
}

TEST(the_command_line_is_read_by_itself) {
    struct cs_error error = {0}, none = {0};
    struct cs_serialiser serialiser = {0};
    struct cs_text command = {0};
    write_one();
    cs_checkpoint_read_command("c", &command, &error);
    UNIT_ASSERT_OK(&error);
    ck_assert_str_eq(cs_text_get(&command), "a.json\n-n\n3\n");
    cs_text_finish(&command);
    cs_checkpoint_write("c", keys, FACTS, &serialiser, "", &error);
    cs_checkpoint_read_command("c", &command, &none);
    UNIT_ASSERT_FAILED(&none, CS_ERR_FILE, "\"c\": it contains no command line");
    cs_text_finish(&command);
}
