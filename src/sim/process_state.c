/* process_state.c - reads and restores the process-wide state around foreign code, and copies
 * the view of the system that it sees. */
#include "sim/process_state.h"

#include "base/install_paths.h"

#include <dlfcn.h>
#include <errno.h>
#include <fenv.h>
#include <locale.h>
#include <poll.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/wait.h>

#if defined(__SSE2__)
#include <xmmintrin.h>
/* MXCSR bits of exceptions that have occurred: ordinary arithmetic sets them. */
enum { STICKY_FLAGS = 0x3f };
static unsigned control_get(void) {
    return _mm_getcsr() & ~(unsigned)STICKY_FLAGS;
}
static void control_set(unsigned control) {
    _mm_setcsr(control);
}
#elif defined(__aarch64__)
static unsigned control_get(void) {
    unsigned long fpcr;
    __asm__ volatile("mrs %0, fpcr" : "=r"(fpcr));
    return (unsigned)fpcr;
}
static void control_set(unsigned control) {
    __asm__ volatile("msr fpcr, %0" : : "r"((unsigned long)control));
}
#else
static unsigned control_get(void) {
    return 0;
}
static void control_set(unsigned control) {
    (void)control;
}
#endif

const char cs_process_state_mode[] = "the floating-point mode";
const int cs_interrupts[CS_INTERRUPTS] = {SIGINT, SIGTERM, SIGHUP, SIGXCPU, SIGUSR1};

/* A bit for each of the streams 0, 1, 2 that is open: poll reports a closed one as POLLNVAL.
 * None if no files are allowed. */
static unsigned open_streams(void) {
    struct pollfd streams[] = {{.fd = 0}, {.fd = 1}, {.fd = 2}};
    enum { STREAMS = sizeof streams / sizeof *streams };
    unsigned open = 0;
    // a signal ends poll even if it need not wait
    while (poll(streams, STREAMS, 0) < 0)
        if (errno != EINTR)
            return 0;
    for (unsigned k = 0; k < STREAMS; k++)
        open |= (unsigned)!(streams[k].revents & POLLNVAL) << k;
    return open;
}

/* True if there is a child process: waitid fails with ECHILD only without any. WNOWAIT leaves
 * it to be waited for by its owner. */
static bool is_parent(void) {
    siginfo_t info;
    return !waitid(P_ALL, 0, &info, WEXITED | WNOHANG | WNOWAIT);
}

struct cs_process_state cs_process_state_save(void) {
    struct cs_process_state state = {.fp_control = control_get(),
                                     .rounding = fegetround(),
                                     .streams = open_streams(),
                                     .has_children = is_parent()};
    struct stat info;
    for (int k = 0; k < CS_INTERRUPTS; k++)
        sigaction(cs_interrupts[k], NULL, state.signals + k);
    if (!stat(".", &info)) {
        state.cwd_device = info.st_dev;
        state.cwd_inode = info.st_ino;
    }
    return state;
}

/* Restores handlers that differ; true if one did. */
static bool restore_signals(const struct cs_process_state *state) {
    bool changed = false;
    for (int k = 0; k < CS_INTERRUPTS; k++) {
        struct sigaction now;
        sigaction(cs_interrupts[k], NULL, &now);
        if (now.sa_handler == state->signals[k].sa_handler)
            continue;
        sigaction(cs_interrupts[k], state->signals + k, NULL);
        changed = true;
    }
    return changed;
}

/* Restores the C locale, in which numbers are read and written with a point; true if it had
 * changed. */
static bool restore_locale(void) {
    if (!strcmp(setlocale(LC_NUMERIC, NULL), "C") && !strcmp(localeconv()->decimal_point, "."))
        return false;
    uselocale(LC_GLOBAL_LOCALE);
    setlocale(LC_ALL, "C");
    return true;
}

/* True if the working folder is another one, or gone. */
static bool has_moved(const struct cs_process_state *state) {
    struct stat info;
    return stat(".", &info) || info.st_dev != state->cwd_device ||
           info.st_ino != state->cwd_inode;
}

/* Restores rounding, traps and flush-to-zero; true if one had changed. */
static bool restore_mode(const struct cs_process_state *state) {
    if (control_get() == state->fp_control && fegetround() == state->rounding)
        return false;
    fesetround(state->rounding);
    control_set(state->fp_control);
    return true;
}

const char *cs_process_state_restore(const struct cs_process_state *state) {
    /* all three are restored, whichever is reported */
    const bool mode = restore_mode(state), signals = restore_signals(state),
               locale = restore_locale();
    return mode                                  ? cs_process_state_mode
           : signals                             ? "a signal handler"
           : locale                              ? "the locale"
           : has_moved(state)                    ? "the working folder"
           : open_streams() != state->streams    ? "the open standard streams"
           : is_parent() && !state->has_children ? "the set of processes"
                                                 : NULL;
}

