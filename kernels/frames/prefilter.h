// How prefilter.cl shares the pixels of a picture among work-items; for the host, which launches it.
#ifndef IMPACTDIC_KERNELS_PREFILTER_H_
#define IMPACTDIC_KERNELS_PREFILTER_H_

// Where VECTOR is 1: columns that a work-item filters along x, and the work-items of a group, along
// x and y.
#define PREFILTER_ACROSS 4
#define PREFILTER_ITEMS 32
#define PREFILTER_LINES 4
// Rows that a work-item filters along y, and rows of which it works out the slopes: every value
// that it reads serves all of them.
#define PREFILTER_DOWN 8
#define GRADIENT_DOWN 4

#endif  // IMPACTDIC_KERNELS_PREFILTER_H_
