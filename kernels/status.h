// Why a window has no displacement, or that it has one: WindowStatus for the kernels, whose meaning
// stands there. host/dic/field.cpp does not compile where the two differ.
#ifndef IMPACTDIC_KERNELS_STATUS_H_
#define IMPACTDIC_KERNELS_STATUS_H_

#define STATUS_OK 0
#define STATUS_MASKED 1
#define STATUS_NO_TEXTURE 2
#define STATUS_LOW_CORRELATION 3
#define STATUS_AT_SEARCH_EDGE 4
#define STATUS_NOT_CONVERGED 5
#define STATUS_OUT_OF_VIEW 6

#endif  // IMPACTDIC_KERNELS_STATUS_H_
