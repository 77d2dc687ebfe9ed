#!/bin/sh
# Compiles every kernel alone with the defaults of kernels/config.h, and the variants that the host
# asks for, with all warnings as errors. Needs clang, no device. Exit 77: no clang.
#   lint_kernels.sh REPOSITORY
cd "$1" || exit 1
command -v clang >/dev/null || { echo "lint_kernels.sh: clang is not installed"; exit 77; }
lint() {
  clang -x cl -cl-std=CL1.2 -fsyntax-only -Wall -Wextra -Wdouble-promotion -Werror -I. "$@" || bad=1
}
# Also what the compiler says only when it optimises, as PoCL's does on a CPU: such a warning reaches
# the terminal of a user.
lint_built() {
  clang -x cl -cl-std=CL1.2 -O1 -S -emit-llvm -o /dev/null -Wall -Wextra -Wdouble-promotion -Werror \
    -Wno-psabi -I. "$@" || bad=1
}
bad=0
for file in kernels/*.cl kernels/*/*.cl; do lint "$file"; done
for size in 16 32 64; do
  lint -DFFT_PX=$size -DWINDOW_PX=5 -DSEARCH_PX=3 kernels/zncc/single.cl
  [ $size = 64 ] && continue
  lint -DFFT_PX=$size -DWINDOW_PX=5 -DSEARCH_PX=3 kernels/zncc/pairs.cl
  lint -DFFT_PX=$size -DCHAIN=8 kernels/equal/equal.cl
done
lint -DMASKED=1 kernels/ball/rigid.cl
lint -DPARAMETERS=5 -DLIT=1 kernels/ball/rigid.cl
lint -DPARAMETERS=5 -DSHAPED=1 -DLIT=1 -DFREE_RADIUS=1 kernels/ball/rigid.cl
lint -DPARAMETERS=5 -DSHAPED=1 -DFREE_RADIUS=1 -DFREE_DISTANCE=1 kernels/ball/rigid.cl
# What only NVIDIA's compiler sees otherwise; clang knows `asm` by another name.
for size in 15,8 31,16; do
  lint -target nvptx64 -Dasm=__asm__ -DMATRIX_UNITS -DWARP_BARRIER -DLANES=32 \
    -DWINDOW_PX=${size%,*} -DSEARCH_PX=${size#*,} kernels/zncc/bytes.cl
done
lint -target nvptx64 -Dasm=__asm__ -DMATRIX_UNITS -DWARP_BARRIER kernels/equal/equal_bytes.cl
for vector in 4 8 16; do
  for size in 16 32 64; do
    lint_built -DVECTOR=$vector -DLANES=1 -DFFT_PX=$size -DWINDOW_PX=5 -DSEARCH_PX=3 kernels/zncc/single_vector.cl
    [ $size = 64 ] || [ $vector = $size ] && continue
    lint_built -DVECTOR=$vector -DLANES=1 -DFFT_PX=$size -DWINDOW_PX=5 -DSEARCH_PX=3 kernels/zncc/pairs_vector.cl
    lint_built -DVECTOR=$vector -DLANES=1 -DFFT_PX=$size kernels/equal/equal.cl
  done
  for file in frames/prefilter icgn/icgn ball/rigid; do lint_built -DVECTOR=$vector -DGROUP=1 kernels/$file.cl; done
  lint_built -DVECTOR=$vector -DGROUP=1 -DPARAMETERS=5 -DSHAPED=1 -DLIT=1 kernels/ball/rigid.cl
done
exit $bad
