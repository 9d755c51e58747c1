/* SPDX-License-Identifier: MIT */
/* program.c - the calls of a method that another process computes: asks it to advance, and
 * answers what it asks of the host.
 *
 * clothsim opens this module for each program that the command line names, starts the process,
 * and puts its description in place of the descriptor below. A program can send anything: each
 * message is checked. The protocol is in <clothsim/program.h> and clothsim-program(7). */
#include <clothsim/integrator.h>
#include <clothsim/program.h>

#include <errno.h>
#include <math.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <time.h>

/* Time that a step has to end in after a signal to stop: longer than clothsim waits for a
 * method. */
enum { STOP_MS = 10000 };

/* self of the method's calls. */
struct bridge {
    struct cs_program_channel channel; /* first: clothsim finds it there */
    const struct cs_host *host;
    double *x, *v, *f, *dx, *dv, *kxx, *dvv, *mass, *inv_mass, *start, *history;
    bool is_set_up;      /* there is a matrix to solve with */
    bool solve_may_fail; /* CS_SOLVE_MAY_FAIL of the last set-up */
    bool is_back;        /* a commit took the step back: what the program does until it is done
                            counts no more */
};

/* Copies a text of the program as one line. */
static const char *text_of(const struct bridge *bridge, char line[256]) {
    const char *text = bridge->channel.head->text;
    size_t k = 0;
    for (; k < 255 && text[k]; k++)
        line[k] = (unsigned char)text[k] < ' ' ? ' ' : text[k];
    line[k] = 0;
    return line;
}

static bool send_message(const struct bridge *bridge,
                         const struct cs_program_message *message) {
    return send(bridge->channel.socket, message, sizeof *message, MSG_NOSIGNAL) ==
           sizeof *message;
}

/* Says that the program has ended, and how if that is known within a second. */
static enum cs_step lose(const struct bridge *bridge) {
    const struct timespec nap = {.tv_nsec = 5000000};
    const struct cs_host *host = bridge->host;
    siginfo_t info = {0};
    for (int k = 0; k < 200 && !info.si_pid; k++) {
        // clothsim takes the end itself
        if (waitid(P_PID, (id_t)bridge->channel.process, &info, WEXITED | WNOHANG | WNOWAIT))
            break;
        if (!info.si_pid)
            nanosleep(&nap, NULL);
    }
    if (!info.si_pid)
        return host->fail(host->ctx, "its program closed the socket");
    return info.si_code == CLD_EXITED
               ? host->fail(host->ctx, "its program ended with code %d", info.si_status)
               : host->fail(host->ctx, "its program was ended by signal %d (%s)",
                            info.si_status, strsignal(info.si_status));
}

/* Waits for a message; after a signal for STOP_MS more. Returns false with the reason told. */
static enum cs_step receive(const struct bridge *bridge, struct cs_program_message *message) {
    const struct cs_host *host = bridge->host;
    struct pollfd socket = {.fd = bridge->channel.socket, .events = POLLIN};
    int timeout = -1;
    for (size_t got = 0; got < sizeof *message;) {
        const int ready = poll(&socket, 1, timeout);
        if (ready == 0)
            return host->fail(host->ctx, "its program did not end the step after a signal");
        if (ready < 0) {
            timeout = STOP_MS;
            continue;
        }
        const ssize_t n = recv(socket.fd, (char *)message + got, sizeof *message - got, 0);
        if (n == 0 || (n < 0 && errno != EINTR))
            return lose(bridge);
        got += n > 0 ? (size_t)n : 0;
    }
    return CS_STEP_OK;
}

static enum cs_step commit(struct bridge *bridge, struct cs_program_message *message, double *x,
                           double *v) {
    const struct cs_host *host = bridge->host;
    const size_t bytes = host->view->n * sizeof *x;
    bool changed = false;
    message->count = 0;
    if (bridge->is_back)
        return CS_STEP_OK;
    memcpy(x, bridge->x, 6 * bytes);
    const enum cs_step step =
        host->commit(host->ctx, message->values[0], message->values[1], x, v, &changed);
    memcpy(bridge->x, x, 6 * bytes);
    memcpy(bridge->inv_mass, host->view->inv_mass, bytes);
    message->count = changed;
    bridge->is_back = step == CS_STEP_BACK;
    return bridge->is_back ? CS_STEP_OK : step;
}

