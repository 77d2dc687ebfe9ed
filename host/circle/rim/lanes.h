// Eight numbers at a time. Internal to host/circle.
//
// Written with the vector extension that GCC and Clang share: an operator is an instruction, and a
// vector is an ordinary member, array element and function argument. Two libraries were weighed:
//
//   std::experimental::simd  The inner loop of sum_lines gives the same bits. Its portable type
//       (fixed_size_simd<float, 8>) takes 1.9 times as long, the one that it deduces 0.94 to 1.05
//       times for -march=x86-64-v3, but 2.9 times without: it goes by the flags of the file, not by
//       the processor for which a function is cloned, and is the slow one on processors of four
//       lanes. It has no shuffle for the transposition in rim_evidence.cpp, and Clang's library
//       has only a part of it.
//   Highway  Its vectors may have no size known beforehand: they can be no members (Evidence) and
//       no elements of arrays (one vector a kind), and every function of them has to stand in a
//       file that is compiled once a target. Not measured.
//
// What would be gained is a name for selection and conversion; what would be lost is the speed of a
// build for any processor.
#pragma once

#include <cstring>

// A function of vectors, compiled for AVX-512 too and chosen when the program starts; sanitizers
// are not ready by then. What it calls must be inlined into it to be compiled so as well.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define IMPACTDIC_WIDE __attribute__((target_clones("arch=x86-64-v4", "default")))
#else
#define IMPACTDIC_WIDE
#endif

namespace impactdic::circle {

// Aligned as in functions compiled for wider vectors, whatever the others are compiled for.
typedef float Lanes __attribute__((vector_size(32), aligned(32)));
typedef int IntLanes __attribute__((vector_size(32), aligned(32)));
inline constexpr int kLanes = 8;
inline constexpr Lanes kCount = {0, 1, 2, 3, 4, 5, 6, 7};

// Always in this order, so that sums are the same to the bit on every machine.
inline float total_of(const Lanes& v) {
  return ((v[0] + v[4]) + (v[1] + v[5])) + ((v[2] + v[6]) + (v[3] + v[7]));
}

// kLanes of them from memory.
template <typename Vector, typename T>
[[gnu::always_inline]] inline void load(const T* from, Vector& v) {
  static_assert(sizeof(Vector) == kLanes * sizeof(T));
  std::memcpy(&v, from, sizeof(v));
}

// For containers, which would lose the alignment of bare ones.
struct Eight {
  Lanes v;
};

}  // namespace impactdic::circle
