#include "kernels/config.h"

// Stored pixels as they are, and as floats of the same value.
// pixels: (count); image, kept: `count` of them written from `offset` on. One work-item a pixel;
// the last group may overhang.
__kernel void unpack(__global const PIXEL* pixels, __global float* image, __global PIXEL* kept,
                     const ulong count, const ulong offset) {
  const size_t i = get_global_id(0);
  if (i >= count) return;
  image[offset + i] = (float)pixels[i];
  kept[offset + i] = pixels[i];
}
