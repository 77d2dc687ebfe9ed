// Turns of a sphere: 3 × 3 matrices, rows one after the other, in the axes of the picture with the
// depth, x right, y down, z towards the camera. Rotation vectors are those of the camera's axes, X
// right, Y up, Z towards it: Z is counter-clockwise on the screen.
#ifndef IMPACTDIC_KERNELS_BALL_TURN_H_
#define IMPACTDIC_KERNELS_BALL_TURN_H_

#include "kernels/vector.h"

// turn becomes turn · exp(rotation vector); Rodrigues' formula.
BARRIER_INLINE void turn_by(__local float* turn, const float x, const float y, const float z) {
  const float angle = sqrt(x * x + y * y + z * z);
  const float sine = angle > 1e-4f ? sin(0.5f * angle) / (0.5f * angle) : 1.0f;
  const float first = angle > 1e-4f ? sin(angle) / angle : 1.0f;
  const float second = 0.5f * sine * sine;
  const float k[9] = {0.0f, z, y, -z, 0.0f, x, -y, -x, 0.0f};
  float e[9];
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      float square = 0.0f;
      for (int n = 0; n < 3; ++n) square += k[3 * i + n] * k[3 * n + j];
      e[3 * i + j] = (i == j ? 1.0f : 0.0f) + first * k[3 * i + j] + second * square;
    }
  }
  for (int i = 0; i < 3; ++i) {
    const float row[3] = {turn[3 * i], turn[3 * i + 1], turn[3 * i + 2]};
    for (int j = 0; j < 3; ++j) {
      turn[3 * i + j] = row[0] * e[j] + row[1] * e[3 + j] + row[2] * e[6 + j];
    }
  }
}

BARRIER_INLINE void turn_start(__local float* turn, const float x, const float y, const float z) {
  for (int i = 0; i < 9; ++i) turn[i] = i % 4 == 0 ? 1.0f : 0.0f;
  turn_by(turn, x, y, z);
}

// The rotation vector, at most pi long, by the quaternion from its largest component on (Shepperd
// 1978): exact to the last digits at any angle.
BARRIER_INLINE void rotation_vector(__local const float* m, float* out) {
  const float trace = m[0] + m[4] + m[8];
  // Camera axes: twice the vector part of the quaternion times four of its scalar part.
  const float ax = m[5] - m[7], ay = m[2] - m[6], az = m[1] - m[3];
  float w, x, y, z;
  if (trace > 0.0f) {
    w = 1.0f + trace;
    x = ax;
    y = ay;
    z = az;
  } else if (m[0] > m[4] && m[0] > m[8]) {
    w = ax;
    x = 1.0f + m[0] - m[4] - m[8];
    y = -(m[1] + m[3]);
    z = m[2] + m[6];
  } else if (m[4] > m[8]) {
    w = ay;
    x = -(m[1] + m[3]);
    y = 1.0f + m[4] - m[0] - m[8];
    z = -(m[5] + m[7]);
  } else {
    w = az;
    x = m[2] + m[6];
    y = -(m[5] + m[7]);
    z = 1.0f + m[8] - m[0] - m[4];
  }
  if (w < 0.0f) {
    w = -w;
    x = -x;
    y = -y;
    z = -z;
  }
  const float length = sqrt(x * x + y * y + z * z);
  const float scale = length > 1e-12f ? 2.0f * atan2(length, w) / length : 0.0f;
  out[0] = scale * x;
  out[1] = scale * y;
  out[2] = scale * z;
}

#endif  // IMPACTDIC_KERNELS_BALL_TURN_H_
