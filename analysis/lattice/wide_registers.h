// A function compiled for processors with AVX-512, with AVX2 and for the others; the one that fits is taken when the
// program starts. None fuses multiplications with additions, so all give the same bits.
#pragma once

// Sanitizers start later than what chooses the function, which they would look into.
#if defined(__x86_64__) && defined(__gnu_linux__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__) && !defined(__clang__)
#define JND_WIDE_REGISTERS __attribute__((target_clones("arch=x86-64-v4", "avx2", "default")))
#else
#define JND_WIDE_REGISTERS
#endif
