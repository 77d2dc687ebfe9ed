// How unpack.cl shares pixels among work-items; for the host, which launches it.
#ifndef IMPACTDIC_KERNELS_UNPACK_H_
#define IMPACTDIC_KERNELS_UNPACK_H_

// Pixels of a work-item.
#define UNPACK_AT_ONCE 8

#endif
