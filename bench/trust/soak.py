#!/usr/bin/env python3
"""Memory and open files of one long `track` and of one `batch` of many clips.

What must hold: both stay flat. From a quarter of the run on, what is resident grows by less than a
tenth and 20 MB, and no more descriptors are open at the end than there were at a quarter. Resident
are also pages of the clip and of libraries, which the system takes back when it needs them; what is
the program's own (RssAnon) is printed beside it.

Usage: soak.py PROGRAM FOLDER [--frames 1000000] [--clips 1000] [--end S]
               [--kill-every S] [--for S] [-- OPTIONS OF track]
FOLDER holds the clip: 4 KB a frame. The ball goes around in 400 frames, which are made once and
copied. --end S: a run that takes longer is stopped by Ctrl-C; the table then says of how much.
--kill-every S: the run is killed S/2 to 3/2 S seconds after it was begun or gone on with; what a
run without kills writes must be the same, tables byte for byte and fields.h5 value for value.
--for S: runs that are killed are repeated, `track` and `batch` in turn, each into a folder of its
own, until they have taken S seconds.
"""

import argparse
import math
import os
import pathlib
import random
import re
import shutil
import signal
import subprocess
import sys
import time

from kill_chains import differences, results

PERIOD = 400  # frames
BALL = ["--pattern", "e1", "--size", "64x64", "--radius-px", "20", "--noise", "1", "--format",
        "mraw", "--fps", "10000", "-q"]
SMALL = ["-q", "--spacing", "9", "--no-checksum", "--ball-diameter-mm", "67"]


def memory_mb(pid):
    """What is resident, and what of it is the program's own; None of a process that has ended."""
    status = pathlib.Path(f"/proc/{pid}/status").read_text()
    found = [re.search(rf"{name}:\s+(\d+)", status) for name in ("VmRSS", "RssAnon")]
    return [int(number[1]) / 1024 for number in found] if all(found) else None


def make_clip(program, folder, frames):
    """`frames` frames of a ball that goes around, as FOLDER/video.cihx."""
    folder.mkdir(parents=True)
    rows = [f"{32 + 4 * math.cos(2 * math.pi * k / PERIOD)},"
            f"{32 + 4 * math.sin(2 * math.pi * k / PERIOD)},{360 * k / PERIOD}"
            for k in range(min(frames, PERIOD))]
    (folder / "motion.csv").write_text("\n".join(["cx_px,cy_px,angle_deg", *rows]) + "\n")
    made = folder / "made"
    subprocess.run([program, "synth", *BALL, "--motion", folder / "motion.csv", "-o", made],
                   check=True)
    once = (made / "video.mraw").read_bytes()
    header = (made / "video.cihx").read_bytes()
    for name in (b"recordedFrame", b"totalFrame"):
        header = re.sub(b"<%s>\\d+<" % name, b"<%s>%d<" % (name, frames), header)
    (folder / "video.cihx").write_bytes(header)
    frame = len(once) // len(rows)
    with open(folder / "video.mraw", "wb") as out:
        for begin in range(0, frames, len(rows)):
            out.write(once[:frame * min(len(rows), frames - begin)])
    shutil.rmtree(made)
    return folder / "video.cihx"


def make_clips(program, folder, clips):
    folder.mkdir(parents=True)
    different = [make_clip(program, folder.parent / f"one_{i}", 20 + i) for i in range(8)]
    for i in range(clips):
        for end in (".cihx", ".mraw"):
            os.link(different[i % len(different)].with_suffix(end), folder / f"shot_{i:04}{end}")


def watched(command, end_s, progress, kill_every_s=0):
    """Runs it; returns its status, its seconds and samples of (s, progress, MB, own MB, descriptors)."""
    command = [str(part) for part in command]
    run = subprocess.Popen(command)
    began, samples, kills = time.monotonic(), [], 0

    def next_kill(now):
        return now + random.uniform(0.5, 1.5) * kill_every_s if kill_every_s > 0 else math.inf

    kill_at = next_kill(0)
    while run.poll() is None:
        now = time.monotonic() - began
        if now > kill_at:
            run.kill()
            run.wait()
            kills += 1
            run = subprocess.Popen([*command, "--resume"])
            kill_at = next_kill(now)
        try:
            memory = memory_mb(run.pid)
            files = len(os.listdir(f"/proc/{run.pid}/fd"))
            if memory is not None:
                samples.append((now, progress(), *memory, files))
        except (FileNotFoundError, ProcessLookupError):
            pass  # it has ended
        if now > end_s and end_s > 0:
            run.send_signal(signal.SIGINT)
            run.wait()
        time.sleep(0.25)
    if kill_every_s > 0:
        print(f"killed {kills} times", flush=True)
    return run.returncode, time.monotonic() - began, samples


