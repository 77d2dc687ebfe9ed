#!/usr/bin/env python3
"""Circles of spheres before even backgrounds, under a lamp: what `track --no-field` makes of them.

Paints a sphere that flies by 4 px in six frames and does not turn, so that the same ink lies at its
rim in all of them, and compares the mean of each ball's errors with the median of what is stated.

    bench/film/sphere_grounds.py build/release/impactdic FIRST LAST [--patterns e1,...]
                                 [--backgrounds 30,60,90] [--lamp 0.2] [--elevation-deg 0]
                                 [--radius-px 60] [--noise 2] [--body sphere]

One line a pattern and background, over the seeds: balls measured; rms error of the centre (px, both
axes), over stated, its mean along x and y; the same of the radius; balls that are more than four
deviations and 0.02 px off. A clip takes 0.3 s.
"""
import argparse
import csv
import math
import os
import pathlib
import statistics
import subprocess
import tempfile
from concurrent.futures import ThreadPoolExecutor

FIGURES = ('cx_px', 'cy_px', 'r_px')
FRAMES, MOVES = 6, '0.37,0.7'


def parsed():
    parser = argparse.ArgumentParser(description=__doc__.split('\n')[0])
    parser.add_argument('program')
    parser.add_argument('first', type=int)
    parser.add_argument('last', type=int)
    parser.add_argument('--patterns', default='e1,a2,d2,b2,c3,f1,e2,d1')
    parser.add_argument('--backgrounds', default='30,60,90')
    parser.add_argument('--lamp', default='0.2')
    parser.add_argument('--elevation-deg', default='0', help='of the lamp, towards the camera')
    parser.add_argument('--radius-px', type=float, default=60)
    parser.add_argument('--noise', default='2')
    parser.add_argument('--body', default='sphere', choices=('sphere', 'disc'))
    return parser.parse_args()


def errors(arguments, pattern, background, seed):
    """Of each figure its error in the mean of the frames and the deviation stated; none of a ball
    that was not measured."""
    side = int(2.4 * arguments.radius_px) + 60
    light = []
    if arguments.body == 'sphere':
        light = ['--body', 'sphere', '--lamp', arguments.lamp, '--lamp-elevation-deg',
                 arguments.elevation_deg]
    with tempfile.TemporaryDirectory() as temporary:
        clip, out = pathlib.Path(temporary) / 'clip', pathlib.Path(temporary) / 'track'
        subprocess.run([arguments.program, 'synth', '-o', clip, '--frames', str(FRAMES), '--size',
                        f'{side}x{side}', '--radius-px', str(arguments.radius_px), '--seed', str(seed),
                        '--pattern', pattern, '--background', str(background), '--noise', arguments.noise,
                        '--velocity-px', MOVES, '--format', 'mraw', '-q', *light], check=True)
        subprocess.run([arguments.program, 'track', clip / 'video.cihx', '-o', out, '--no-field', '-q'],
                       check=False, capture_output=True)
        if not (out / 'track.csv').exists():
            return None
        with open(clip / 'truth.csv', newline='') as file:
            truth = list(csv.DictReader(file))
        with open(out / 'track.csv', newline='') as file:
            rows = [row for row in csv.DictReader(file) if row['status'] in ('ok', 'last_frame')]
    if not rows:
        return None
    told = []
    for figure in FIGURES:
        off = [float(row[figure]) - float(truth[int(row['frame'])][figure]) for row in rows]
        stated = [float(row[figure.replace('_px', '_sd_px')]) for row in rows]
        told.append((statistics.fmean(off), statistics.median(stated)))
    return told


def rms(values):
    return math.sqrt(statistics.fmean(value * value for value in values))


def line(name, balls, asked):
    x, y, r = ([ball[k] for ball in balls] for k in range(3))
    wrong = sum(any(abs(off) > 4 * sd and abs(off) > 0.02 for off, sd in ball) for ball in balls)
    return (f'{name}: {len(balls)} of {asked}, centre {rms([off for off, _ in x + y]):.4f} px, '
            f'{rms([off / sd for off, sd in x + y]):.2f}, mean {statistics.fmean(o for o, _ in x):+.4f} '
            f'{statistics.fmean(o for o, _ in y):+.4f}; radius {rms([off for off, _ in r]):.4f} px, '
            f'{rms([off / sd for off, sd in r]):.2f}, mean {statistics.fmean(o for o, _ in r):+.4f}; '
            f'{wrong} wrong')


def main():
    arguments = parsed()
    seeds = range(arguments.first, arguments.last + 1)
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        for background in arguments.backgrounds.split(','):
            for pattern in arguments.patterns.split(','):
                told = pool.map(lambda seed: errors(arguments, pattern, background, seed), seeds)
                balls = [ball for ball in told if ball]
                if balls:
                    print(line(f'{pattern} before {background}', balls, len(seeds)), flush=True)
                else:
                    print(f'{pattern} before {background}: none of {len(seeds)}', flush=True)


if __name__ == '__main__':
    main()
