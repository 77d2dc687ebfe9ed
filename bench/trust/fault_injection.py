#!/usr/bin/env python3
"""`track` of 100 small frames with one call after the other failing: writes, reads, opens, renames
and truncations of files, large allocations, and calls of OpenCL.

What must hold: the run ends 0, or 1 with one line; what is on the disk then can be read and holds
nothing but what a whole run holds; --resume without faults ends in the same bytes.

Usage: fault_injection.py PROGRAM SHIM [--kinds write,read,...] [--every 1] [--first 1] [--from]
                          [--workers 1] [--most N]
SHIM: the library of tests/support/fault_shim.c. --every N: every N-th call alone, beginning with
--first; --most N: at most N of a kind. --from: that call and all behind it fail, as on a disk that stays full or a device that is
gone. --workers N: that many runs side by side.
"""

import argparse
import collections
import concurrent.futures
import errno
import json
import os
import pathlib
import queue
import re
import shutil
import subprocess
import sys
import tempfile

import h5py
import numpy as np

KINDS = {"write": errno.ENOSPC, "read": errno.EIO, "open": errno.EMFILE, "rename": errno.EDQUOT,
         "truncate": errno.EIO, "alloc": errno.ENOMEM, "device": 0}
LONGEST_S, HUNG = 60, 124  # a run takes about a second
COLUMNS = 16  # of track.csv that do not hang on the scale, known only when the clip is done


def run(program, folder, options, fault):
    clip = str(folder / "clip/video.cihx")
    command = [program, "track", clip, "-q", "-j2", "--spacing", "13", "-o", str(folder / "out"),
               *options]
    try:
        return subprocess.run(command, env=os.environ | fault, capture_output=True, text=True,
                              timeout=LONGEST_S)
    except subprocess.TimeoutExpired:
        return subprocess.CompletedProcess(command, HUNG, "", f"no end within {LONGEST_S} s")


def table(path):
    """The whole lines of a table, as cells."""
    text = path.read_text()
    return [line.split(",")[:COLUMNS] for line in text[:text.rfind("\n") + 1].splitlines()]


def fields(path):
    with h5py.File(path) as file:
        return {name: data[()] for name, data in file.items() if isinstance(data, h5py.Dataset)}


def untrue(out, whole):
    """What the folder holds that the whole run does not."""
    wrong = []
    for name in ("track.csv", "pose.csv"):
        if not (out / name).exists():
            continue
        rows = table(out / name)
        want = whole[name][:len(rows)]
        # The last row of a run that was cut short has no next frame.
        if rows[:-1] != want[:-1]:
            wrong.append(f"{name} differs")
    if (out / "fields.h5").exists() and (out / "fields.h5").stat().st_size > 0:
        try:
            for name, values in fields(out / "fields.h5").items():
                rows = max(len(values) - 1, 0)  # the last one has no next frame here either
                want = whole["fields.h5"][name][:rows]
                if rows and not np.array_equal(values[:rows], want, equal_nan=True):
                    wrong.append(f"fields.h5, {name} differs")
        except (OSError, KeyError) as error:
            wrong.append(f"fields.h5: {error}")
    for name in ("summary.json", "resume.json"):
        if (out / name).exists():
            try:
                json.loads((out / name).read_text())
            except ValueError as error:
                wrong.append(f"{name}: {error}")
    return wrong


def results(out):
    found = {name: (out / name).read_bytes() for name in ("track.csv", "pose.csv")}
    tables = fields(out / "fields.h5")
    return found | {name: (a.shape, a.tobytes()) for name, a in tables.items()}


