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

// bᵀ (L Lᵀ)⁻¹ b, the squared length of L⁻¹ b, which takes b's place.
KERNEL_INLINE float cholesky_quadratic(__local const float* l, const int n, __local float* b) {
  float squares = 0.0f;
  for (int i = 0; i < n; ++i) {
    float sum = b[i];
    for (int k = 0; k < i; ++k) sum -= l[TRIANGLE(i, k)] * b[k];
    b[i] = sum / l[TRIANGLE(i, i)];
    squares += b[i] * b[i];
  }
  return squares;
}

#endif  // IMPACTDIC_KERNELS_LINALG_H_
