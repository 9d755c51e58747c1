/* SPDX-License-Identifier: MIT */
/* midpoint_program.c - the explicit midpoint method as a program in C: clothsim-program(7).
 *
 *   cc -std=c17 -O2 -ffp-contract=off midpoint_program.c -o midpoint_program
 *   clothsim run scenes/hang.json -i program:./midpoint_program:dt=0.0002
 */
#include <clothsim/program.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

static struct cs_program_head *head;
static double *x, *v, *f, *inv_mass, *before;
static size_t n;
static double dt;

/* Waits for a message, and ends with clothsim. */
static struct cs_program_message receive(void) {
    struct cs_program_message message;
    for (size_t got = 0; got < sizeof message;) {
        const ssize_t more =
            read(CS_PROGRAM_SOCKET, (char *)&message + got, sizeof message - got);
        if (more <= 0)
            exit(0);
        got += (size_t)more;
    }
    return message;
}

static void send_message(struct cs_program_message message) {
    if (write(CS_PROGRAM_SOCKET, &message, sizeof message) != sizeof message)
        exit(0);
}

/* A request: what is asked about is in x and v, where a commit leaves the state too. */
static void ask(char letter, uint64_t count, double a, double b) {
    send_message((struct cs_program_message){(uint64_t)letter, count, {a, b, 0, 0}});
    receive();
}

/* x and v to those before, h later by the present v and f. */
static void move(double h) {
    for (size_t k = 0; k < 3 * n; k++) {
        x[k] = before[k] + h * v[k];
        v[k] = before[3 * n + k] + h * (f[k] * inv_mass[k % n]);
    }
}

/* x is moved by the velocity of the stage, which v holds when f is asked for. */
static void step(double t, double h, double end) {
    memcpy(before, x, 6 * n * sizeof *x);
    ask('F', 0x7fffffff, t, 0);
    move(h / 2);
    ask('F', 0x7fffffff, t + h / 2, 0);
    move(h);
    ask('C', 0, end, h);
}

static void advance(double t0, double t1) {
    const double count = fmax(ceil((t1 - t0) / dt * (1 - 1e-9)), 1), h = (t1 - t0) / count;
    for (double k = 0; k < count; k++)
        step(t0 + k * h, h, k + 1 < count ? t0 + (k + 1) * h : t1);
}

int main(void) {
    struct stat info;
    if (fstat(CS_PROGRAM_MEMORY, &info) || info.st_size < (off_t)sizeof *head)
        return fprintf(stderr, "midpoint_program: expected to be started by clothsim\n"), 2;
    head = mmap(NULL, (size_t)info.st_size, PROT_READ | PROT_WRITE, MAP_SHARED,
                CS_PROGRAM_MEMORY, 0);
    n = head->n;
    x = (double *)(head + 1);
    v = x + 3 * n;
    f = x + 6 * n;
    inv_mass = x + 28 * n;
    before = calloc(6 * n + 1, sizeof *before);
    head->description =
        (struct cs_program_description){.order = 2,
                                        .order_damped = 2,
                                        .n_options = 1,
                                        .name = "c-midpoint",
                                        .summary = "explicit midpoint method, a program in C",
                                        .source = "Runge 1895",
                                        .fails = {"crossing"},
                                        .options = {{"dt", "s", "step", 1e-3, 1e-9, 1}}};
    send_message((struct cs_program_message){.code = 'V', .count = CS_PROGRAM_VERSION});
    for (;;) {
        const struct cs_program_message order = receive();
        if (order.code == 'Q')
            return 0;
        if (order.code == 'I')
            dt = atof(strchr(head->text, '=') + 1);
        if (order.code == 'A')
            advance(order.values[0], order.values[1]);
        send_message((struct cs_program_message){.code = 'D'});
    }
}
