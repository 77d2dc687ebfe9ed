#!/usr/bin/env python3
"""make_shots.py FOLDER [--shots N] [--broken K]: a batch of filmed impacts to try things on.

Writes FOLDER/clips/shot_NN.tif and FOLDER/table.csv: a tennis ball dropped on a racket at 15, 30, 45
and 57 degrees from growing heights (sections 3.2 and 3.3 of the source, its stiffness, damping and
friction). The last K clips are broken: cut off, without a ball, no clip at all.
"""
import argparse
import math
import subprocess
import tempfile
from pathlib import Path

PROGRAM = Path(__file__).absolute().parents[1] / "build" / "release" / "impactdic"
FRICTION = {15: 0.0335, 30: 0.1068, 45: 0.19, 57: 0.35}
JOB = """
normal = "linear_spring_damper"
friction = "coulomb"
[body]
shape = "hollow_sphere"
mass_kg = 0.0567
diameter_m = 0.067
[contact]
stiffness_n_per_m = 13385.0
damping_n_s_per_m = 5.36
friction_kinetic = {friction}
[surface]
angle_deg = {angle}.0
[initial]
vt_m_s = {vt}
vn_m_s = {vn}
omega_rad_s = 0.0
"""


def film(options, number, clip):
    angles = list(FRICTION)
    angle = angles[number % len(angles)]
    height_mm = 200 + 50 * (number // len(angles))
    speed = math.sqrt(2 * 9.81 * 1e-3 * height_mm)
    slope = math.radians(angle)
    with tempfile.TemporaryDirectory() as scratch:
        job = Path(scratch) / "job.toml"
        job.write_text(JOB.format(friction=FRICTION[angle], angle=angle,
                                  vt=-speed * math.sin(slope), vn=-speed * math.cos(slope)))
        run(options, "--simulate", job, "--frames", 120, "--seed", number + 1, "-o",
            Path(scratch) / "clip")
        (Path(scratch) / "clip" / "video.tif").replace(clip)
    return f"{clip.name},{angle},{height_mm},"


def run(options, *arguments):
    size = 4 * options.radius_px
    common = ["synth", "-q", "--size", f"{size}x{size}", "--radius-px", options.radius_px]
    subprocess.run([str(a) for a in [options.program, *common, *arguments]], check=True)


def break_clip(options, kind, clip):
    """The clip as a camera, a disk or a person breaks it."""
    if kind == 0:
        clip.write_bytes(clip.read_bytes()[: clip.stat().st_size // 2])
    elif kind == 1:
        with tempfile.TemporaryDirectory() as scratch:
            run(options, "--pattern", "none", "--white", 30, "--frames", 20, "-o",
                Path(scratch) / "clip")
            (Path(scratch) / "clip" / "video.tif").replace(clip)
    else:
        clip.write_text("this is no clip\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--shots", type=int, default=8)
    parser.add_argument("--broken", type=int, default=0)
    parser.add_argument("--radius-px", type=int, default=60)
    parser.add_argument("--program", type=Path, default=PROGRAM)
    options = parser.parse_args()
    clips = options.folder / "clips"
    clips.mkdir(parents=True)
    rows = ["file,surface_angle_deg,drop_height_mm,notes"]
    for number in range(options.shots):
        clip = clips / f"shot_{number + 1:02}.tif"
        rows.append(film(options, number, clip))
        left = options.shots - number
        if left <= options.broken:
            break_clip(options, left % 3, clip)
            rows[-1] += "broken"
    (options.folder / "table.csv").write_text("\n".join(rows) + "\n")


if __name__ == "__main__":
    main()
