#include "kernels/config.h"
#include "kernels/spline.h"
#include "kernels/types.h"

// The turn of a ball between two frames, however large: both are unwrapped along rings about their
// own centres and correlated along the angle (Lucchese and Cortelazzo 2000 for the principle).
// Here the unwrapping and the sum of the rings' cross spectra; the transforms between them are
// clFFT's.

static inline float sample_ring(__global const float* coefficients, const int width,
                                const int height, const int pitch, const float cx, const float cy,
                                const float radius, const float angle, int* inside) {
  // Whole pixels apart, floats keep their digits for the position about the centre.
  const float whole_x = rint(cx), whole_y = rint(cy);
  const float x = (cx - whole_x) + radius * cospi(angle);
  const float y = (cy - whole_y) - radius * sinpi(angle);  // counter-clockwise with y down
  const float far_x = x + whole_x, far_y = y + whole_y;
  *inside =
      far_x >= 0.0f && far_y >= 0.0f && far_x <= (float)(width - 1) && far_y <= (float)(height - 1);
  if (!*inside) return 0.0f;
  return spline_sample(coefficients + (int)whole_y * pitch + (int)whole_x, pitch, x, y);
}

// polar: (tasks, rings, angles) pairs: first frame, second frame; 0 outside the picture.
// missing: (tasks) counts samples outside either picture. coefficients: of SplineFrames from
// element `offset` on. One work-item a sample: (angles, rings, tasks).
__kernel void unwrap_rings(__global const float* coefficients, const int offset, const int width,
                           const int height, const int pitch, __global const RingTask* tasks,
                           __global float2* polar, __global int* missing) {
  const size_t k = get_global_id(0), ring = get_global_id(1), item = get_global_id(2);
  const size_t angles = get_global_size(0), rings = get_global_size(1);
  const RingTask task = tasks[item];
  const float radius = task.inner + (task.outer - task.inner) * ((float)ring + 0.5f) / (float)rings;
  const float angle = 2.0f * (float)k / (float)angles;  // in half turns
  const size_t picture = (size_t)(height + 2 * SPLINE_PAD) * pitch;
  __global const float* origin = coefficients + offset + SPLINE_PAD * pitch + SPLINE_PAD;
  int first_inside, second_inside;
  float2 value;
  value.x = sample_ring(origin + (size_t)task.first * picture, width, height, pitch, task.cx_first,
                        task.cy_first, radius, angle, &first_inside);
  value.y = sample_ring(origin + (size_t)task.second * picture, width, height, pitch,
                        task.cx_second, task.cy_second, radius, angle, &second_inside);
  if (!first_inside || !second_inside) atomic_inc(&missing[item]);
  polar[(item * rings + ring) * angles + k] = value;
}

// Sums over the rings, each with its radius as weight (its share of the area). transform: (tasks,
// rings, angles), of first + i second. cross: (tasks, angles) conj(F) G, without the means (k = 0).
// energy: (tasks, angles) |F|², |G|². One work-item a frequency: (angles, tasks).
__kernel void sum_rings(__global const float2* transform, __global const RingTask* tasks,
                        const int rings, __global float2* cross, __global float2* energy) {
  const size_t k = get_global_id(0), item = get_global_id(1), angles = get_global_size(0);
  const size_t mirrored = k == 0 ? 0 : angles - k;
  const RingTask task = tasks[item];
  float2 product = (float2)(0.0f, 0.0f), squares = (float2)(0.0f, 0.0f);
  for (int ring = 0; ring < rings && k != 0; ++ring) {
    const float weight =
        task.inner + (task.outer - task.inner) * ((float)ring + 0.5f) / (float)rings;
    __global const float2* line = transform + (item * rings + ring) * angles;
    const float2 z = line[k], m = line[mirrored];
    // Both pictures are real: F = (z + conj m) / 2, G = (z − conj m) / 2i.
    const float2 f = (float2)(0.5f * (z.x + m.x), 0.5f * (z.y - m.y));
    const float2 g = (float2)(0.5f * (z.y + m.y), 0.5f * (m.x - z.x));
    product += weight * (float2)(f.x * g.x + f.y * g.y, f.x * g.y - f.y * g.x);
    squares += weight * (float2)(dot(f, f), dot(g, g));
  }
  cross[item * angles + k] = product;
  energy[item * angles + k] = squares;
}