def told(name, status, wall_s, samples, stopped, killed):
    """Prints the table; returns what is wrong. Memory of a run that was killed is not judged."""
    print(f"{name}: status {status}, {wall_s:.1f} s\ntime_s written resident_mb own_mb descriptors")
    for share in range(11):
        at = min(len(samples) - 1, share * len(samples) // 10)
        print("%.1f %s %.1f %.1f %d" % samples[at], flush=True)
    steady = samples[len(samples) // 4:max(len(samples) * 39 // 40, len(samples) // 4 + 1)]
    early = steady[:len(steady) // 6 + 1]
    memory = max(s[2] for s in early)
    files = max(s[4] for s in early)
    most, most_files = max(s[2] for s in steady), max(s[4] for s in steady[-len(early):])
    own = [max(s[3] for s in part) for part in (early, steady)]
    wrong = [] if status == (130 if stopped else 0) else [f"{name} ended {status}"]
    if not killed and most > 1.1 * memory and most > memory + 20:
        wrong.append(f"{name}: {memory:.0f} MB resident became {most:.0f} MB")
    if not killed and most_files > files:
        wrong.append(f"{name}: {files} open files became {most_files}")
    print(f"{name}: {memory:.0f} MB and {files} descriptors after a quarter, then at most "
          f"{most:.0f} MB, and {most_files} at the end; own memory {own[0]:.1f} and {own[1]:.1f} MB",
          flush=True)
    return wrong


def unlike_whole(command, out, whole):
    """What differs from a run that nobody kills."""
    if not whole.exists():
        subprocess.run([*map(str, command), str(whole)], check=True)
    return differences(out, results(whole))


def size_of(path):
    return f"{path.stat().st_size / 1e6:.1f}MB" if path.exists() else "0"


def done_clips(out):
    return len(list(out.glob("shots/*/summary.json")))


def jobs(program, given):
    """(name, command up to its folder, how far the run into a folder is) of each job."""
    small = [*SMALL, *given.options, "-o"]
    found = []
    if given.frames > 0:
        clip = make_clip(program, given.folder / "long", given.frames)
        found.append((f"track of {given.frames} frames", [program, "track", clip, *small],
                      lambda out: size_of(out / "track.csv")))
    if given.clips > 0:
        make_clips(program, given.folder / "shots", given.clips)
        found.append((f"batch of {given.clips} clips",
                      [program, "batch", given.folder / "shots", *small], done_clips))
    return found


def one_run(number, job, given):
    """Runs the job into a folder of its own; returns its seconds and what is wrong."""
    name, command, progress = job
    killed, out = given.kill_every > 0, given.folder / "out"
    began = time.strftime("%H:%M:%S")
    ended = watched([*command, out], given.end, lambda: progress(out), given.kill_every)
    print(f"run {number}, begun {began}")
    wrong = told(name, *ended, 0 < given.end < ended[1], killed)
    if (out / "track.csv").exists():
        with open(out / "track.csv", "rb") as table:
            print(f"rows: {sum(1 for _ in table) - 1}", flush=True)
    if killed:
        unlike = unlike_whole(command, out, given.folder / f"whole {name}")
        print("; ".join(unlike) or "as a run that nobody killed", flush=True)
        wrong += unlike
    shutil.rmtree(out)
    return ended[1], wrong


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program")
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--frames", type=int, default=1000000)
    parser.add_argument("--clips", type=int, default=1000)
    parser.add_argument("--end", type=float, default=0)
    parser.add_argument("--kill-every", type=float, default=0)
    parser.add_argument("--for", type=float, default=0, dest="for_s")
    parser.add_argument("options", nargs="*")
    given = parser.parse_args()
    program = str(pathlib.Path(given.program).resolve())
    shutil.rmtree(given.folder, ignore_errors=True)
    wrong, taken_s, number = [], 0, 0
    made = jobs(program, given)
    while number < len(made) or taken_s < given.for_s:
        number += 1
        seconds, unlike = one_run(number, made[(number - 1) % len(made)], given)
        taken_s, wrong = taken_s + seconds, wrong + unlike
    print(f"{number} runs, {taken_s:.0f} s: " + ("; ".join(wrong) or "all as it must be"))
    shutil.rmtree(given.folder)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
