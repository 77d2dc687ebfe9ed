#!/usr/bin/env python3
"""python_memory.py map [GB [SIDE]] | leak [RUNS]: what the Python package keeps in memory.

map: a sparse file of GB (20) with frames of SIDE x SIDE (1024) bytes, memory-mapped and tracked to
its end; prints the most that the process held. The frames are black: what counts is that all of
their pages were read. leak: RUNS (1000) runs of track and correlate, and how much the process has grown since run 50.
"""

import gc
import os
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

SOURCE = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(SOURCE / "scripts"), str(SOURCE / "build" / "release" / "host" / "python")]
import impactdic as idic  # noqa: E402


def megabytes(name):
    with open("/proc/self/status", encoding="ascii") as file:
        return next(int(line.split()[1]) for line in file if line.startswith(name)) / 1e3


def read_map(gigabytes, side):
    count = int(gigabytes * 1e9) // side**2
    with tempfile.NamedTemporaryFile(suffix=".raw") as file:
        file.truncate(count * side**2)
        mapped = np.memmap(file.name, np.uint8, "r", shape=(count, side, side))
        start = time.monotonic()
        # A strip alone is looked at; it touches every page of the file.
        shot = idic.track(mapped, no_field=True, radius_px=(20, 28), roi=(0, 0, 64, side))
        seconds = time.monotonic() - start
    print(f"{count} frames, {mapped.nbytes / 1e9:.1f} GB, {len(shot.track)} rows in {seconds:.0f} s; "
          f"the process held {megabytes('VmHWM'):.0f} MB at most")


def leak(runs):
    film, _ = idic.synth(frames=3, radius_px=20, size=(60, 60), velocity_px=(0.7, -0.4))
    for run in range(runs):
        idic.track(film, no_field=True)
        idic.correlate(film[0], film[1], window=15, spacing=10)
        if run == 50:
            gc.collect()
            before, files = megabytes("VmRSS"), len(os.listdir("/proc/self/fd"))
    gc.collect()
    print(f"{runs} runs: grown by {megabytes('VmRSS') - before:.1f} MB since run 50, by "
          f"{len(os.listdir('/proc/self/fd')) - files} open files, "
          f"{sys.getrefcount(film) - 2} references to the film beside its name")


if __name__ == "__main__":
    numbers = [float(word) for word in sys.argv[2:]]
    if sys.argv[1:2] == ["map"]:
        read_map((numbers + [20.0])[0], int((numbers[1:] + [1024])[0]))
    elif sys.argv[1:2] == ["leak"]:
        leak(int((numbers or [1000])[0]))
    else:
        sys.exit(__doc__)
