#!/bin/sh
# Runs a case of every_kernel in oclgrind and fails where it sees an access out of bounds or a race.
# Exit 77: no oclgrind.
#   oclgrind_kernels.sh PROGRAM CASE
command -v oclgrind >/dev/null || { echo "oclgrind_kernels.sh: oclgrind is not installed"; exit 77; }
log=$(mktemp)
trap 'rm -f "$log"' EXIT
oclgrind --data-races --log "$log" "$@" || { cat "$log"; exit 1; }
# clFFT's own kernels transform in place behind a local fence only: not ours to judge.
if grep 'Kernel:' "$log" | grep -qvE 'Kernel: fft_(fwd|back)$'; then
  head -c 4000 "$log"
  exit 1
fi
