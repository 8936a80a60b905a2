// SPDX-License-Identifier: Apache-2.0
#pragma once

// Loops over bytes that the compiler vectorises, built twice: for the x86-64-v2 that every machine has, and for AVX2,
// chosen when the process starts. For integers only: both give the same bytes.
//
//   KINEMAP_INLINE_INTO_DISPATCH void Loop(int* a, int n) { ... }
//   KINEMAP_DISPATCH(Loop, (int* a, int n), (a, n))   // declares LoopDispatched(a, n)
//
// (GCC's target_clones would do the same by an ifunc, which runs before the sanitizers are ready.)
#if defined(__x86_64__) && defined(__GNUC__)
#define KINEMAP_INLINE_INTO_DISPATCH __attribute__((always_inline)) inline
#define KINEMAP_DISPATCH(loop, parameters, arguments)                            \
  __attribute__((target("avx2"))) void loop##Avx2 parameters { loop arguments; } \
  void loop##Baseline parameters { loop arguments; }                             \
  void loop##Dispatched parameters {                                             \
    static const bool has_avx2 = __builtin_cpu_supports("avx2");                 \
    has_avx2 ? loop##Avx2 arguments : loop##Baseline arguments;                  \
  }
#else
#define KINEMAP_INLINE_INTO_DISPATCH inline
#define KINEMAP_DISPATCH(loop, parameters, arguments) \
  void loop##Dispatched parameters { loop arguments; }
#endif
