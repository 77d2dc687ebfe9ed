// Every -D macro of the kernels: meaning, default, constraint. Each .cl file compiles alone with
// these defaults, so that it can be linted without a device.
#ifndef IMPACTDIC_KERNELS_CONFIG_H_
#define IMPACTDIC_KERNELS_CONFIG_H_

// unpack.cl: type of a stored pixel, uchar (8-bit files) or ushort (10 to 16 bit, value low).
#ifndef PIXEL
#define PIXEL uchar
#endif

#endif  // IMPACTDIC_KERNELS_CONFIG_H_
