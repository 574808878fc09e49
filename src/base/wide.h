/* Loops over batches, compiled for wider vectors where the machine has them. */
#ifndef LAVES_BASE_WIDE_H
#define LAVES_BASE_WIDE_H

#include <stdint.h> /* for __GLIBC__ */

/* Before a function: the same loops for wider vectors as well; without fused multiply-add, so with the same bits. Sanitizers
 * start too late for the resolvers of clones. */
#if defined(__x86_64__) && defined(__linux__) && defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__) && defined(__GNUC__) && !defined(__clang__)
#define LAVES__WIDE __attribute__((target_clones("avx2", "default")))
#else
#define LAVES__WIDE
#endif

/* Before a loop whose turn i touches items i only, though its arrays may be one another. */
#if defined(__GNUC__) && !defined(__clang__)
#define LAVES__EACH_ALONE _Pragma("GCC ivdep")
#else
#define LAVES__EACH_ALONE
#endif

#endif
