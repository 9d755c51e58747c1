/* SPDX-License-Identifier: MIT */
/* clones.h - hot loops compiled for several instruction sets, chosen when the program starts,
 * of the program and of modules: CS_CLONES before a function is all.
 *
 * The bits are the same in each: contraction is off, and vectors only do several independent
 * elements at once. It takes a C library that chooses functions when it loads a program, which
 * musl does not. Clang 14 refuses the attribute on some of these functions; gcc 12 fails on
 * clones of a program that is built for AVX-512 as a whole, which then needs none. */
#ifndef CS_CLONES_H
#define CS_CLONES_H

#include <stdint.h>

#if defined(__x86_64__) && defined(__GLIBC__) && defined(__GNUC__) && !defined(__clang__) &&   \
    !defined(__AVX512F__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define CS_CLONES __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#else
#define CS_CLONES
#endif

/* Before a loop with independent iterations, if the pointers alone do not show it. */
#if defined(__clang__)
#define CS_INDEPENDENT _Pragma("clang loop vectorize(assume_safety)")
#elif defined(__GNUC__)
#define CS_INDEPENDENT _Pragma("GCC ivdep")
#else
#define CS_INDEPENDENT
#endif

/* CS_INLINE: inlined into each clone. CS_UNROLLED: a short loop inside a loop over lanes,
 * unrolled so that its array stays in registers. A build with sanitizers has no clones, and
 * would compile each check up to twelve times. */
#ifdef CS_SANITIZED
#define CS_INLINE static inline
#define CS_UNROLLED
#else
#define CS_INLINE   static inline __attribute__((always_inline))
#define CS_UNROLLED _Pragma("GCC unroll 12")
#endif

#endif
