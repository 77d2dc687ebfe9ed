#!/usr/bin/env python3
"""Resident memory of `impactdic track` over a long clip.

memory_run.py IMPACTDIC FOLDER FRAMES [options of track]

Makes a clip of a ball of radius 40 px that goes around in 128 x 128 pixels (FOLDER/long.mraw, 16 KB a
frame; kept), measures it, samples the process's VmRSS five times a second, and prints it against the
rows that were written by then, and its growth per frame over the last half of the run.
"""

import math
import pathlib
import shutil
import subprocess
import sys
import time


def make_clip(program, folder, frames):
    clip = folder / "long"
    if (clip / "video.cihx").exists():
        return clip / "video.cihx"
    folder.mkdir(parents=True, exist_ok=True)
    with open(folder / "motion.csv", "w") as out:
        out.write("cx_px,cy_px,angle_deg\n")
        for k in range(frames):
            turn = 2 * math.pi * k / 400
            out.write(f"{64 + 12 * math.cos(turn)},{62 + 12 * math.sin(turn)},{0.7 * k}\n")
    subprocess.run([program, "synth", "--pattern", "e1", "--size", "128x128", "--radius-px", "40",
                    "--noise", "1", "--format", "mraw", "--motion", folder / "motion.csv", "-q",
                    "--fps", "10000", "-o", clip], check=True)
    return clip / "video.cihx"


def resident_mb(pid):
    with open(f"/proc/{pid}/status") as lines:
        for line in lines:
            if line.startswith("VmRSS:"):
                return int(line.split()[1]) / 1024
    return None


def rows_written(table):
    try:
        with open(table, "rb") as file:
            lines = sum(block.count(b"\n") for block in iter(lambda: file.read(1 << 20), b""))
            return max(0, lines - 1)
    except FileNotFoundError:
        return 0


def main():
    program, folder, frames = sys.argv[1], pathlib.Path(sys.argv[2]), int(sys.argv[3])
    clip = make_clip(program, folder, frames)
    results = folder / "results"
    shutil.rmtree(results, ignore_errors=True)
    run = subprocess.Popen([program, "track", clip, "-o", results, "--force", "-q", *sys.argv[4:]])
    samples = []
    begin = time.monotonic()
    while run.poll() is None:
        memory = resident_mb(run.pid)
        rows = rows_written(results / "track.csv")
        if memory is not None:
            samples.append((time.monotonic() - begin, rows, memory))
        time.sleep(0.2)
    if run.returncode != 0:
        sys.exit(run.returncode)
    print(f"{frames} frames in {time.monotonic() - begin:.1f} s")
    print("time_s rows resident_mb")
    for share in range(0, 11):
        print("%.1f %d %.1f" % samples[min(len(samples) - 1, share * len(samples) // 10)])
    steady = [s for s in samples if frames / 2 <= s[1] < frames - 1]
    if len(steady) > 1 and steady[-1][1] > steady[0][1]:
        growth = (steady[-1][2] - steady[0][2]) * 2**20 / (steady[-1][1] - steady[0][1])
        print(f"growth in the last half: {growth:.0f} bytes a frame")


if __name__ == "__main__":
    main()
