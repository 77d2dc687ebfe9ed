#!/usr/bin/env python3
"""How exactly the flights of flat balls are measured: velocity and spin.

Draws a clip from each number: pattern, radius 40 to 110 px, 12 to 200 frames, 0.2 to 20 degrees a
frame either way, up to 1.2 px a frame, noise 0.7 to 5; a third even, the others with a shaded side, a
bar of up to 30 %, or a lens and a shutter that blur. Makes it with `synth`, measures it with `track`,
and compares the flight that summary.json states with the truth:

    bench/flights/flat_flights.py build/release/impactdic 1 60
    bench/flights/flat_flights.py build/release/impactdic 1 60 --synth "--fixed-noise 1"

Prints, a figure: the rms and the median error, the rms of errors over what was stated, and how many
lie in the 95 % interval; and which are more than three deviations off. A clip takes some 2 s.
"""
import argparse
import json
import math
import pathlib
import random
import subprocess
import tempfile

from sphere_flights import Figure

DEGREE = math.pi / 180
PATTERNS = ('a1', 'a2', 'b1', 'b2', 'c1', 'c2', 'd1', 'd2', 'e1', 'e2', 'f1')
MOST_PIXELS = 400e6  # of a clip; longer ones get 40 frames


def picture_size(radius_px, velocity_px, frames):
    return [int(2.4 * radius_px + 40 + abs(v) * frames) for v in velocity_px]


def draw(number):
    """Options of synth, and the truth: velocity (px/frame, y down), spin (deg/frame), radius (px)."""
    rng = random.Random(number)
    pattern, radius = rng.choice(PATTERNS), rng.uniform(40, 110)
    frames = rng.choice((12, 20, 40, 100, 200))
    spin = round(rng.choice((-1, 1)) * 10 ** rng.uniform(-0.7, 1.3), 4)
    noise = rng.uniform(0.7, 5)
    velocity = [round(rng.uniform(-1.2, 1.2), 4) for _ in range(2)]
    size = picture_size(radius, velocity, frames)
    if size[0] * size[1] * frames > MOST_PIXELS:
        frames = 40
        size = picture_size(radius, velocity, frames)
    kind = rng.choice(('plain', 'plain', 'shade', 'bar', 'blur'))
    options = {'plain': [], 'shade': ['--shading', f'{rng.uniform(.1, .5):.2f}', '--lamp-deg', f'{rng.uniform(0, 360):.0f}'],
               'bar': ['--occlude', f'{rng.uniform(.1, .3):.2f}', '--bar-level', f'{rng.uniform(20, 150):.0f}'],
               'blur': ['--blur', f'{rng.uniform(.7, 1.5):.2f}', '--exposure', f'{rng.uniform(.2, .9):.2f}']}[kind]
    story = f'{kind}, {pattern}, radius {radius:.0f} px, {frames} frames, {spin:.2f} deg a frame'
    options += ['--pattern', pattern, '--seed', str(number), '--size', f'{size[0]}x{size[1]}', '--radius-px', f'{radius:.2f}',
                '--velocity-px', f'{velocity[0]:.4f},{velocity[1]:.4f}', '--rotation-deg', f'{spin:.4f}',
                '--noise', f'{noise:.2f}', '--frames', str(frames), '--format', 'mraw']
    return options, velocity, spin, radius, story


def flight_of(program, folder, options, radius_px):
    """What `track` states of the clip's flight; {} where it finds none."""
    subprocess.run([program, 'synth', '-o', folder / 'clip', '--force', '-q', *options], check=True)
    subprocess.run([program, 'track', folder / 'clip' / 'video.mraw', '-o', folder / 'out', '--force', '-q', '--fps', '1',
                    '--body', 'disc', '--radius-px', f'{0.85 * radius_px:.0f}:{1.15 * radius_px:.0f}'], check=True)
    return json.loads((folder / 'out' / 'summary.json').read_text())['impact'].get('flight') or {}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('program', type=pathlib.Path)
    parser.add_argument('first', type=int)
    parser.add_argument('last', type=int)
    parser.add_argument('--synth', default='', help='further options of synth')
    arguments = parser.parse_args()
    velocities, spins, none = Figure(), Figure(), 0
    for number in range(arguments.first, arguments.last + 1):
        options, velocity, spin, radius_px, story = draw(number)
        with tempfile.TemporaryDirectory() as folder:
            flight = flight_of(arguments.program.resolve(), pathlib.Path(folder), options + arguments.synth.split(), radius_px)
        if not flight:
            none += 1
            continue
        of = [(flight[f'v{axis}_px_per_frame'], truth, velocities, 1) for axis, truth in zip('xy', (velocity[0], -velocity[1]))]
        for told, truth, figure, unit in of + [(flight['omega_rad_per_frame'], spin, spins, DEGREE)]:
            error, stated = told['value'] / unit - truth, told['sd'] / unit
            figure.add(error, stated)
            if abs(error) > 3 * stated:
                print(f'{number}: off by {error:.6f}, {stated:.6f} stated ({story})', flush=True)
    print('velocity, px/frame:', velocities.line(6))
    print('spin, deg/frame:   ', spins.line(6))
    print('without a flight:  ', none)


if __name__ == '__main__':
    main()
