// Cross-power spectra for the sizes that go through clFFT.
#include "kernels/config.h"

// planes: (count, FFT_PX, FFT_PX), spectra Z of template + i·search, in place to t^* g^ (see
// single.cl), which is Hermitian: one work-item serves k and −k. Two-dimensional range:
// x half a plane, the last group may overhang; y the window.
__kernel void cross_power(__global float2* planes) {
  const int kx = (int)get_global_id(0) % FFT_PX, ky = (int)get_global_id(0) / FFT_PX;
  if (ky > FFT_PX / 2) return;
  const int mx = (FFT_PX - kx) % FFT_PX, my = (FFT_PX - ky) % FFT_PX;
  const int at = ky * FFT_PX + kx, mirrored = my * FFT_PX + mx;
  // In rows that are their own mirror the lower of the two serves both.
  if (ky == my && mx < kx) return;
  __global float2* plane = planes + get_global_id(1) * (FFT_PX * FFT_PX);
  const float2 z = plane[at], m = plane[mirrored];
  const float2 t = (float2)(z.x + m.x, z.y - m.y), g = (float2)(z.y + m.y, m.x - z.x);
  const float2 power = 0.25f * (float2)(t.x * g.x + t.y * g.y, t.x * g.y - t.y * g.x);
  plane[at] = power;
  plane[mirrored] = (float2)(power.x, -power.y);
}
