#include "kernels/config.h"
#include "kernels/frames/unpack.h"

#define CAT_(a, b) a##b
#define CAT(a, b) CAT_(a, b)

// Stored pixels as they are, and as floats of the same value.
// pixels: (count); image, kept: `count` of them written from `offset` on. A work-item takes
// UNPACK_AT_ONCE pixels; the last group may overhang.
__kernel void unpack(__global const PIXEL* pixels, __global float* image, __global PIXEL* kept,
                     const ulong count, const ulong offset) {
  const size_t first = get_global_id(0) * UNPACK_AT_ONCE;
  if (first + UNPACK_AT_ONCE <= count) {
    const CAT(PIXEL, 8) some = vload8(0, pixels + first);
    vstore8(convert_float8(some), 0, image + offset + first);
    vstore8(some, 0, kept + offset + first);
    return;
  }
  for (size_t i = first; i < count; ++i) {
    image[offset + i] = (float)pixels[i];
    kept[offset + i] = pixels[i];
  }
}
