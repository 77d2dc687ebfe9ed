#!/usr/bin/env python3
"""What `track` makes of an impact as it is filmed: above a floor, in dust, of a ball that rings.

Paints an oblique impact (`synth --simulate JOB`, R 60 px, 190 frames of 400 x 400 pixels, noise 2),
changes every picture, tracks it with the ball's diameter and the surface's angle, and compares rows,
restitution, friction and spin with the simulation.

    bench/film/impact_film.py build/release/impactdic FIRST LAST [NAME,...] [--job JOB.toml]
                              [--bodies disc,sphere] [--patterns e1,...] [OPTION OF TRACK ...]

One line a change and body, over the seeds: impacts that were found; rows with status ok, rows of
those by more than five stated deviations and 0.02 px or degrees off; the largest error over
deviation of restitution, friction and spin; what was warned of. Needs numpy. A clip takes 3 s.
"""
import argparse
import collections
import csv
import json
import math
import pathlib
import subprocess
import sys
import tempfile
import tomllib

import numpy as np

from film_changes import blurred

FRAMES, SIDE, RADIUS, TOUCH, NOISE, BACKGROUND = 190, 400, 60, 55.3, 2, 60
PATTERNS = ('e1', 'a2', 'd2', 'b2', 'c3', 'f1', 'e2', 'd1')
Y, X = np.mgrid[0:SIDE, 0:SIDE].astype(float)


def step(distance, softness=0.4):
    """1 where `distance` is plainly positive, 0 where it is negative, the lens's blur between."""
    return 1 / (1 + np.exp(np.clip(-distance / softness, -50, 50)))


