/* A hand works beside its owner, in order, and without one the owner works. */
#include "base/worker_thread.h"
#include "unit.h"

#include <pthread.h>
#include <signal.h>
#include <stdbool.h>
#include <time.h>

struct diary {
    int entries[20], n;
    pthread_t thread;
    bool blocked; /* SIGINT is, on the thread that wrote */
};

struct page {
    struct diary *diary;
    int entry;
};

static void write_slowly(void *argument) {
    const struct page *page = argument;
    struct diary *diary = page->diary;
    sigset_t mask;
    nanosleep(&(struct timespec){.tv_nsec = 1000000}, NULL);
    pthread_sigmask(SIG_SETMASK, NULL, &mask);
    diary->entries[diary->n++] = page->entry;
    diary->thread = pthread_self();
    diary->blocked = sigismember(&mask, SIGINT);
}

static void give_all(struct cs_worker_thread *worker, struct diary *diary,
                     struct page pages[20]) {
    for (int k = 0; k < 20; k++) {
        pages[k] = (struct page){diary, k};
        cs_worker_thread_submit(worker, write_slowly, pages + k);
    }
}

static void assert_written(const struct diary *diary) {
    ck_assert_int_eq(diary->n, 20);
    for (int k = 0; k < 20; k++)
        ck_assert_int_eq(diary->entries[k], k);
}

TEST(work_is_done_in_order_on_another_thread) {
    struct diary diary = {0};
    struct page pages[20];
    struct cs_worker_thread *worker = cs_worker_thread_create();
    ck_assert_ptr_nonnull(worker);
    give_all(worker, &diary, pages);
    cs_worker_thread_wait(worker);
    assert_written(&diary);
    ck_assert(!pthread_equal(diary.thread, pthread_self()));
    ck_assert(diary.blocked);
    cs_worker_thread_destroy(worker);
}

TEST(without_a_hand_work_is_done_at_once) {
    struct diary diary = {0};
    struct page pages[20];
    give_all(NULL, &diary, pages);
    assert_written(&diary);
    ck_assert(pthread_equal(diary.thread, pthread_self()));
    cs_worker_thread_wait(NULL);
    cs_worker_thread_destroy(NULL);
}

TEST(destroy_waits_for_what_was_given) {
    struct diary diary = {0};
    struct page pages[20];
    struct cs_worker_thread *worker = cs_worker_thread_create();
    give_all(worker, &diary, pages);
    cs_worker_thread_destroy(worker);
    assert_written(&diary);
}
