#!/usr/bin/env python3
"""What `track` makes of balls as they are sold: with a seam, a logo, dimples, or next to nothing.

Paints spheres of R 60 px under a lamp that fly and turn (60 frames of 400 x 300 pixels, noise 2),
tracks them without options but the rate, and compares the rows with the truth.

    bench/film/sold_balls.py build/release/impactdic FIRST LAST [NAME,...] [OPTION OF TRACK ...]

One line a ball over the seeds: rows with status ok that state a turn; rows of those by more than
five stated deviations and 0.02 px or degrees off; rms errors over stated deviations of centre,
displacement and turn; what the ball was taken for. Needs numpy. A clip takes 5 s, a seam 40 s.
"""
import argparse
import collections
import csv
import json
import pathlib
import subprocess
import sys
import tempfile

import numpy as np

WIDTH, HEIGHT, RADIUS, FRAMES = 400, 300, 60, 60
FINER = 4  # samples a pixel and axis
NOISE, BACKGROUND, LAMP = 2.0, 25.0, 0.3
TO_LAMP = np.array([-0.5, -0.6, 0.62]) / np.linalg.norm([-0.5, -0.6, 0.62])
ROW = {'centre': ('cx_px', 'cy_px'), 'step': ('dx_px', 'dy_px'),
       'turn': ('rot_x_deg', 'rot_y_deg', 'rot_deg')}


def angle(points, to):
    return np.arccos(np.clip(points @ (np.asarray(to, float) / np.linalg.norm(to)), -1, 1))


def latitude(points, pole):
    return np.pi / 2 - angle(points, pole)


def filled(inside):
    """1 where `inside`, an angle, is positive; an edge is a pixel wide."""
    return np.clip(0.5 + inside * RADIUS, 0, 1)


def even_points(count):
    i = np.arange(count) + 0.5
    z = 1 - 2 * i / count
    turn = np.pi * (1 + 5 ** 0.5) * i
    return np.stack([np.sqrt(1 - z * z) * np.cos(turn), np.sqrt(1 - z * z) * np.sin(turn), z], 1)


def nearest(points, others):
    return np.arccos(np.clip((points @ np.asarray(others).T).max(axis=1), -1, 1))


# Grey levels of points on the unit sphere.

def tennis(points):
    t = np.linspace(0, 2 * np.pi, 1600)
    seam = np.stack([0.75 * np.cos(t) + 0.25 * np.cos(3 * t),
                     0.75 * np.sin(t) - 0.25 * np.sin(3 * t), 2 * np.sqrt(0.1875) * np.sin(2 * t)], 1)
    seam /= np.linalg.norm(seam, axis=1)[:, None]
    distance = np.concatenate([nearest(part, seam) for part in np.array_split(points, 64)])
    return 150 + 80 * filled(0.03 - distance)


