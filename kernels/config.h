// Every -D macro of the kernels: meaning, default, constraint. Each .cl file compiles alone with
// these defaults, so that it can be linted without a device.
#ifndef IMPACTDIC_KERNELS_CONFIG_H_
#define IMPACTDIC_KERNELS_CONFIG_H_

// unpack.cl: type of a stored pixel, uchar (8-bit files) or ushort (10 to 16 bit, value low).
#ifndef PIXEL
#define PIXEL uchar
#endif

// Everything that works on pictures: neighbouring pixels of a row that a work-item holds as one
// vector. 1 on GPUs; 4, 8 or 16 on CPUs.
#ifndef VECTOR
#define VECTOR 1
#endif

// prefilter.cl, icgn.cl, rigid.cl, ring.cl: degree of the B-spline, 3, 5 or 7.
#ifndef SPLINE_DEGREE
#define SPLINE_DEGREE 5
#endif

// Kernels that share one task among a group: its work-items, a power of two.
#ifndef GROUP
#define GROUP 64
#endif

// icgn.cl: side of the window, px.
#ifndef WINDOW_PX
#define WINDOW_PX 15
#endif

#endif  // IMPACTDIC_KERNELS_CONFIG_H_
