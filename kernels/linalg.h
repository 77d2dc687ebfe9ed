// Small symmetric positive definite systems, in local memory on a device. A C subset that also
// compiles as C++.
#ifndef IMPACTDIC_KERNELS_LINALG_H_
#define IMPACTDIC_KERNELS_LINALG_H_

#include "kernels/vector.h"

#ifndef __OPENCL_C_VERSION__
#include <cmath>
using std::sqrt;
#endif

// Where element (row, column), column <= row, of a packed lower triangle stands.
#define TRIANGLE(row, column) ((row) * ((row) + 1) / 2 + (column))

// Replaces the packed lower triangle of A (n × n) by its Cholesky factor L, A = L Lᵀ. 0 where a
// pivot falls below `smallest` times its diagonal element: A is singular to working precision.
KERNEL_INLINE int cholesky(__local float* a, const int n, const float smallest) {
  for (int j = 0; j < n; ++j) {
    const float diagonal = a[TRIANGLE(j, j)];
    float pivot = diagonal;
    for (int k = 0; k < j; ++k) pivot -= a[TRIANGLE(j, k)] * a[TRIANGLE(j, k)];
    if (!(pivot > smallest * diagonal)) return 0;
    pivot = sqrt(pivot);
    a[TRIANGLE(j, j)] = pivot;
    for (int i = j + 1; i < n; ++i) {
      float sum = a[TRIANGLE(i, j)];
      for (int k = 0; k < j; ++k) sum -= a[TRIANGLE(i, k)] * a[TRIANGLE(j, k)];
      a[TRIANGLE(i, j)] = sum / pivot;
    }
  }
  return 1;
}

// Solves L Lᵀ x = b in place.
KERNEL_INLINE void cholesky_solve(__local const float* l, const int n, __local float* b) {
  for (int i = 0; i < n; ++i) {
    float sum = b[i];
    for (int k = 0; k < i; ++k) sum -= l[TRIANGLE(i, k)] * b[k];
    b[i] = sum / l[TRIANGLE(i, i)];
  }
  for (int i = n - 1; i >= 0; --i) {
    float sum = b[i];
    for (int k = i + 1; k < n; ++k) sum -= l[TRIANGLE(k, i)] * b[k];
    b[i] = sum / l[TRIANGLE(i, i)];
  }
}

// Element (k, k) of (L Lᵀ)⁻¹: the squared length of column k of L⁻¹, made in `column` (n).
KERNEL_INLINE float cholesky_inverse_diagonal(__local const float* l, const int n, const int k,
                                              __local float* column) {
  float squares = 0.0f;
  for (int i = k; i < n; ++i) {
    float sum = i == k ? 1.0f : 0.0f;
    for (int j = k; j < i; ++j) sum -= l[TRIANGLE(i, j)] * column[j];
    column[i] = sum / l[TRIANGLE(i, i)];
    squares += column[i] * column[i];
  }
  return squares;
}

#endif  // IMPACTDIC_KERNELS_LINALG_H_
