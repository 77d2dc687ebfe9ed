#!/usr/bin/env python3
"""Two runs of `track` at the same time into one folder, and two from an empty kernel cache.

What must hold: of two runs into one folder one ends 0 and the other 1 with a line that names who
holds it (or 0, where it began when the first was done); what is there then has the bytes of a run
alone. Two runs with one cache both end 0 with the bytes of a run alone, and so does the next.

Usage: two_runs.py PROGRAM [--tries 100] [--kinds one_folder,one_cache] [--workers 1] [--seed 1]
                   [--keep-pocl]
--keep-pocl: PoCL's own cache is kept from pair to pair; the program's is empty for each. What is in
PoCL's saves the compiling, so that many pairs can be tried.
"""

import argparse
import concurrent.futures
import json
import os
import pathlib
import random
import shutil
import subprocess
import sys
import tempfile
import time

from kill_chains import differences, results, synth

KEEP_POCL = "--keep-pocl" in sys.argv
ONE_LINE = "impactdic: error: "


def command(program, clip, out):
    return [program, "track", str(clip), "-q", "--spacing", "13", "--force", "-o", str(out)]


def both(commands, pause_s, environment):
    """Status and last words of two runs, the second begun `pause_s` behind the first."""
    runs = []
    for one in commands:
        runs.append(subprocess.Popen(one, env=os.environ | environment, stderr=subprocess.PIPE,
                                     text=True))
        if len(runs) == 1:
            time.sleep(pause_s)
    said = [run.communicate(timeout=300)[1] for run in runs]
    return [(run.returncode, text) for run, text in zip(runs, said)]


def one_folder(program, clip, folder, whole, pause_s):
    """"refused" or "one after the other", and what is wrong."""
    out = folder / "out"
    ends = both([command(program, clip, out)] * 2, pause_s, {})
    wrong = differences(out, whole)
    for status, text in ends:
        one_line = len(text.splitlines()) == 1 and text.startswith(ONE_LINE)
        if status not in (0, 1) or (status == 1 and not (one_line and "process " in text)):
            wrong.append(f"ended {status}: {text}")
    statuses = sorted(status for status, _ in ends)
    if statuses[0] != 0:
        wrong.append("none of the two did it")
    return ("refused" if statuses == [0, 1] else "one after the other"), wrong


def one_cache(program, clip, folder, whole, pause_s):
    cache = {"IMPACTDIC_CACHE_DIR": str(folder / "cache")}
    if not KEEP_POCL:
        cache["POCL_CACHE_DIR"] = str(folder / "pocl")
        (folder / "pocl").mkdir()
    outs = [folder / name for name in ("first", "second", "third")]
    ends = both([command(program, clip, out) for out in outs[:2]], pause_s, cache)
    ends += both([command(program, clip, outs[2])], 0, cache)
    wrong = [f"ended {status}: {text}" for status, text in ends if status != 0]
    for out in outs:
        wrong += differences(out, whole)
    return "both", wrong


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program")
    parser.add_argument("--tries", type=int, default=100)
    parser.add_argument("--workers", type=int, default=1)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--keep-pocl", action="store_true")
    parser.add_argument("--kinds", default="one_folder,one_cache")
    given = parser.parse_args()
    made = pathlib.Path(tempfile.mkdtemp(prefix="two_runs_"))
    program = str(pathlib.Path(given.program).resolve())
    synth(program, made / "clip", 60, 1)
    clip = made / "clip/video.cihx"
    began = time.monotonic()
    for name in ("warm", "whole"):
        began = time.monotonic()
        subprocess.run(command(program, clip, made / name), check=True)
    alone_s = time.monotonic() - began
    whole, faults, ends = results(made / "whole"), [], {}

    def tried(kind, number):
        random_ = random.Random(f"{given.seed} {kind.__name__} {number}")
        folder = made / f"{kind.__name__}_{number}"
        folder.mkdir()
        end, wrong = kind(program, clip, folder, whole, random_.uniform(0, 0.8 * alone_s))
        if not wrong:
            shutil.rmtree(folder)
        return end, wrong

    with concurrent.futures.ThreadPoolExecutor(given.workers) as pool:
        for kind in [one for one in (one_folder, one_cache) if one.__name__ in given.kinds]:
            counts = ends[kind.__name__] = {}
            for end, wrong in pool.map(lambda n, kind=kind: tried(kind, n), range(given.tries)):
                counts[end] = counts.get(end, 0) + 1
                faults += [f"{kind.__name__}: {w}" for w in wrong]
            print(f"{kind.__name__}: {counts}, {len(faults)} faults", flush=True)
    print(json.dumps({"ends": ends, "faults": faults[:20]}))
    if not faults:
        shutil.rmtree(made)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
