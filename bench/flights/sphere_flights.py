#!/usr/bin/env python3
"""How exactly the flights and the poses of rendered spheres are measured.

Makes clips with `synth`, measures them with `track`, and compares with the truth:

    bench/flights/sphere_flights.py build/release/impactdic flights   60 frames each: velocity and spin
    bench/flights/sphere_flights.py build/release/impactdic turns     2000 frames each: poses

A clip a pattern, seed and speed; the seed paints the ball and chooses its axis and path. Prints, a
figure: the rms and the median error, the rms of errors over what was stated, and how many lie in
the 95 % interval. A clip of 60 frames takes some 3 s, one of 2000 some 60 s.
"""
import argparse
import csv
import json
import math
import pathlib
import random
import subprocess
import tempfile

DEGREE = math.pi / 180


class Figure:
    """Errors of one kind, and the deviations stated of them."""

    def __init__(self):
        self.rows = []

    def add(self, error, stated):
        self.rows.append((error, stated))

    def line(self, digits=5):
        errors = sorted(abs(error) for error, _ in self.rows)
        over = [error / stated for error, stated in self.rows if stated > 0]
        return (f'rms {rms(errors):.{digits}f}, median {errors[len(errors) // 2]:.{digits}f}, largest '
                f'{errors[-1]:.{digits}f}, over stated {rms(over):.2f}, inside '
                f'{sum(abs(value) < 1.96 for value in over)} of {len(over)}')


def rms(values):
    return math.sqrt(sum(value * value for value in values) / max(len(values), 1))


def times(a, b):
    """Of two unit quaternions (w, x, y, z)."""
    return (a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
            a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
            a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
            a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0])


def turned_back(q):
    return (q[0], -q[1], -q[2], -q[3])


def rotation_vector_deg(q):
    sign = -1 if q[0] < 0 else 1
    length = math.hypot(*q[1:])
    scale = 2 * math.atan2(length, sign * q[0]) / length if length > 1e-12 else 2
    return [sign * scale / DEGREE * value for value in q[1:]]


def table(path):
    with open(path, newline='') as file:
        return list(csv.DictReader(file))


def numbers(row, *names):
    return tuple(float(row[name]) if row[name] else math.nan for name in names)


def make(options, folder, pattern, seed, speed, most_px, size):
    """Renders and measures a clip in `folder`; its spin (deg) and velocity (px) a frame."""
    chance = random.Random(f'{pattern} {seed} {speed}')
    axis = [chance.gauss(0, 1) for _ in range(3)]
    spin = [speed * value / math.hypot(*axis) for value in axis]
    velocity = [chance.uniform(-most_px, most_px) for _ in range(2)]

    def run(*arguments):
        subprocess.run([options.program, *arguments, '-q'], cwd=folder, check=True)

    if not (folder / 'clip').exists():
        run('synth', '-o', 'clip', '--body', 'sphere', '--pattern', pattern, '--seed', str(seed),
            '--radius-px', str(options.radius_px), '--frames', str(options.frames), '--noise',
            str(options.noise), '--size', f'{size}x{size}', '--format', 'raw',
            '--velocity-px', f'{velocity[0]},{velocity[1]}',
            '--spin-deg', ','.join(map(str, spin)), *options.synth.split())
    run('track', 'clip/video.raw', '--raw', f'{size}x{size}x8', '--fps', '10000', '--force', '-o',
        'track', '--no-checksum', *options.track)
    return spin, velocity


