#!/usr/bin/env python3
"""What `track` makes of an impact as it is filmed: above a floor, in dust, of a ball that rings.

Paints an oblique impact (`synth --simulate JOB`, unless told otherwise of R 60 px in 190 frames of
400 x 400 pixels, noise 2), changes every picture, tracks it with the ball's diameter and the
surface's angle, and compares rows, restitution, friction and spin with the simulation.

    bench/film/impact_film.py build/release/impactdic FIRST LAST [NAME,...] [--job JOB.toml]
                              [--bodies disc,sphere] [--patterns e1,...] [--side 400] [--radius 60]
                              [--frames 190] [--touch 55.3] [--noise 2] [--synth=OPTIONS]
                              [OPTION OF TRACK ...]

NAME+NAME makes both changes, the first one first.

One line a change and body, over the seeds: impacts that were found; rows with status ok, rows of
those by more than five stated deviations and 0.02 px or degrees off; the largest error over
deviation of restitution, friction and spin; what was warned of. Needs numpy. A clip takes 3 s.
"""
import argparse
import collections
import csv
import json
import pathlib
import subprocess
import sys
import tempfile
import tomllib

import numpy as np

import impact_changes
from impact_changes import BACKGROUND, CHANGES, Shot

OTHER_BACKGROUND = 160  # grey levels
PATTERNS = ('e1', 'a2', 'd2', 'b2', 'c3', 'f1', 'e2', 'd1')
COLUMNS = {'cx_px': 'cx_sd_px', 'cy_px': 'cy_sd_px', 'dx_px': 'dx_sd_px', 'dy_px': 'dy_sd_px',
           'rot_deg': 'rot_sd_deg'}


def synthesised(arguments, body, seed, folder, background):
    """Pictures without noise, as a file that may be written to."""
    pattern = arguments.patterns[seed % len(arguments.patterns)]
    options = arguments.synth.split()
    if body == 'sphere':
        options += ['--body', 'sphere'] + ([] if '--lamp' in options else ['--lamp', '0.2'])
    side, frames = arguments.side, arguments.frames
    subprocess.run([arguments.program, 'synth', '-o', folder, '--simulate', arguments.job, '--frames',
                    str(frames), '--size', f'{side}x{side}', '--radius-px', str(arguments.radius),
                    '--touch-frame', str(arguments.touch), '--seed', str(seed), '--pattern', pattern,
                    '--background', str(background), '--format', 'mraw', '-q', *options], check=True)
    return np.memmap(folder / 'video.mraw', np.uint8, 'r+', shape=(frames, side, side))


def share_behind(arguments, body, seed, pictures):
    """Of each pixel, what lies behind the ball: by a second film before another background."""
    with tempfile.TemporaryDirectory() as temporary:
        other = synthesised(arguments, body, seed, pathlib.Path(temporary) / 'clip', OTHER_BACKGROUND)
        return np.clip((other.astype(float) - pictures) / (OTHER_BACKGROUND - BACKGROUND), 0, 1)


def paint(arguments, name, body, seed, folder):
    impact_changes.set_size(arguments.side, arguments.radius)
    file = synthesised(arguments, body, seed, folder, BACKGROUND)
    shot = Shot(folder, seed)
    film = file.astype(float)
    shot.behind = lambda: share_behind(arguments, body, seed, file)
    for change in name.split('+'):
        film = CHANGES[change](shot, film)
    film += np.random.default_rng([seed, 7]).normal(0, arguments.noise, film.shape)
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
    add_filming(parser)
    arguments, arguments.options = parser.parse_known_args()
    arguments.names = arguments.names.split(',')
    arguments.patterns = arguments.patterns.split(',')
    asked = [change for name in arguments.names for change in name.split('+')]
    if unknown := [change for change in asked if change not in CHANGES]:
        parser.error(f"no change is called '{unknown[0]}': {', '.join(CHANGES)}")
    set_job(arguments)
    return arguments


def add_filming(parser):
    parser.add_argument('--side', type=int, default=400)
    parser.add_argument('--radius', type=float, default=60)
    parser.add_argument('--frames', type=int, default=190)
    parser.add_argument('--touch', type=float, default=55.3)
    parser.add_argument('--noise', type=float, default=2)
    parser.add_argument('--synth', default='', help='more options of synth')


def set_job(arguments):
    job = tomllib.loads(pathlib.Path(arguments.job).read_text())
    arguments.diameter_mm = 1000 * job['body']['diameter_m']
    arguments.angle_deg = job['surface']['angle_deg']
    arguments.simulated = simulated(arguments)


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
