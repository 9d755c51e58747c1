/* A worker thread that does one piece of work at a time. */
#include "base/hand.h"

#include "base/thread.h"

#include <pthread.h>
#include <stdbool.h>
#include <stdlib.h>

struct cs_hand {
    pthread_t thread;
    pthread_mutex_t lock; /* for what follows */
    pthread_cond_t changed;
    void (*work)(void *argument); /* NULL: nothing to do */
    void *argument;
    bool closing;
};

static void *live(void *object) {
    struct cs_hand *hand = object;
    pthread_mutex_lock(&hand->lock);
    for (;;) {
        while (!hand->work && !hand->closing)
            pthread_cond_wait(&hand->changed, &hand->lock);
        if (!hand->work)
            break;
        pthread_mutex_unlock(&hand->lock);
        hand->work(hand->argument);
        pthread_mutex_lock(&hand->lock);
        hand->work = NULL;
        pthread_cond_broadcast(&hand->changed);
    }
    pthread_mutex_unlock(&hand->lock);
    return NULL;
}

struct cs_hand *cs_hand_create(void) {
    struct cs_hand *hand = calloc(1, sizeof *hand);
    if (!hand)
        return NULL;
    pthread_mutex_init(&hand->lock, NULL);
    pthread_cond_init(&hand->changed, NULL);
    if (!cs_thread_start(&hand->thread, live, hand))
        return hand;
    free(hand);
    return NULL;
}

/* called and left with the lock held */
static void wait_for_work(struct cs_hand *hand) {
    while (hand->work)
        pthread_cond_wait(&hand->changed, &hand->lock);
}

void cs_hand_give(struct cs_hand *hand, void (*work)(void *argument), void *argument) {
    CS_ASSERT(work);
    if (!hand) {
        work(argument);
        return;
    }
    pthread_mutex_lock(&hand->lock);
    wait_for_work(hand);
    hand->work = work;
    hand->argument = argument;
    pthread_cond_broadcast(&hand->changed);
    pthread_mutex_unlock(&hand->lock);
}

void cs_hand_wait(struct cs_hand *hand) {
    if (!hand)
        return;
    pthread_mutex_lock(&hand->lock);
    wait_for_work(hand);
    pthread_mutex_unlock(&hand->lock);
}

void cs_hand_destroy(struct cs_hand *hand) {
    if (!hand)
        return;
    pthread_mutex_lock(&hand->lock);
    wait_for_work(hand);
    hand->closing = true;
    pthread_cond_broadcast(&hand->changed);
    pthread_mutex_unlock(&hand->lock);
    pthread_join(hand->thread, NULL);
    pthread_cond_destroy(&hand->changed);
    pthread_mutex_destroy(&hand->lock);
    free(hand);
}
