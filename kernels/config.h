// Every -D macro of the kernels: meaning, default, constraint. Each .cl file compiles alone with
// these defaults, so that it can be linted without a device.
#ifndef IMPACTDIC_KERNELS_CONFIG_H_
#define IMPACTDIC_KERNELS_CONFIG_H_

// unpack.cl: type of a stored pixel, uchar (8-bit files) or ushort (10 to 16 bit, value low).
#ifndef PIXEL
#define PIXEL uchar
#endif

// Interrogation window and largest displacement searched each way, px. Where transforms are used,
// window + 2·search must not pass FFT_PX.
#ifndef WINDOW_PX
#define WINDOW_PX 15
#endif
#ifndef SEARCH_PX
#define SEARCH_PX 8
#endif

// Side of the transform: 16, 32 or 64 in single.cl, 16 or 32 in pairs.cl and equal.cl, any length
// clFFT knows elsewhere. bytes.cl and equal_bytes.cl do without: 32 is the windows' side there.
#ifndef FFT_PX
#define FFT_PX 32
#endif

// Everything that works on pictures: neighbouring pixels of a row that a work-item holds as one
// vector. 1 on GPUs; 4, 8 or 16 on CPUs.
#ifndef VECTOR
#define VECTOR 1
#endif

// Correlation kernels: work-items that share a window or a pair (LANES · VECTOR divides FFT_PX).
#ifndef LANES
#define LANES (FFT_PX / VECTOR)
#endif

// Wherever a group is one warp of an NVIDIA device: WARP_BARRIER, defined or not. Where such a
// device multiplies matrices of bytes (compute capability 8 and above): MATRIX_UNITS, likewise. Of
// kernels that read stored pictures: WIDTH, their width, defined or not.

// equal.cl: pictures after each other that a work-group follows its windows through.
#ifndef CHAIN
#define CHAIN 1
#endif

// prefilter.cl, icgn.cl, rigid.cl, ring.cl: degree of the B-spline, 3, 5 or 7.
#ifndef SPLINE_DEGREE
#define SPLINE_DEGREE 5
#endif

// prefilter.cl: taps of the filter on each side of its middle.
#ifndef RADIUS
#define RADIUS 24
#endif

// Kernels that share one task among a group: its work-items, a power of two.
#ifndef GROUP
#define GROUP 64
#endif

// rigid.cl: parameters of the motion, 3 (u, v, rotation), 5 (a sphere: u, v, rotation vector) or 6
// (affine).
#ifndef PARAMETERS
#define PARAMETERS 3
#endif

// rigid.cl, of a sphere: 1 where its radius is a parameter more.
#ifndef FREE_RADIUS
#define FREE_RADIUS 0
#endif
// And with it, SHAPED 1, one over the camera's distance.
#ifndef FREE_DISTANCE
#define FREE_DISTANCE 0
#endif

// 1 where the light on it is known.
#ifndef LIT
#define LIT 0
#endif

// And its centre in the first picture.
#ifndef FREE_CENTRE
#define FREE_CENTRE 0
#endif

// rigid.cl, of a sphere: 1 where it is seen in perspective or out of round.
#ifndef SHAPED
#define SHAPED 0
#endif

// rigid.cl: taps on each side of its middle of the Gaussian that both pictures went through.
#ifndef SMOOTH_RADIUS
#define SMOOTH_RADIUS 2
#endif

// rigid.cl: 1 where a mask says which pixels of the first picture count.
#ifndef MASKED
#define MASKED 0
#endif

// follow.cl: lines across a rim, and how many of them reach deep, at most.
#ifndef MAX_LINES
#define MAX_LINES 736
#endif
#ifndef MAX_DEEP
#define MAX_DEEP 192
#endif

#endif  // IMPACTDIC_KERNELS_CONFIG_H_
