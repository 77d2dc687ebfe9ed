// What the device can do at most, for benchmarks to compare with.

#define CHAINS 8
#define TURNS 256

// out: (work-items) written. Each work-item makes CHAINS · TURNS multiply-adds on vectors of four
// floats that do not wait for each other.
__kernel void multiply_adds(__global float* out, const float factor) {
  const float start = (float)get_local_id(0);
  float4 sums[CHAINS];
#pragma unroll
  for (int k = 0; k < CHAINS; ++k)
    sums[k] = (float4)(start, start + 1, start + 2, start + (float)k);
  for (int turn = 0; turn < TURNS; ++turn) {
#pragma unroll
    for (int k = 0; k < CHAINS; ++k) sums[k] = fma(sums[k], (float4)(factor), (float4)(0.5f));
  }
  float4 sum = (float4)(0.0f);
#pragma unroll
  for (int k = 0; k < CHAINS; ++k) sum += sums[k];
  out[get_global_id(0)] = sum.x + sum.y + sum.z + sum.w;
}

// out: as many float4 as `in`. One work-item each.
__kernel void copy(__global const float4* in, __global float4* out) {
  out[get_global_id(0)] = in[get_global_id(0)];
}
