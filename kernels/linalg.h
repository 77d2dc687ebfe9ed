// Small symmetric positive definite systems in local memory.
#ifndef IMPACTDIC_KERNELS_LINALG_H_
#define IMPACTDIC_KERNELS_LINALG_H_

#include "kernels/vector.h"

// Where element (row, column), column <= row, of a packed lower triangle stands.
#define TRIANGLE(row, column) ((row) * ((row) + 1) / 2 + (column))

// The largest n below, a literal wherever these are called: a work-item then has all in registers,
// where a chain of local memory's latencies would be most of the time. Always inlined: LLVM 15
// crashes where it propagates constants into them.
#define LARGEST_SYSTEM (10 + FREE_DISTANCE + 2 * FREE_CENTRE)

// Replaces the packed lower triangle of A (n × n) by its Cholesky factor L, A = L Lᵀ, on whose
// diagonal stand the reciprocals. 0 where a pivot falls below `smallest` times its diagonal
// element: A is singular to working precision.
BARRIER_INLINE int cholesky(__local float* a, const int n, const float smallest) {
  float l[TRIANGLE(LARGEST_SYSTEM, 0)];
#pragma unroll
  for (int k = 0; k < TRIANGLE(n, 0); ++k) l[k] = a[k];
  int regular = 1;
#pragma unroll
  for (int j = 0; j < n; ++j) {
    const float diagonal = l[TRIANGLE(j, j)];
    float pivot = diagonal;
#pragma unroll
    for (int k = 0; k < j; ++k) pivot -= l[TRIANGLE(j, k)] * l[TRIANGLE(j, k)];
    if (!(pivot > smallest * diagonal)) regular = 0;
    const float by_pivot = 1.0f / sqrt(pivot);
    l[TRIANGLE(j, j)] = by_pivot;
#pragma unroll
    for (int i = j + 1; i < n; ++i) {
      float sum = l[TRIANGLE(i, j)];
#pragma unroll
      for (int k = 0; k < j; ++k) sum -= l[TRIANGLE(i, k)] * l[TRIANGLE(j, k)];
      l[TRIANGLE(i, j)] = sum * by_pivot;
    }
  }
#pragma unroll
  for (int k = 0; k < TRIANGLE(n, 0); ++k) a[k] = l[k];
  return regular;
}

// L⁻¹ b into x, for the factor of `cholesky`.
BARRIER_INLINE void cholesky_forward(__local const float* l, const int n, __local const float* b,
                                     float* x) {
#pragma unroll
  for (int i = 0; i < n; ++i) {
    float sum = b[i];
#pragma unroll
    for (int k = 0; k < i; ++k) sum -= l[TRIANGLE(i, k)] * x[k];
    x[i] = sum * l[TRIANGLE(i, i)];
  }
}

// Solves L Lᵀ x = b in place.
BARRIER_INLINE void cholesky_solve(__local const float* l, const int n, __local float* b) {
  float x[LARGEST_SYSTEM];
  cholesky_forward(l, n, b, x);
#pragma unroll
  for (int i = n - 1; i >= 0; --i) {
    float sum = x[i];
#pragma unroll
    for (int k = i + 1; k < n; ++k) sum -= l[TRIANGLE(k, i)] * x[k];
    x[i] = sum * l[TRIANGLE(i, i)];
  }
#pragma unroll
  for (int i = 0; i < n; ++i) b[i] = x[i];
}

// bᵀ (L Lᵀ)⁻¹ b, the squared length of L⁻¹ b.
BARRIER_INLINE float cholesky_quadratic(__local const float* l, const int n,
                                        __local const float* b) {
  float x[LARGEST_SYSTEM];
  cholesky_forward(l, n, b, x);
  float squares = 0.0f;
#pragma unroll
  for (int i = 0; i < n; ++i) squares += x[i] * x[i];
  return squares;
}

#endif  // IMPACTDIC_KERNELS_LINALG_H_