def logo(points):
    random = np.random.default_rng(5)
    level = np.full(len(points), 200.0)
    for k in range(14):
        place = np.array([0.35 * (k % 7 - 3) / 3, 0.24 * (k // 7 - 0.5), 1.0])
        place[:2] += random.normal(0, 0.02, 2)
        level -= 150 * filled(0.05 + 0.02 * random.random() - angle(points, place))
    return level


def two_tone(points):
    return 120 + 90 * np.tanh(RADIUS * (points @ np.array([0.5, 0.3, 0.8])))


def football(points):
    golden = (1 + 5 ** 0.5) / 2
    corners = [np.roll([0, a, b * golden], k) for a in (-1, 1) for b in (-1, 1) for k in range(3)]
    corners = np.array(corners) / np.hypot(1, golden)
    return 210 - 170 * filled(0.35 - nearest(points, corners))


def pool_stripe(points):
    return 90 + 140 * filled(np.abs(latitude(points, [0.3, 0.8, 0.52])) - 0.45)


def golf(points):
    return 215 - 45 * np.exp(-(nearest(points, even_points(330)) / 0.06) ** 2)


def dots(points):
    level = np.full(len(points), 60.0)
    for place in even_points(9) + np.random.default_rng(3).normal(0, 0.2, (9, 3)):
        level += 170 * filled(0.1 - angle(points, place))
    return level


def basketball(points):
    lines = [np.abs(latitude(points, pole)) for pole in ([1, 0, 0], [0, 1, 0])]
    lines += [np.abs(angle(points, pole) - 0.75) for pole in ([1, 0, 0], [-1, 0, 0])]
    return 140 - 110 * filled(0.025 - np.min(lines, axis=0))


def cue(points):
    marks = [angle(points, place) for place in ([0, 0.3, 0.95], [0.6, -0.5, 0.6])]
    return 225 - 180 * filled(0.07 - np.min(marks, axis=0))


def plain(points):
    return np.full(len(points), 200.0)


def cricket(points):
    height = latitude(points, [0.2, 0.9, 0.38])
    along = np.arctan2(points @ np.array([0.9, -0.2, 0]), points @ np.array([0, -0.38, 0.9]))
    stitches = [filled(0.012 - np.abs(height - side)) * (np.sin(60 * along + turn) > 0)
                for side, turn in ((0.07, 0), (-0.07, 1))]
    return 60 + 150 * np.sum(stitches, axis=0)


BALLS = {ball.__name__: ball for ball in (tennis, logo, two_tone, football, pool_stripe, golf, dots,
                                          basketball, cue, plain, cricket)}


def turned(vector):
    """The matrix of a rotation vector."""
    size = np.linalg.norm(vector)
    x, y, z = vector / size
    k = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(size) * k + (1 - np.cos(size)) * k @ k


def motion_of(seed):
    """Steps, px and rad a frame (x right, y down, z towards the camera), and the first pose."""
    random = np.random.default_rng([seed, 9])
    step = random.uniform(-1, 1, 2) * [2, 0.8]
    spin = np.radians(random.uniform(-1, 1, 3) * 2.5)
    return step, spin, turned(random.normal(0, 2, 3)), random


def picture_of(ball, pose, cx, cy):
    left, top = int(cx - RADIUS - 4), int(cy - RADIUS - 4)
    side = 2 * RADIUS + 9
    places = (np.arange(side * FINER) + 0.5) / FINER - 0.5
    x, y = np.meshgrid((left + places - cx) / RADIUS, (top + places - cy) / RADIUS)
    inside = x * x + y * y < 1
    normals = np.stack([x[inside], y[inside], np.sqrt(1 - x[inside] ** 2 - y[inside] ** 2)], 1)
    fine = np.full(x.shape, BACKGROUND)
    light = 1 - LAMP + 1.3 * LAMP * np.clip(normals @ TO_LAMP, 0, None)
    fine[inside] = np.clip(ball(normals @ pose), 0, 255) * light
    picture = np.full((HEIGHT, WIDTH), BACKGROUND)
    picture[top:top + side, left:left + side] = fine.reshape(side, FINER, side, FINER).mean((1, 3))
    return picture


def paint(name, seed, path):
    step, spin, pose, random = motion_of(seed)
    start = np.array([WIDTH, HEIGHT]) / 2 - step * FRAMES / 2
    film = np.memmap(path, np.uint8, 'w+', shape=(FRAMES, HEIGHT, WIDTH))
    centres = [start + i * step for i in range(FRAMES)]
    for i, (cx, cy) in enumerate(centres):
        picture = picture_of(BALLS[name], turned(spin * i) @ pose if i else pose, cx, cy)
        picture += random.normal(0, NOISE, picture.shape)
        film[i] = np.clip(picture + 0.5, 0, 255).astype(np.uint8)
    film.flush()
    # The program's axes: Y up, so that turns about X and Z are the other way round.
    truth = {'dx_px': step[0], 'dy_px': step[1], 'rot_x_deg': -np.degrees(spin[0]),
             'rot_y_deg': np.degrees(spin[1]), 'rot_deg': -np.degrees(spin[2])}
    return [{'cx_px': cx, 'cy_px': cy, **truth} for cx, cy in centres]


def look_at_rows(rows, truth, found):
    for row in rows:
        if row['status'] != 'ok' or not row['rot_deg']:
            continue
        found['told'] += 1
        wrong = False
        for figure, columns in ROW.items():
            for column in columns:
                name, unit = column.rsplit('_', 1)
                if not row[column]:
                    continue
                error = float(row[column]) - truth[int(row['frame'])][column]
                sd = float(row[f'{name}_sd_{unit}'])
                found[figure].append(error / sd)
                wrong = wrong or (abs(error) > 0.02 and abs(error) > 5 * sd)
        found['wrong'] += wrong


def one(arguments, name, seed, found):
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(temporary)
        truth = paint(name, seed, folder / 'film.raw')
        tracked = subprocess.run(
            [arguments.program, 'track', folder / 'film.raw', '--raw', f'{WIDTH}x{HEIGHT}x8', '--fps',
             '10000', '-o', folder / 'track', *arguments.options], capture_output=True, text=True)
        if tracked.returncode != 0:
            found['bodies']['failed'] += 1
            return
        found['bodies'][json.loads((folder / 'track/summary.json').read_text())['body']['kind']] += 1
        look_at_rows(csv.DictReader(open(folder / 'track/track.csv')), truth, found)


def parsed():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('program', type=lambda path: str(pathlib.Path(path).resolve()))
    parser.add_argument('first', type=int)
    parser.add_argument('last', type=int)
    parser.add_argument('names', nargs='?', default=','.join(BALLS))
    arguments, arguments.options = parser.parse_known_args()
    arguments.names = arguments.names.split(',')
    if unknown := [name for name in arguments.names if name not in BALLS]:
        parser.error(f"no ball is called '{unknown[0]}': {', '.join(BALLS)}")
    return arguments


def main():
    arguments = parsed()
    wrong = 0
    for name in arguments.names:
        found = collections.defaultdict(list, told=0, wrong=0, bodies=collections.Counter())
        for seed in range(arguments.first, arguments.last + 1):
            one(arguments, name, seed, found)
        clips = arguments.last - arguments.first + 1
        over = ', '.join(f'{figure} {np.sqrt(np.mean(np.square(found[figure]))):.2f}'
                         for figure in ROW if found[figure])
        bodies = ', '.join(f'{body} {count}' for body, count in found['bodies'].items())
        print(f"{name}: told {found['told']} of {clips * (FRAMES - 1)}, wrong {found['wrong']}; over "
              f"stated: {over or 'none'}; {bodies}", flush=True)
        wrong += found['wrong']
    sys.exit(1 if wrong else 0)


if __name__ == '__main__':
    main()
