#include "kernels/config.h"

// Stored pixels to floats, unchanged in value.
// pixels: (count) PIXEL; image: floats, `count` of them written from `offset` on. One work-item a
// pixel; the last group may overhang.
__kernel void unpack(__global const PIXEL* pixels, __global float* image, const ulong count,
                     const ulong offset) {
  const size_t i = get_global_id(0);
  if (i < count) image[offset + i] = (float)pixels[i];
}