/* Answers a request into the message. */
static enum cs_step answer(struct bridge *b, struct cs_program_message *message, double *x,
                           double *v) {
    const struct cs_host *host = b->host;
    void *ctx = host->ctx;
    double *values = message->values;
    const double t = values[0];
    const uint32_t bits = (uint32_t)message->count;
    char line[256];
    // arguments come and results go in the arrays that are named alike
    switch (message->code) {
    case 'F':
        host->force(ctx, t, b->x, b->v, bits, b->f);
        return CS_STEP_OK;
    case 'J':
        host->jvp(ctx, t, b->x, b->v, bits, b->dx, b->dv, b->f);
        return CS_STEP_OK;
    case 'G':
        host->diagonal(ctx, t, b->x, b->v, b->kxx, b->dvv);
        return CS_STEP_OK;
    case 'E':
        values[0] = host->energy(ctx, t, b->x, b->v);
        return CS_STEP_OK;
    case 'L':
        b->is_set_up = true;
        b->solve_may_fail = bits & CS_SOLVE_MAY_FAIL;
        return host->solve_setup(ctx, t, b->x, b->v, values[1], values[2], values[3], bits);
    case 'S':
        return host->solve(ctx, b->f, t, b->dx);
    case 'M':
        host->matrix_product(ctx, b->dx, b->f);
        return CS_STEP_OK;
    case 'P':
        host->precondition(ctx, b->f, b->dx);
        return CS_STEP_OK;
    case 'B':
        values[0] = host->view->omega;
        values[1] = host->view->delta;
        if (host->bounds_at)
            host->bounds_at(ctx, t, b->x, b->v, values, values + 1);
        return CS_STEP_OK;
    case 'K':
        if (host->max_step_fraction)
            values[0] = host->max_step_fraction(ctx, t, b->x, values[1], b->dx);
        else
            values[0] = 1;
        return CS_STEP_OK;
    case 'T':
        values[0] = host->longest_step ? host->longest_step(ctx, t, b->x, b->v) : HUGE_VAL;
        return CS_STEP_OK;
    case 'N':
        host->note(ctx, "%s", text_of(b, line));
        return CS_STEP_OK;
    case 'C':
        return commit(b, message, x, v);
    default: /* X and H */
        host->fail(ctx, "%s", text_of(b, line));
        return message->code == 'H' ? CS_STEP_HALT : CS_STEP_FAIL;
    }
}

/* Refuses a message out of place: its letter is not allowed in this call, its need was not
 * declared, or there is no matrix yet. */
static enum cs_step check_request(const struct bridge *bridge, const char *allowed,
                                  uint64_t code) {
    static const struct {
        char letter;
        enum cs_need need;
    } needs[] = {{'J', CS_NEED_JVP},   {'G', CS_NEED_DIAGONAL}, {'E', CS_NEED_ENERGY},
                 {'L', CS_NEED_SOLVE}, {'S', CS_NEED_SOLVE},    {'M', CS_NEED_SOLVE},
                 {'P', CS_NEED_SOLVE}};
    const struct cs_host *host = bridge->host;
    const bool is_letter = code > ' ' && code < 127;
    if (!is_letter || !strchr(allowed, (int)code))
        return host->fail(host->ctx, "its program sent %#llx, expected one of the letters %s",
                          (unsigned long long)code, allowed);
    for (size_t k = 0; k < sizeof needs / sizeof *needs; k++)
        if ((uint64_t)needs[k].letter == code &&
            !(bridge->channel.method->needs & needs[k].need))
            return host->fail(host->ctx,
                              "its program asked for '%c', which is not among its needs",
                              (int)code);
    if (strchr("SMP", (int)code) && !bridge->is_set_up)
        return host->fail(host->ctx, "its program asked for '%c' before 'L'", (int)code);
    return CS_STEP_OK;
}

/* Sends an order and answers requests until it is done. x and v are the run's in advance, else
 * NULL. */
static enum cs_step serve(struct bridge *bridge, const struct cs_program_message *order,
                          const char *allowed, double *x, double *v) {
    struct cs_program_message message = *order;
    for (;;) {
        if (!send_message(bridge, &message))
            return lose(bridge);
        enum cs_step step = receive(bridge, &message);
        if (step == CS_STEP_OK)
            step = check_request(bridge, allowed, message.code);
        if (step != CS_STEP_OK || message.code == 'D')
            return step == CS_STEP_OK && bridge->is_back ? CS_STEP_BACK : step;
        step = answer(bridge, &message, x, v);
        const bool may_fail = message.code == 'S' && bridge->solve_may_fail;
        if (step != CS_STEP_OK && !may_fail)
            return step;
        if (message.code == 'S')
            message.count = step != CS_STEP_OK;
    }
}

