/* SPDX-License-Identifier: MIT */
/* program.h - the protocol between clothsim and a program that computes a method, version 1;
 * clothsim-program(7) explains it.
 *
 * A program finds a stream socket as file 3 and shared memory as file 4. Messages have one
 * size, words of 64 bits, in the order of bytes of the machine: little-endian on all processors
 * of Debian 12 but s390x. One side works while the other waits.
 */
#ifndef CLOTHSIM_PROGRAM_H
#define CLOTHSIM_PROGRAM_H

#include <clothsim/integrator.h>

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

enum {
    CS_PROGRAM_VERSION = 1,
    /* Numbers of the files. */
    CS_PROGRAM_SOCKET = 3,
    CS_PROGRAM_MEMORY = 4,
    /* Rows of n doubles behind the head, in this order: x 3, v 3, f 3, dx 3, dv 3, kxx 6, dvv
     * 6, mass, inv_mass, start 3. Then those of the program's history. */
    CS_PROGRAM_ROWS = 32
};

/* Bits of `offers`: calls of the host that have an effect in this scene. */
enum cs_program_offer {
    CS_PROGRAM_MAX_STEP_FRACTION = 1,
    CS_PROGRAM_BOUNDS_AT = 2,
    CS_PROGRAM_LONGEST_STEP = 4,
    CS_PROGRAM_FORCES_DEPEND_ON_TIME = 8
};

/* One message: a letter, and what belongs to it. An answer has the letter of its request.
 *
 * From clothsim:
 *
 *   I                                   the options are in head->text
 *   R values[0]=t                       restart: x, v, mass and inv_mass are set
 *   A values[0]=t0, values[1]=t1        advance
 *   Q                                   end
 *
 * From the program:
 *
 *   V count=version                     first; the description is in the head
 *   D                                   done, the answer to I, R and A
 *
 * Requests of the program meanwhile, and what they give. The state is that in x and v:
 *
 *   F count=parts, values[0]=t          f = the force in N
 *   J count=parts, values[0]=t          f = (df/dx) dx + (df/dv) dv
 *   G values[0]=t                       kxx, dvv = the diagonal blocks
 *   E values[0]=t                       values[0] = the energy in J
 *   L count=flags, values=t,cm,cd,ck    sets A = cm M + cd df/dv + ck df/dx for S, M and P
 *   S values[0]=rtol                    dx = A^-1 f, from the start in dx; count = 1: it failed
 *   M                                   f = A dx
 *   P                                   dx = B^-1 f, the preconditioner
 *   B values[0]=t                       values = omega, delta; bounds
 *   K values=t0,t1                      values[0] = the admissible fraction from x to dx
 *   T values[0]=t                       values[0] = the longest step in s
 *   C values=t,dt                       commit of x and v; count = 1: they were changed
 *   N, X, H                             a note, a failure, a step that cannot be short enough;
 *                                       the text is in the head
 *
 * L, S, M, P, K and C may come in advance alone; after I only N, X and H. */
struct cs_program_message {
    uint64_t code, count;
    double values[4];
};

/* An option of the method, a real number. Texts of a description are closed by a zero. */
struct cs_program_option {
    char name[32], unit[16], help[96];
    /* Default, least and largest value. */
    double def, min, max;
};

/* Largest numbers of options, and of checks that fail. */
enum { CS_PROGRAM_OPTIONS_MAX = 16, CS_PROGRAM_FAILS_MAX = 4 };

/* The description of a program: the fields of struct cs_integrator, in 4096 bytes. */
struct cs_program_description {
    uint64_t order, order_damped, fidelity;
    /* Of enum cs_need: JVP, DIAGONAL, ENERGY, SOLVE and BOUNDS; and of enum cs_trait. */
    uint64_t needs, traits;
    /* Rows of n doubles that it remembers from one advance to the next, behind the arrays;
     * CS_PROGRAM_NO_HISTORY: it does not say, and is restarted at each checkpoint. */
    uint64_t history, n_options;
    /* library: with CS_LIBRARY_BITS. fails: checks of `clothsim conform`. */
    char name[64], summary[256], source[256], library[64];
    char fails[CS_PROGRAM_FAILS_MAX][32];
    struct cs_program_option options[CS_PROGRAM_OPTIONS_MAX];
    char unused[584];
};
#define CS_PROGRAM_NO_HISTORY 1000000

/* The first 8192 bytes of the memory. */
struct cs_program_head {
    uint64_t version;
    /* Particles; 0 while the program is only asked for its description. */
    uint64_t n;
    /* A set of enum cs_program_offer; this and the next are set when I comes. */
    uint64_t offers;
    /* As in struct cs_view and struct cs_host. */
    double omega, delta, length_scale, speed_scale;
    /* Set by the program at any time, as in struct cs_stats: rejected, newton, setups, sweeps.
     */
    uint64_t counts[4];
    double local_error;
    /* Up to byte 4096. */
    char unused[4000];
    union {
        struct cs_program_description description;
        /* Later: options as lines NAME=VALUE, and the texts of messages, closed by a zero. */
        char text[4096];
    };
};

/* Given to the module `program` of clothsim in place of options: a process that has said
 * hello. The object of the module begins with a copy. */
struct cs_program_channel {
    void *owner;
    int socket, process;
    struct cs_program_head *head;
    /* As it has described itself, with the rows of its history, and its options. */
    const struct cs_integrator *method;
    uint64_t history;
    const double *options;
};

#ifdef __cplusplus
}
#endif
#endif
