"""Processes that share a batch, and one of them killed at a random instant.

Usage: kill_ranks.py PROGRAM [--runs 20] [--shots 40] [--ranks 4] [--mpirun] [--folder DIR]

Makes small clips, one of them broken, and has one process measure them all. Then, run after run,
several ranks share them, started by Open MPI's mpirun or, without it, as plain processes with
--share. One rank is killed (SIGKILL) at a random instant. The files of every run must be those of
the one process: none missing, none twice, none other, and their bytes the same but for times that
a run took.
"""

import argparse
import json
import os
import pathlib
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time

from kill_chains import bits

TIMES = ("frames_per_s", "checksum_wait_s")  # in summary.json: what a run took
HIDDEN = (".share", ".impactdic.lock")


def make_clips(program, folder, shots):
    folder.mkdir(parents=True)
    made = folder.parent / "made"
    for i in range(shots - 1):
        subprocess.run([program, "synth", "--size", "128x128", "--radius-px", "36", "--frames", "6",
                        "--pattern", "e1", "--velocity-px", "1,0.5", "--seed", str(i + 1), "-q",
                        "-o", str(made)], check=True, stdout=subprocess.DEVNULL)
        shutil.move(made / "video.tif", folder / f"shot_{i + 1:02}.tif")
        shutil.rmtree(made)
    (folder / "shot_99_text.cine").write_text("this is no clip")


def contents(out):
    """Relative path -> what must be the same in every run."""
    found = {}
    for path in sorted(out.rglob("*")):
        name = str(path.relative_to(out))
        if path.is_dir() or name.split("/")[0] in HIDDEN or path.name in HIDDEN:
            continue
        if path.name == "SHA256SUMS":  # of files whose times differ
            found[name] = sorted(line.split()[-1] for line in path.read_text().splitlines()
                                 if not line.startswith("#"))
        elif path.name == "summary.json":
            summary = json.loads(path.read_text())
            found[name] = {k: v for k, v in summary.items() if k not in TIMES}
        else:
            found[name] = bits(path)
    return found


def compare(expected, out, what):
    got = contents(out)
    wrong = [f"missing: {n}" for n in expected if n not in got]
    wrong += [f"not wanted: {n}" for n in got if n not in expected]
    wrong += [f"other: {n}" for n in expected if n in got and expected[n] != got[n]]
    if wrong:
        raise SystemExit(f"{what}: {len(wrong)} files are wrong, such as {wrong[:5]} in {out}")


def children(pid):
    return [int(c) for task in pathlib.Path(f"/proc/{pid}/task").glob("*/children")
            for c in task.read_text().split()]


class Ranks:
    """The ranks of one run, by mpirun or as plain processes."""

    def __init__(self, command, ranks, mpirun, name):
        self.log = tempfile.TemporaryFile("w+")
        streams = {"stdout": self.log, "stderr": subprocess.STDOUT}
        if mpirun:
            launcher = [mpirun, "-n", str(ranks), "--oversubscribe", "--enable-recovery"]
            allow = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
            self.processes = [subprocess.Popen(launcher + command, env=os.environ | allow,
                                               **streams)]
        else:
            self.processes = [subprocess.Popen(command + ["--share", name], **streams)
                              for _ in range(ranks)]
        self.mpirun = mpirun

    def pids(self):
        if self.mpirun:
            return children(self.processes[0].pid)
        return [p.pid for p in self.processes if p.poll() is None]

    def wait(self):
        statuses = [p.wait(timeout=300) for p in self.processes]
        self.log.seek(0)
        return statuses, self.log.read()


def shared_run(arguments, command, out, expected, number, alone_s):
    ranks = Ranks(command + ["-o", str(out)], arguments.ranks, arguments.mpirun, f"run-{number}")
    time.sleep(random.uniform(0.05, 1) * alone_s)
    pids = ranks.pids()
    if pids:
        try:
            os.kill(random.choice(pids), signal.SIGKILL)
        except ProcessLookupError:
            pids = []
    statuses, text = ranks.wait()
    if not arguments.mpirun and any(s not in (0, -signal.SIGKILL) for s in statuses):
        raise SystemExit(f"run {number}: status {statuses}\n{text}")
    try:
        compare(expected, out, f"run {number}")
    except SystemExit:
        print(text, file=sys.stderr)
        raise
    shutil.rmtree(out)
    return bool(pids), "is lost" in text


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("--runs", type=int, default=20)
    parser.add_argument("--shots", type=int, default=40)
    parser.add_argument("--ranks", type=int, default=4)
    parser.add_argument("--mpirun", nargs="?", const="mpirun")
    parser.add_argument("--folder", type=pathlib.Path)
    parser.add_argument("--seed", type=int)
    arguments = parser.parse_args()
    random.seed(arguments.seed)
    program = str(arguments.program.resolve())
    with tempfile.TemporaryDirectory(dir=arguments.folder) as scratch:
        scratch = pathlib.Path(scratch)
        make_clips(program, scratch / "clips", arguments.shots)
        command = [program, "batch", str(scratch / "clips"), "--fps", "10000",
                   "--ball-diameter-mm", "67"]
        begin = time.monotonic()
        subprocess.run(command + ["-q", "-o", str(scratch / "alone")], check=True)
        alone_s = time.monotonic() - begin
        expected = contents(scratch / "alone")
        killed = taken_over = 0
        for number in range(arguments.runs):
            one = shared_run(arguments, command, scratch / f"run{number}", expected, number,
                             alone_s)
            killed += one[0]
            taken_over += one[1]
            print(f"run {number + 1}: " + ("killed" if one[0] else "ended before the kill") +
                  (", its shots taken over" if one[1] else ""), flush=True)
        print(f"{arguments.runs} runs of {arguments.ranks} ranks and {arguments.shots} shots, "
              f"{killed} ranks killed, {taken_over} of them with shots in hand: every run has the "
              f"{len(expected)} files of one process")


if __name__ == "__main__":
    main()