/* --- the view on read-only pages --- */

enum { ALIGNMENT = 64 };

/* An array of a view. */
struct part {
    size_t offset; /* of its pointer in the view */
    size_t bytes;
    bool changes; /* while a run goes on */
};
enum { PARTS_MAX = 24 };

/* The pointer of a part in a view. */
static char *array_of(const struct cs_view *view, const struct part *part) {
    char *array;
    memcpy(&array, (const char *)view + part->offset, sizeof array);
    return array;
}

/* Lists the arrays that are there. */
static size_t list_parts(const struct cs_view *view, struct part parts[PARTS_MAX]) {
    const size_t n = view->n, springs = view->n_springs, clusters = view->n_clusters;
    const size_t items = clusters ? view->cluster_begin[clusters] : 0;
    const size_t motion = 3 * (size_t)view->n_colliders;
#define PART(name, count, changes)                                                             \
    { offsetof(struct cs_view, name), (count) * sizeof *view->name, changes }
    const struct part all[] = {
        PART(mass, n, false),
        PART(inv_mass, n, true),
        PART(start, 3 * n, false),
        PART(ends, 2 * springs, false),
        PART(length, springs, false),
        PART(stiffness, springs, true),
        PART(damping, springs, true),
        PART(kind, springs, false),
        PART(axial, springs, false),
        PART(cluster_begin, clusters + 1, false),
        PART(cluster_items, items, false),
        PART(cluster_alpha, clusters, true),
        PART(cluster_beta, clusters, true),
        PART(cluster_step, clusters, true),
        PART(collider_origin, motion, true),
        PART(collider_velocity, motion, true),
        PART(collider_spin, motion, true),
        PART(colour_begin, (size_t)view->n_colours + 1, false),
        PART(colour_items, n, false),
        PART(spring_begin, n + 1, false),
        PART(spring_items, 2 * springs, false),
    };
#undef PART
    size_t n_parts = 0;
    // without its need a method has none of some
    for (size_t k = 0; k < sizeof all / sizeof *all; k++)
        if (array_of(view, all + k))
            parts[n_parts++] = all[k];
    return n_parts;
}

static size_t aligned(size_t bytes) {
    return (bytes + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT;
}

bool cs_view_pages_needed(const struct cs_integrator *integrator) {
    static const char in_program[] = "";
    const char *folder = cs_module_folder();
    Dl_info of, own;
    return dladdr(integrator, &of) && dladdr(in_program, &own) &&
           of.dli_fbase != own.dli_fbase && of.dli_fname &&
           strncmp(of.dli_fname, folder, strlen(folder)) != 0;
}

enum cs_status cs_view_pages_create(struct cs_view_pages *pages, const struct cs_view *view,
                                    struct cs_error *error) {
    struct part parts[PARTS_MAX];
    const size_t n = list_parts(view, parts);
    size_t bytes = aligned(sizeof *view);
    for (size_t k = 0; k < n; k++)
        bytes += aligned(parts[k].bytes);
    char *memory =
        mmap(NULL, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (memory == MAP_FAILED)
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for a copy of the system");
    *pages = (struct cs_view_pages){(struct cs_view *)(void *)memory, bytes};
    // the view itself first, then its arrays, to which its pointers are set
    memcpy(memory, view, sizeof *view);
    size_t at = aligned(sizeof *view);
    for (size_t k = 0; k < n; k++) {
        const char *copy = memory + at;
        memcpy(memory + at, array_of(view, parts + k), parts[k].bytes);
        memcpy(memory + parts[k].offset, &copy, sizeof copy);
        at += aligned(parts[k].bytes);
    }
    mprotect(memory, bytes, PROT_READ);
    return CS_OK;
}

void cs_view_pages_update(struct cs_view_pages *pages, const struct cs_view *view) {
    struct part parts[PARTS_MAX];
    bool writable = false;
    const size_t n = pages->view ? list_parts(view, parts) : 0;
    // most calls change nothing: pages are opened at the first difference
    for (size_t k = 0; k < n; k++) {
        const char *from = array_of(view, parts + k);
        char *to = array_of(pages->view, parts + k);
        if (!parts[k].changes || !memcmp(from, to, parts[k].bytes))
            continue;
        if (!writable)
            mprotect(pages->view, pages->bytes, PROT_READ | PROT_WRITE);
        writable = true;
        memcpy(to, from, parts[k].bytes);
    }
    if (writable)
        mprotect(pages->view, pages->bytes, PROT_READ);
}

void cs_view_pages_finish(struct cs_view_pages *pages) {
    if (pages->view)
        munmap(pages->view, pages->bytes);
    *pages = (struct cs_view_pages){0};
}