def flights(options):
    figures = {}
    for pattern, seed, speed, folder in clips(options):
        size = 2 * math.ceil(options.radius_px + 72 + 15)
        spin, velocity = make(options, folder, pattern, seed, speed, 72 / options.frames * 2, size)
        impact = json.loads((folder / 'track/summary.json').read_text())['impact']
        if not impact.get('flight'):
            print(f'{pattern} {seed} {speed}: no flight')
            continue
        flight = impact['flight']
        truths = {'vx_px_per_frame': (velocity[0], 1, 'velocity, px/frame'),
                  'vy_px_per_frame': (-velocity[1], 1, 'velocity, px/frame'),
                  'omega_t_rad_per_frame': (spin[0], 1 / DEGREE, 'spin out of the plane, deg/frame'),
                  'omega_n_rad_per_frame': (spin[1], 1 / DEGREE, 'spin out of the plane, deg/frame'),
                  'omega_rad_per_frame': (spin[2], 1 / DEGREE, 'spin in the plane, deg/frame')}
        line = f'{pattern} {seed} {speed}:'
        for name, (truth, unit, kind) in truths.items():
            error = unit * flight[name]['value'] - truth
            stated = unit * flight[name]['sd']
            line += f' {error:+.5f} ({stated:.5f})'
            for key in (kind, f'{kind}, at {speed} deg'):
                figures.setdefault(key, Figure()).add(error, stated)
        print(line, flush=True)
    return figures


def turns(options):
    figures = {}
    for pattern, seed, speed, folder in clips(options):
        size = 2 * math.ceil(options.radius_px + 30 + 15)
        make(options, folder, pattern, seed, speed, 60 / options.frames, size)
        truth = table(folder / 'clip/truth.csv')
        turn = [numbers(row, 'qw', 'qx', 'qy', 'qz') for row in truth]
        once = math.ceil(360 / speed)
        own = {part: Figure() for part in ('first turn', 'later turns', 'last ten frames')}
        lost = 0
        for k, row in enumerate(table(folder / 'track/pose.csv')):
            found = numbers(row, 'qw', 'qx', 'qy', 'qz')
            if not row['origin'] or math.isnan(found[0]) or int(row['origin']) != 0:
                lost += 1
                continue
            off = times(found, turned_back(times(turn[k], turned_back(turn[0]))))
            stated = numbers(row, 'tilt_x_sd_deg', 'tilt_y_sd_deg', 'angle_sd_deg')
            for error, sd in zip(rotation_vector_deg(off), stated):
                own['first turn' if k < once else 'later turns'].add(error, sd)
                if k >= len(turn) - 10:
                    own['last ten frames'].add(error, sd)
        print(f'{pattern} {seed} {speed}: {lost} lost')
        for part, figure in own.items():
            if not figure.rows:
                continue
            print(f'  {part:16} {figure.line()}', flush=True)
            figures.setdefault(f'{part}, deg an axis', Figure()).rows += figure.rows
    return figures


def clips(options):
    for pattern in options.patterns.split(','):
        for seed in map(int, options.seeds.split(',')):
            for speed in map(float, options.speeds.split(',')):
                if options.keep:
                    folder = pathlib.Path(options.keep).resolve() / f'{pattern}-{seed}-{speed}'
                    folder.mkdir(parents=True, exist_ok=True)
                    yield pattern, seed, speed, folder
                    continue
                with tempfile.TemporaryDirectory() as folder:
                    yield pattern, seed, speed, pathlib.Path(folder)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split('\n')[0])
    parser.add_argument('program')
    parser.add_argument('what', choices=('flights', 'turns'))
    parser.add_argument('--patterns', help='default: e1,e2,b2,d2; turns: e1')
    parser.add_argument('--seeds', default='1')
    parser.add_argument('--speeds', help='deg a frame; default: 0.3,1,2.5,6; turns: 1.4')
    parser.add_argument('--frames', type=int, help='default: 60; turns: 2000')
    parser.add_argument('--radius-px', type=float, default=115)
    parser.add_argument('--noise', type=float, default=2)
    parser.add_argument('--keep', help='folder for clips and results; clips that it holds are used')
    parser.add_argument('--synth', default='', help='more options of synth, as one word')
    parser.add_argument('track', nargs='*', help='behind --: more options of track')
    options = parser.parse_args()
    options.program = str(pathlib.Path(options.program).resolve())
    whole = options.what == 'turns'
    options.patterns = options.patterns or ('e1' if whole else 'e1,e2,b2,d2')
    options.speeds = options.speeds or ('1.4' if whole else '0.3,1,2.5,6')
    options.frames = options.frames or (2000 if whole else 60)
    figures = turns(options) if whole else flights(options)
    print('all clips')
    for name, figure in figures.items():
        print(f'  {name:44} {figure.line()}')


if __name__ == '__main__':
    main()
