#!/usr/bin/env python3
"""Kills runs at random instants, with -9, in chains of three to five, and goes on with --resume.

What must hold: the last run ends in the same bytes as one that was never killed; what a point to go
on from (resume.json) says is measured is never given up and never measured again; no run but a
killed one ends with anything but 0.

Usage: kill_chains.py PROGRAM [--commands track,batch,correlate] [--kills 1000] [--seed 1]
                      [--folder DIR] [--frames 400] [--workers 1]
--workers N: that many chains side by side.
Prints one line a chain and a summary as JSON. Ends 1 where something did not hold.
"""

import argparse
import concurrent.futures
import json
import pathlib
import random
import shutil
import subprocess
import sys
import tempfile
import time

LONGEST_CHAIN = 5


def synth(program, folder, frames, seed):
    subprocess.run([program, "synth", "--pattern", "e1", "--size", "128x128", "--radius-px", "36",
                    "--noise", "1", "--format", "mraw", "--frames", str(frames), "--seed", str(seed),
                    "--velocity-px", "0.03,0.02", "--rotation-deg", "0.4", "-q", "-o", folder],
                   check=True)


def commands(program, made, frames):
    """name -> the command without its output folder."""
    synth(program, made / "clip", frames, 1)
    shots = made / "shots"
    shots.mkdir()
    for i in range(3):
        synth(program, made / f"shot_{i}", frames // 3, 2 + i)
        for end in ("mraw", "cihx"):
            source = made / f"shot_{i}" / f"video.{end}"
            if source.exists():
                shutil.move(source, shots / f"shot_{i}.{end}")
    clip = str(made / "clip/video.cihx")
    return {
        "track": [program, "track", clip, "-q", "--spacing", "11", "--ball-diameter-mm", "67"],
        "batch": [program, "batch", str(shots), "-q", "--spacing", "11", "--ball-diameter-mm", "67"],
        "correlate": [program, "correlate", clip, "-q", "--spacing", "11"],
    }


def bits(path):
    """What a result file says, to the last bit, whatever HDF5 made of its layout."""
    if path.suffix != ".h5":
        return path.read_bytes()
    import h5py
    with h5py.File(path) as file:
        tables = {name: (data.shape, data[()].tobytes()) for name, data in file.items()
                  if isinstance(data, h5py.Dataset)}  # a group of links shows them to viewers
        return tables, {name: str(value) for name, value in file.attrs.items()}


def results(folder):
    names = ("*.csv", "*.h5")
    files = sorted(p for name in names for p in folder.rglob(name))
    return {str(p.relative_to(folder)): bits(p) for p in files}


def measured(folder):
    """Frames that points to go on from, and finished shots, say are measured; by folder."""
    rows = {}
    for point in folder.rglob("resume.json"):
        shot = point.parent.name.removesuffix(".part")
        rows[shot if shot != folder.name else "."] = json.loads(point.read_text())["next_row"]
    return rows


def chain(command, out, whole_s, kills, random_):
    """Kills up to `kills` runs and ends one; returns how many were killed, and what was wrong."""
    killed, wrong, rows = 0, [], {}
    for _ in range(kills):
        options = ["--resume"] if out.exists() else []
        run = subprocess.Popen(command + options + ["-o", str(out)], stderr=subprocess.PIPE)
        try:
            _, err = run.communicate(timeout=random_.uniform(0, 0.5 * whole_s))
            if run.returncode != 0:
                wrong.append(f"ended {run.returncode}: {err.decode()}")
            break
        except subprocess.TimeoutExpired:
            run.kill()
            run.communicate()
            killed += 1
        now = measured(out)
        for shot, row in rows.items():
            if now.get(shot, -1) < row:
                wrong.append(f"{shot}: {row} frames were measured, {now.get(shot)} are left")
        rows = now
    last = subprocess.run(command + ["--resume", "-o", str(out)], stderr=subprocess.PIPE, text=True)
    if last.returncode != 0:
        wrong.append(f"the last run ended {last.returncode}: {last.stderr}")
    return killed, wrong


def differences(out, whole):
    """What the folder holds that a run that was never killed does not, and the other way round."""
    try:
        now = results(out)
    except OSError as error:
        return [str(error)]
    names = [k for k in set(now) | set(whole) if now.get(k) != whole.get(k)]
    wrong = [f"other bytes: {', '.join(names)}"] if names else []
    left = [str(p.relative_to(out)) for p in out.rglob("*")
            if p.suffix in (".part", ".journal", ".lock")]
    return wrong + ([f"left behind: {left}"] if left else [])


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program")
    parser.add_argument("--commands", default="track,batch,correlate")
    parser.add_argument("--kills", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--frames", type=int, default=400)
    parser.add_argument("--folder", type=pathlib.Path)
    parser.add_argument("--workers", type=int, default=1)
    given = parser.parse_args()
    made = pathlib.Path(given.folder or tempfile.mkdtemp(prefix="kill_chains_"))
    made.mkdir(parents=True, exist_ok=True)
    known = commands(str(pathlib.Path(given.program).resolve()), made, given.frames)
    names = given.commands.split(",")
    whole, whole_s = {}, {}
    for name in names:
        subprocess.run(known[name] + ["-o", made / "warm"], check=True)
        shutil.rmtree(made / "warm")
        began = time.monotonic()
        subprocess.run(known[name] + ["-o", made / f"whole_{name}"], check=True)
        whole_s[name] = time.monotonic() - began
        whole[name] = results(made / f"whole_{name}")
    killed, faults, chains = dict.fromkeys(names, 0), [], 0

    def judged(number):
        """One chain: its command, how many runs were killed, and what was wrong."""
        name, out = names[number % len(names)], made / f"out_{number}"
        random_ = random.Random(f"{given.seed} {number}")
        kills = min(random_.randint(3, LONGEST_CHAIN), given.kills)
        count, wrong = chain(known[name], out, whole_s[name], kills, random_)
        wrong += differences(out, whole[name])
        if not wrong:
            shutil.rmtree(out)
        return name, count, wrong

    with concurrent.futures.ThreadPoolExecutor(given.workers) as pool:
        running = set()
        while sum(killed.values()) < given.kills and len(faults) < 20:
            while len(running) < given.workers:
                running.add(pool.submit(judged, chains))
                chains += 1
            done, running = concurrent.futures.wait(
                running, return_when=concurrent.futures.FIRST_COMPLETED)
            for name, count, wrong in (chain_.result() for chain_ in done):
                killed[name] += count
                faults += [f"{name}: {w}" for w in wrong]
                print(f"{name}: {count} kills{''.join('; ' + w for w in wrong)}", flush=True)
        for name, count, wrong in (chain_.result() for chain_ in running):
            killed[name] += count
            faults += [f"{name}: {w}" for w in wrong]
    print(json.dumps({"kills": killed, "chains": chains, "seed": given.seed, "faults": faults}))
    if not given.folder and not faults:
        shutil.rmtree(made)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
