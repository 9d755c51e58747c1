/* The pool: every block once, whatever the number of blocks and threads, loops within loops,
 * starts and stops, and children. */
#include "base/pool.h"
#include "unit.h"

#include <pthread.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <sys/wait.h>

enum { MOST = 5000 };
static const uint32_t sizes[] = {0, 1, 2, 3, 4, 7, 16, 63, 1000, MOST};
static const uint32_t threads[] = {1, 2, 3, 4, 7, CS_POOL_THREADS_MAX};

struct tally {
    atomic_uint times[MOST];
    uint32_t order[MOST], n; /* of one thread */
    pthread_t main;
};

static void start(uint32_t n) {
    struct cs_error error = {0};
    cs_pool_start(n, &error);
    UNIT_ASSERT_OK(&error);
    ck_assert_uint_eq(cs_pool_threads(), n);
}

static void count(void *arg, uint32_t block) {
    struct tally *stats = arg;
    stats->times[block]++;
}

TEST(every_block_is_done_once) {
    static struct tally stats;
    for (size_t t = 0; t < sizeof threads / sizeof *threads; t++) {
        start(threads[t]);
        for (size_t s = 0; s < sizeof sizes / sizeof *sizes; s++)
            for (int again = 0; again < 5; again++) {
                memset(&stats, 0, sizeof stats);
                cs_pool_run(sizes[s], count, &stats);
                for (uint32_t b = 0; b < MOST; b++)
                    UNIT_ASSERT_OFTEN(stats.times[b] == (b < sizes[s]));
            }
    }
    cs_pool_stop();
}

static void note_order(void *arg, uint32_t block) {
    struct tally *stats = arg;
    UNIT_ASSERT_OFTEN(pthread_equal(pthread_self(), stats->main));
    stats->order[stats->n++] = block;
}

static void check_order(uint32_t blocks) {
    static struct tally stats;
    stats.n = 0;
    stats.main = pthread_self();
    cs_pool_run(blocks, note_order, &stats);
    ck_assert_uint_eq(stats.n, blocks);
    for (uint32_t b = 0; b < blocks; b++)
        ck_assert_uint_eq(stats.order[b], b);
}

TEST(one_thread_goes_in_order) {
    check_order(100); /* without a pool */
    start(1);
    check_order(100);
    start(4);
    check_order(1); /* a single block is the caller's own */
    cs_pool_stop();
    check_order(100);
    cs_pool_stop();
    ck_assert_uint_eq(cs_pool_threads(), 1);
}

static void run_inner(void *arg, uint32_t block) {
    (void)block;
    cs_pool_run(50, count, arg);
}

TEST(a_loop_within_a_loop_is_the_threads_own) {
    static struct tally stats;
    start(3);
    cs_pool_run(40, run_inner, &stats);
    for (uint32_t b = 0; b < 50; b++)
        ck_assert_uint_eq(stats.times[b], 40);
    cs_pool_stop();
}

/* two threads that are not of the pool ask at once: both loops are whole */
static void *ask_often(void *arg) {
    for (int k = 0; k < 500; k++)
        cs_pool_run(64, count, arg);
    return NULL;
}

TEST(two_callers_do_not_disturb_each_other) {
    static struct tally here, there;
    pthread_t other;
    start(3);
    ck_assert(!pthread_create(&other, NULL, ask_often, &there));
    ask_often(&here);
    pthread_join(other, NULL);
    cs_pool_stop();
    for (uint32_t b = 0; b < 64; b++) {
        ck_assert_uint_eq(here.times[b], 500);
        ck_assert_uint_eq(there.times[b], 500);
    }
}

/* each loop reads what others wrote in the one before, without an atomic word */
enum { ROUNDS = 2000, CELLS = 64 };
static uint32_t cells[2][CELLS];
static void pass_on(void *arg, uint32_t block) {
    const uint32_t round = *(const uint32_t *)arg;
    cells[(round + 1) % 2][block] = cells[round % 2][(block + 1) % CELLS] + 1;
}

TEST(a_loop_sees_what_the_last_one_wrote) {
    start(4);
    for (uint32_t round = 0; round < ROUNDS; round++)
        cs_pool_run(CELLS, pass_on, &round);
    for (uint32_t c = 0; c < CELLS; c++)
        ck_assert_uint_eq(cells[ROUNDS % 2][c], ROUNDS);
    cs_pool_stop();
}

TEST(starts_and_stops_repeatedly) {
    static struct tally stats;
    for (int k = 0; k < 100; k++) {
        start(1 + (uint32_t)k % 5);
        cs_pool_run(10, count, &stats);
        if (k % 2)
            cs_pool_stop();
    }
    cs_pool_stop();
    for (uint32_t b = 0; b < 10; b++)
        ck_assert_uint_eq(stats.times[b], 100);
}

/* Under the address sanitizer this case is left out: a thread of the parent may hold a lock of
 * the sanitizer's allocator while the process forks. Nobody opens that lock in the child, which
 * hangs as soon as it starts a thread. */
#ifdef __SANITIZE_ADDRESS__
#define FORKS 0
#elif defined(__has_feature)
#define FORKS !__has_feature(address_sanitizer)
#else
#define FORKS 1
#endif

#if FORKS
/* a child has one thread and may start its own; the parent's go on */
TEST(a_child_has_no_pool) {
    static struct tally stats;
    int end = 1;
    start(4);
    cs_pool_run(1000, count, &stats);
    const pid_t child = fork();
    if (!child) {
        struct cs_error error = {0};
        const uint32_t before = cs_pool_threads();
        cs_pool_run(1000, count, &stats);
        cs_pool_start(3, &error);
        cs_pool_run(1000, count, &stats);
        const bool good = before == 1 && cs_pool_threads() == 3 && stats.times[999] == 3;
        cs_pool_stop();
        _exit(good ? 0 : 1);
    }
    ck_assert_int_eq(waitpid(child, &end, 0), child);
    ck_assert_int_eq(end, 0);
    cs_pool_run(1000, count, &stats);
    ck_assert_uint_eq(stats.times[999], 2);
    cs_pool_stop();
}
#endif

/* a thread of the pool never takes a signal */
static pthread_t taker;
static volatile sig_atomic_t taken;
static void take_signal(int number) {
    (void)number;
    taker = pthread_self();
    taken = 1;
}

static void send_signal(void *arg, uint32_t block) {
    (void)arg;
    if (block == 40)
        kill(getpid(), SIGUSR1);
}

TEST(signals_are_the_callers) {
    signal(SIGUSR1, take_signal);
    start(4);
    for (int k = 0; k < 100; k++) {
        taken = 0;
        cs_pool_run(64, send_signal, NULL);
        while (!taken)
            usleep(100);
        ck_assert(pthread_equal(taker, pthread_self()));
    }
    cs_pool_stop();
}