/* Sets the pointers of a run's arrays, one behind the other, and those that do not change. */
static void lay_out(struct bridge *bridge) {
    const struct cs_host *host = bridge->host;
    const struct cs_view *view = host->view;
    const size_t n = view->n;
    struct cs_program_head *head = bridge->channel.head;
    double *at = (double *)(head + 1);
    const struct {
        double **array;
        size_t rows;
    } arrays[] = {{&bridge->x, 3},    {&bridge->v, 3},    {&bridge->f, 3},
                  {&bridge->dx, 3},   {&bridge->dv, 3},   {&bridge->kxx, 6},
                  {&bridge->dvv, 6},  {&bridge->mass, 1}, {&bridge->inv_mass, 1},
                  {&bridge->start, 3}};
    for (size_t k = 0; k < sizeof arrays / sizeof *arrays; at += arrays[k++].rows * n)
        *arrays[k].array = at;
    bridge->history = at;
    head->offers = (host->max_step_fraction ? CS_PROGRAM_MAX_STEP_FRACTION : 0u) |
                   (host->bounds_at ? CS_PROGRAM_BOUNDS_AT : 0u) |
                   (host->longest_step ? CS_PROGRAM_LONGEST_STEP : 0u) |
                   (host->forces_depend_on_time ? CS_PROGRAM_FORCES_DEPEND_ON_TIME : 0u);
    head->omega = view->omega;
    head->delta = view->delta;
    head->length_scale = host->length_scale;
    head->speed_scale = host->speed_scale;
    memcpy(bridge->start, view->start, 3 * n * sizeof *bridge->start);
}

/* options: struct cs_program_channel. The program reads its own as lines NAME=VALUE. */
static enum cs_step create(const struct cs_host *host, const void *options, void **self) {
    const struct cs_program_channel *channel = options;
    const struct cs_integrator *method = channel->method;
    struct bridge *bridge = host->alloc(host->ctx, sizeof *bridge);
    if (!bridge)
        return CS_STEP_FAIL;
    *self = bridge;
    bridge->host = host;
    bridge->channel = *channel;
    lay_out(bridge);
    char *text = channel->head->text;
    size_t used = 0;
    *text = 0;
    for (uint32_t k = 0; k < method->n_options; k++)
        used += (size_t)snprintf(text + used, sizeof channel->head->text - used, "%s=%.17g\n",
                                 method->options[k].name, channel->options[k]);
    return serve(bridge, &(struct cs_program_message){.code = 'I'}, "DNXH", NULL, NULL);
}

/* The state and what a restart may change, for the program. */
static void show_state(struct bridge *bridge, const double *x, const double *v) {
    const struct cs_view *view = bridge->host->view;
    const size_t bytes = view->n * sizeof *x;
    memcpy(bridge->x, x, 3 * bytes);
    memcpy(bridge->v, v, 3 * bytes);
    memcpy(bridge->mass, view->mass, bytes);
    memcpy(bridge->inv_mass, view->inv_mass, bytes);
}

static enum cs_step restart(void *self, double t, const double *x, const double *v) {
    struct bridge *bridge = self;
    bridge->is_back = false;
    show_state(bridge, x, v);
    return serve(bridge, &(struct cs_program_message){'R', 0, {t}}, "DNXFJGEBT", NULL, NULL);
}

static enum cs_step advance(void *self, double t0, double t1, double *x, double *v) {
    struct bridge *bridge = self;
    show_state(bridge, x, v);
    return serve(bridge, &(struct cs_program_message){'A', 0, {t0, t1}}, "DNXHFJGEBTLSMPKC", x,
                 v);
}

static void stats(const void *self, struct cs_stats *out) {
    const struct cs_program_head *head = ((const struct bridge *)self)->channel.head;
    out->rejected = head->counts[0];
    out->newton = head->counts[1];
    out->setups = head->counts[2];
    out->sweeps = head->counts[3];
    out->local_error = head->local_error;
}

/* save and load: what the program remembers lies in the shared memory. */
static enum cs_step archive_history(void *self, const struct cs_archive *archive) {
    struct bridge *bridge = self;
    struct cs_program_head *head = bridge->channel.head;
    archive->integers(archive->ctx, head->counts, 4);
    archive->reals(archive->ctx, &head->local_error, 1);
    archive->reals(archive->ctx, bridge->history,
                   bridge->channel.history * (size_t)bridge->host->view->n);
    return CS_STEP_OK;
}

static void destroy(void *self) {
    send_message(self, &(struct cs_program_message){.code = 'Q'});
}

/* The host puts the description of the program in place of these texts. */
#define CALLS                                                                                  \
    .size = sizeof(struct cs_integrator), .name = "program",                                   \
    .summary = "a method that another process computes", .source = "clothsim-program(7)",      \
    .create = create, .restart = restart, .advance = advance, .stats = stats,                  \
    .destroy = destroy
static const struct cs_integrator remembering = {CALLS, .save = archive_history,
                                                 .load = archive_history};
static const struct cs_integrator forgetting = {CALLS};
static const struct cs_integrator *const integrators[] = {&remembering, &forgetting};
CS_EXPORT const struct cs_module clothsim_module = {
    .abi = CS_ABI, .size = sizeof(struct cs_integrator), .n = 2, .integrators = integrators};