class Trial:
    """One folder with a clip, in which runs fail one after the other."""

    def __init__(self, program, shim, clip, folder):
        self.program, self.shim, self.folder, self.out = program, shim, folder, folder / "out"
        folder.mkdir()
        shutil.copytree(clip, folder / "clip")

    def whole(self):
        """What a run without faults makes."""
        first = run(self.program, self.folder, [], {})
        assert first.returncode == 0, first.stderr
        tables = {name: table(self.out / name) for name in ("track.csv", "pose.csv")}
        return tables | {"fields.h5": fields(self.out / "fields.h5")}, results(self.out)

    def fault(self, kind, call, behind):
        return {"LD_PRELOAD": self.shim, "FAULT_FOLDER": str(self.folder), "FAULT_KIND": kind,
                "FAULT_ERRNO": str(KINDS[kind]), "FAULT_AT": str(call),
                "FAULT_FROM": str(int(behind))}

    def count(self, kind):
        shutil.rmtree(self.out, ignore_errors=True)
        count = self.folder / "count"
        run(self.program, self.folder, [],
            self.fault(kind, 0, False) | {"FAULT_COUNT": str(count)})
        return int(count.read_text())

    def fail(self, kind, call, behind, whole, same):
        """How a run ends whose call fails, and what is wrong with it."""
        shutil.rmtree(self.out, ignore_errors=True)
        ended = run(self.program, self.folder, [], self.fault(kind, call, behind))
        # The compiler of the device library ends its process where memory is refused.
        if kind == "alloc" and ended.returncode < 0 and "LLVM ERROR" in ended.stderr:
            return "ended by the device library", []
        # The device library's compiler counts its warnings by itself, where it compiles.
        lines = [line for line in ended.stderr.splitlines()
                 if not re.fullmatch(r"\d+ (warning|error)s? generated\.", line)]
        wrong = untrue(self.out, whole) if self.out.exists() else []
        if ended.returncode not in (0, 1):
            wrong.append(f"ended {ended.returncode}: {ended.stderr[-300:]}")
        elif ended.returncode == 1 and (len(lines) != 1 or
                                        not lines[0].startswith("impactdic: error: ")):
            wrong.append(f"said: {ended.stderr[-300:]}")
        again = run(self.program, self.folder, ["--resume"], {})
        if again.returncode != 0:
            wrong.append(f"--resume ended {again.returncode}: {again.stderr[-300:]}")
        elif results(self.out) != same:
            wrong.append("--resume ends in other bytes")
        return f"ended {ended.returncode}", wrong


def fail_all(given, trials, kind, calls, whole, same):
    """Tries the calls of one kind, as many side by side as there are trials; returns the faults."""
    free, faults, ends = queue.Queue(), [], collections.Counter()
    for trial in trials:
        free.put(trial)

    def one(call):
        trial = free.get()
        try:
            return call, *trial.fail(kind, call, given.behind, whole, same)
        finally:
            free.put(trial)

    with concurrent.futures.ThreadPoolExecutor(len(trials)) as pool:
        step = max(given.every, -(-calls // given.most) if given.most else 1)
        asked = [pool.submit(one, call) for call in range(given.first, calls + 1, step)]
        for done in concurrent.futures.as_completed(asked):
            call, end, wrong = done.result()
            ends[end] += 1
            if sum(ends.values()) % 100 == 0:
                print(f"{kind}: {sum(ends.values())} tried, {len(faults)} faults", flush=True)
            for what in wrong:
                faults.append(f"{kind} {call} of {calls}: {what}")
                print(faults[-1], flush=True)
    print(f"{kind}: {sum(ends.values())} of {calls} calls; " +
          ", ".join(f"{n} {end}" for end, n in sorted(ends.items())), flush=True)
    return faults, sum(ends.values())


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program")
    parser.add_argument("shim")
    parser.add_argument("--kinds", default=",".join(KINDS))
    parser.add_argument("--every", type=int, default=1)
    parser.add_argument("--first", type=int, default=1)
    parser.add_argument("--most", type=int, default=0)
    parser.add_argument("--from", dest="behind", action="store_true")
    parser.add_argument("--workers", type=int, default=1)
    given = parser.parse_args()
    folder = pathlib.Path(tempfile.mkdtemp(prefix="fault_injection_"))
    subprocess.run([given.program, "synth", "--pattern", "e1", "--size", "96x96", "--radius-px",
                    "28", "--noise", "1", "--format", "mraw", "--frames", "100", "--velocity-px",
                    "0.1,0.05", "--rotation-deg", "0.5", "-q", "-o", folder / "clip"], check=True)
    trials = [Trial(given.program, given.shim, folder / "clip", folder / str(n))
              for n in range(given.workers)]
    whole, same = trials[0].whole()
    faults, runs = [], {}
    for kind in given.kinds.split(","):
        calls = trials[0].count(kind)
        wrong, runs[kind] = fail_all(given, trials, kind, calls, whole, same)
        faults += wrong
    print(json.dumps({"runs": runs, "faults": faults}))
    shutil.rmtree(folder)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