class Shot:
    """Pictures without noise, the ball in each, and the surface: (x, y) . normal = surface."""

    def __init__(self, folder, seed):
        rows = list(csv.DictReader(open(folder / 'truth.csv')))
        pressed = list(csv.DictReader(open(folder / 'compression.csv')))
        self.centres = np.array([(float(r['cx_px']), float(r['cy_px'])) for r in rows])
        turns = [float(r['rot_deg'] or 0) for r in rows]
        self.angles = np.radians(np.concatenate([[0], np.cumsum(turns[:-1])]))
        self.compression = [float(r['compression']) for r in pressed]
        axis = math.radians(float(pressed[0]['compression_axis_deg']))
        self.normal = np.array([math.cos(axis), -math.sin(axis)])
        self.along = np.array([math.sin(axis), math.cos(axis)])
        touching = [k for k, c in enumerate(self.compression) if c > 0]
        self.first, self.last = touching[0], touching[-1]
        self.surface = self.centres[self.first - 1] @ self.normal - RADIUS
        self.contact = self.centres[self.first] - RADIUS * self.normal
        self.random = np.random.default_rng(seed)
        rough = blurred(self.random.normal(0, 1, (SIDE, SIDE)), 2)
        self.floor_picture = (130, 210, 25, 90)[seed // 2 % 4] + 20 * rough / rough.std()

    def depth(self):
        """Of each pixel below the surface."""
        return self.surface - X * self.normal[0] - Y * self.normal[1]

    def outside(self, k):
        """Of each pixel from the ball's rim, roughly."""
        x, y = X - self.centres[k][0], Y - self.centres[k][1]
        across = (x * self.normal[0] + y * self.normal[1]) / (1 - self.compression[k])
        return np.hypot(across, x * self.along[0] + y * self.along[1]) - RADIUS


def near(x, y, reach):
    """The pixels about a place: a slice of the picture and its coordinates about the place."""
    rows = slice(max(0, int(y - reach)), min(SIDE, int(y + reach) + 1))
    columns = slice(max(0, int(x - reach)), min(SIDE, int(x + reach) + 1))
    return (rows, columns), X[rows, columns] - x, Y[rows, columns] - y


def spot(picture, x, y, radius, level):
    at, dx, dy = near(x, y, radius + 4)
    picture[at] += step(radius - np.hypot(dx, dy)) * (level - picture[at])


def plain(shot, pictures):
    return pictures


def floor(shot, pictures):
    """Seen behind the ball."""
    for k, p in enumerate(pictures):
        p += step(shot.depth()) * step(shot.outside(k)) * (shot.floor_picture - p)
    return pictures


def front(shot, pictures):
    """Its edge hides the lowest 9 px of the ball in contact, from where the ball stands free."""
    for p in pictures:
        p += step(shot.depth() + 9) * (shot.floor_picture - p)
    return pictures


def rings(shot, pictures):
    """The ball rings by 2 % of its radius behind the contact."""
    for k in range(shot.last + 1, len(pictures)):
        since = k - shot.last
        share = 0.02 * math.exp(-since / 60) * math.cos(2 * math.pi * since / 12)
        x, y = X - shot.centres[k][0], Y - shot.centres[k][1]
        across = (x * shot.normal[0] + y * shot.normal[1]) / (1 + share)
        along = (x * shot.along[0] + y * shot.along[1]) / (1 - share)
        pictures[k] = sampled(pictures[k],
                              shot.centres[k][0] + across * shot.normal[0] + along * shot.along[0],
                              shot.centres[k][1] + across * shot.normal[1] + along * shot.along[1])
    return pictures


def sampled(picture, x, y):
    left, top = (np.clip(np.floor(v).astype(int), 0, SIDE - 2) for v in (x, y))
    u, v = np.clip(x - left, 0, 1), np.clip(y - top, 0, 1)
    rows = ((1 - u) * picture[top + below, left] + u * picture[top + below, left + 1]
            for below in (0, 1))
    upper, lower = rows
    return (1 - v) * upper + v * lower


def debris(shot, pictures):
    """Forty bright and dark crumbs fly from the contact, some of them before the ball."""
    speeds = (np.outer(shot.random.uniform(0.2, 3, 40), shot.normal)
              + np.outer(shot.random.normal(0, 2, 40), shot.along))
    radii, levels = shot.random.uniform(0.8, 2.5, 40), shot.random.choice([20, 230], 40)
    for k in range(shot.first, len(pictures)):
        for speed, radius, level in zip(speeds, radii, levels):
            spot(pictures[k], *(shot.contact + speed * (k - shot.first + 0.5)), radius, level)
    return pictures


def flakes(shot, pictures):
    """Nine spots of paint are lost at the touch."""
    radii = RADIUS * np.sqrt(shot.random.uniform(0, 0.9, 9))
    angles, sizes = shot.random.uniform(0, 2 * math.pi, 9), shot.random.uniform(3, 7, 9)
    for k in range(shot.first, len(pictures)):
        turned = angles - (shot.angles[k] - shot.angles[shot.first])
        for r, angle, size in zip(radii, turned, sizes):
            spot(pictures[k], shot.centres[k][0] + r * math.cos(angle),
                 shot.centres[k][1] + r * math.sin(angle), size, 120)
    return pictures


def dust(shot, pictures):
    """A cloud of chalk spreads from the contact."""
    clouds = blurred(shot.random.normal(0, 1, (SIDE, SIDE)), 5)
    clouds = 0.5 + 0.5 * clouds / clouds.std()
    away_sq = (X - shot.contact[0]) ** 2 + (Y - shot.contact[1]) ** 2
    for k in range(shot.first, len(pictures)):
        since = k - shot.first
        dense = 0.7 * math.exp(-since / 60) * clouds * np.exp(-0.5 * away_sq / (8 + 0.8 * since) ** 2)
        pictures[k] += np.clip(dense, 0, 1) * (180 - pictures[k])
    return pictures


def fuzz(shot, pictures):
    """Four hundred hairs, 1 to 6 px long, stand on the rim."""
    angles, lengths = shot.random.uniform(0, 2 * math.pi, 400), shot.random.uniform(1, 6, 400)
    for k, p in enumerate(pictures):
        for angle, length in zip(angles - shot.angles[k], lengths):
            c, s = math.cos(angle), math.sin(angle)
            at, x, y = near(shot.centres[k][0] + RADIUS * c, shot.centres[k][1] + RADIUS * s, 8)
            along, beside = x * c + y * s, y * c - x * s
            seen = 0.6 * np.exp(-0.5 * (beside / 0.6) ** 2) * step(along + 1) * step(length - along)
            p[at] += seen * (200 - p[at])
    return pictures


def flash(shot, pictures):
    """Light that is 60 % brighter about the touch."""
    for k, p in enumerate(pictures):
        p *= 1 + 0.6 * math.exp(-((k - shot.first) / 3) ** 2)
    return pictures


def dims(shot, pictures):
    """A lamp that loses 30 % of its light from the touch on."""
    for k, p in enumerate(pictures):
        p *= 0.7 + 0.3 * math.exp(-max(0, k - shot.first) / 30)
    return pictures


def mirrored(shot, picture):
    """What a mirror in the surface shows of it."""
    depth = shot.depth()
    return sampled(picture, X + 2 * depth * shot.normal[0], Y + 2 * depth * shot.normal[1])


def glossy(shot, pictures):
    """A polished floor: in it the ball comes up to meet itself."""
    for k, p in enumerate(pictures):
        seen = 0.65 * shot.floor_picture + 0.35 * mirrored(shot, p)
        p += step(shot.depth()) * step(shot.outside(k)) * (seen - p)
    return pictures


def shadowed(shot, pictures):
    """On a floor seen from a little above the ball's shadow meets it at the touch."""
    floor(shot, pictures)
    for k, p in enumerate(pictures):
        x, y = X - shot.centres[k][0], Y - shot.centres[k][1]
        along = x * shot.along[0] + y * shot.along[1]
        height = max(0.0, shot.centres[k] @ shot.normal - shot.surface - RADIUS * 0.9)
        soft = 3 + 0.15 * height
        dark = step(0.9 * RADIUS - np.hypot(along, 4 * (shot.depth() - 12)), soft)
        p *= 1 - 0.7 * dark * step(shot.depth()) * step(shot.outside(k))
    return pictures


def recoils(shot, pictures):
    """The floor is struck 3 px down and rings."""
    still = shot.surface
    for k, p in enumerate(pictures):
        since = max(0, k - shot.first)
        shot.surface = still - 3 * math.exp(-since / 50) * math.sin(2 * math.pi * since / 40)
        shift = shot.surface - still
        moved = sampled(shot.floor_picture, X - shift * shot.normal[0], Y - shift * shot.normal[1])
        p += step(shot.depth()) * step(shot.outside(k)) * (moved - p)
    shot.surface = still
    return pictures


def spare(shot, pictures):
    """Another ball of the kind lies still in a corner."""
    first, start = pictures[0].copy(), shot.centres[0]
    corner = [SIDE - 62 if place < SIDE / 2 else 62 for place in start]
    still = sampled(first, X - corner[0] + start[0], Y - corner[1] + start[1])
    inside = step(RADIUS - np.hypot(X - corner[0], Y - corner[1]))
    for k, p in enumerate(pictures):
        p += inside * step(shot.outside(k)) * (still - p)
    return pictures


def hand(shot, pictures):
    """The arm that let the ball go is drawn back, behind it."""
    end = shot.centres[0] + 0.9 * RADIUS * shot.normal
    rough = blurred(shot.random.normal(0, 1, (SIDE, SIDE)), 3)
    skin = 150 + 15 * rough / rough.std()
    for k, p in enumerate(pictures):
        x, y = (at - place - 0.05 * k ** 1.5 * way
                for at, place, way in zip((X, Y), end, shot.normal))
        along = np.maximum(0, x * shot.normal[0] + y * shot.normal[1])
        over = 28 - np.hypot(x - along * shot.normal[0], y - along * shot.normal[1])
        p += step(over) * step(shot.outside(k)) * (skin - p)
    return pictures


def defocused(shot, pictures):
    """A lens 1.5 px out of focus."""
    for p in pictures:
        p[:] = blurred(p, 1.5)
    return pictures


def saturated(shot, pictures):
    """Light so bright that white paint is at the end of the scale."""
    for p in pictures:
        p *= 1.5
    return pictures


CHANGES = {change.__name__: change for change in (
    plain, floor, front, rings, debris, flakes, dust, fuzz, flash, dims, glossy, shadowed, recoils,
    spare, hand, defocused, saturated)}
COLUMNS = {'cx_px': 'cx_sd_px', 'cy_px': 'cy_sd_px', 'dx_px': 'dx_sd_px', 'dy_px': 'dy_sd_px',
           'rot_deg': 'rot_sd_deg'}


def paint(arguments, name, body, seed, folder):
    pattern = arguments.patterns[seed % len(arguments.patterns)]
    options = ['--body', 'sphere', '--lamp', '0.2'] if body == 'sphere' else []
    subprocess.run([arguments.program, 'synth', '-o', folder, '--simulate', arguments.job, '--frames',
                    str(FRAMES), '--size', f'{SIDE}x{SIDE}', '--radius-px', str(RADIUS),
                    '--touch-frame', str(TOUCH), '--seed', str(seed), '--pattern', pattern,
                    '--background', str(BACKGROUND), '--format', 'mraw', '-q', *options], check=True)
    file = np.memmap(folder / 'video.mraw', np.uint8, 'r+', shape=(FRAMES, SIDE, SIDE))
    shot = Shot(folder, seed)
    film = CHANGES[name](shot, file.astype(float))
    film += np.random.default_rng([seed, 7]).normal(0, NOISE, film.shape)
    file[:] = np.clip(film + 0.5, 0, 255).astype(np.uint8)
    file.flush()


def look_at_rows(rows, truth, found):
    for row in rows:
        if row['status'] != 'ok':
            found['not ok'] += row['status'] != 'last_frame'
            continue
        found['ok'] += 1
        right = truth[int(row['frame'])]
        for column, deviation in COLUMNS.items():
            if row[column] and row[deviation] and right[column]:
                error = abs(float(row[column]) - float(right[column]))
                if error > 0.02 and error > 5 * float(row[deviation]):
                    found['wrong'] += 1
                    break


def look_at_impact(impact, simulated, found):
    """`simulated`: the summary of `simulate`."""
    if impact.get('status') != 'found':
        found['statuses'][impact.get('status', 'none')] += 1
        return
    found['found'] += 1
    aside = any(one['what'] == 'side_slip' for one in impact['contradictions'])
    friction = impact['space']['friction'] if aside else impact['friction']['gravity_corrected']
    told = {'e': (impact['restitution'], simulated['restitution']),
            'mu': (friction, simulated['effective_friction']['sound']),
            'spin': (impact['after']['omega_rad_s'], simulated['final']['omega_rad_s'])}
    for name, (figure, right) in told.items():
        if figure and figure['value'] is not None:
            off = abs(figure['value'] - right) / figure['sd']
            found[name] = max(found[name], off)


def one(arguments, name, body, seed, found):
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(temporary)
        paint(arguments, name, body, seed, folder / 'clip')
        tracked = subprocess.run(
            [arguments.program, 'track', folder / 'clip/video.cihx', '-o', folder / 'track',
             '--ball-diameter-mm', str(arguments.diameter_mm), '--surface-angle-deg',
             str(arguments.angle_deg), *arguments.options], capture_output=True, text=True)
        if tracked.returncode != 0:
            found['failed'] += 1
            return
        look_at_rows(csv.DictReader(open(folder / 'track/track.csv')),
                     list(csv.DictReader(open(folder / 'clip/truth.csv'))), found)
        summary = json.loads((folder / 'track/summary.json').read_text())
        look_at_impact(summary['impact'], arguments.simulated, found)
        for warning in summary['warnings']:
            found['warned'][warning[:110]] += 1


def simulated(arguments):
    with tempfile.TemporaryDirectory() as temporary:
        subprocess.run([arguments.program, 'simulate', arguments.job, '-o', temporary, '--force', '-q'],
                       check=True)
        return json.loads((pathlib.Path(temporary) / 'summary.json').read_text())


def parsed():
    home = pathlib.Path(__file__).resolve().parents[2]
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('program', type=lambda path: str(pathlib.Path(path).resolve()))
    parser.add_argument('first', type=int)
    parser.add_argument('last', type=int)
    parser.add_argument('names', nargs='?', default=','.join(CHANGES))
    parser.add_argument('--job', default=str(home / 'sim/jobs/racket_30.toml'))
    parser.add_argument('--bodies', default='disc,sphere')
    parser.add_argument('--patterns', default=','.join(PATTERNS))
    arguments, arguments.options = parser.parse_known_args()
    arguments.names = arguments.names.split(',')
    arguments.patterns = arguments.patterns.split(',')
    if unknown := [name for name in arguments.names if name not in CHANGES]:
        parser.error(f"no change is called '{unknown[0]}': {', '.join(CHANGES)}")
    job = tomllib.loads(pathlib.Path(arguments.job).read_text())
    arguments.diameter_mm = 1000 * job['body']['diameter_m']
    arguments.angle_deg = job['surface']['angle_deg']
    arguments.simulated = simulated(arguments)
    return arguments


def main():
    arguments = parsed()
    wrong = 0
    for name in arguments.names:
        for body in arguments.bodies.split(','):
            found = collections.Counter()
            found['warned'], found['statuses'] = collections.Counter(), collections.Counter()
            for seed in range(arguments.first, arguments.last + 1):
                one(arguments, name, body, seed, found)
            clips = arguments.last - arguments.first + 1
            warned = '; '.join(f'{text} ({n})' for text, n in found['warned'].items())
            others = ''.join(f', {status} {n}' for status, n in found['statuses'].items())
            print(f"{name} {body}: found {found['found']} of {clips}{others}, ok {found['ok']}, not ok "
                  f"{found['not ok']}, wrong {found['wrong']}, at most e {found['e']:.1f} mu "
                  f"{found['mu']:.1f} spin {found['spin']:.1f}"
                  + (f", failed {found['failed']}" if found['failed'] else '')
                  + (f' | {warned}' if warned else ''), flush=True)
            wrong += found['wrong']
    sys.exit(1 if wrong else 0)


if __name__ == '__main__':
    main()
