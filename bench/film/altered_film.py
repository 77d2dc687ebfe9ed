#!/usr/bin/env python3
"""What `track` makes of film that a camera, a room or a converter has changed.

Paints clips of a disc or a sphere that flies (`synth`, R 60 px, 40 frames of 360 x 240 pixels, noise
1.5), changes every picture, tracks them without options but the rate, and compares rows and flight
with the truth.

    bench/film/altered_film.py build/release/impactdic FIRST LAST [NAME,...] [OPTION OF TRACK ...]

One line a change and body, over the seeds: rows with status ok; rows of those by more than five
stated deviations and 0.02 px or degrees off; rms errors over stated deviations of centre, radius,
displacement, velocity (through a scale) and turn; the largest error over deviation of the flights' velocities and spins, and how
many clips have a flight; what was warned of. Needs numpy; jpeg also Pillow. A clip takes 1 to 2 s.
"""
import collections
import csv
import json
import math
import pathlib
import subprocess
import sys
import tempfile

import numpy as np

from film_changes import (BACKGROUND, CHANGES, FRAMES, HEIGHT, IN_BETWEEN, MOVED, PARTS, PATTERNS,
                          RADIUS, WIDTH, Film)

RATE = 10000  # frames a second
ROW = {'centre': ('cx_px', 'cy_px'), 'radius': ('r_px',), 'step': ('dx_px', 'dy_px'),
       'speed': ('vx_m_s', 'vy_m_s'), 'turn': ('rot_deg', 'rot_x_deg', 'rot_y_deg')}


def deviation_of(column):
    unit = 'm_s' if column.endswith('m_s') else column.rsplit('_', 1)[1]
    return f'{column[:-len(unit)]}sd_{unit}'


def synth(body, seed, folder, parts=1):
    """`parts`: pictures of each frame's time."""
    random = np.random.default_rng([seed, body == 'sphere'])
    step = random.uniform(-1, 1, 2) * (2.2, 0.7) / parts
    options = [f'--velocity-px={step[0]:.5f},{step[1]:.5f}', '--pattern',
               PATTERNS[seed % len(PATTERNS)], '--seed', str(seed)]
    if body == 'sphere':
        turn = random.uniform(-1, 1, 3) / parts
        options += ['--body', 'sphere', '--lamp', '0.2',
                    f'--spin-deg={turn[0]:.5f},{turn[1]:.5f},{turn[2]:.5f}']
    else:
        options += [f'--rotation-deg={random.uniform(-1.2, 1.2) / parts:.5f}']
    subprocess.run([PROGRAM, 'synth', '-o', folder, '--size', f'{WIDTH}x{HEIGHT}', '--radius-px',
                    str(RADIUS), '--frames', str(parts * FRAMES), '--format', 'mraw', '--background',
                    str(BACKGROUND), '-q', *options], check=True)


def pictures_in(folder, mode, parts=1):
    return np.memmap(folder / 'video.mraw', np.uint8, mode, shape=(parts * FRAMES, HEIGHT, WIDTH))


def truth_in(folder):
    rows = list(csv.DictReader(open(folder / 'truth.csv')))
    for row in rows:  # a metre a pixel
        row['vx_m_s'] = row['dx_px'] and RATE * float(row['dx_px'])
        row['vy_m_s'] = row['dy_px'] and -RATE * float(row['dy_px'])
    return rows


def centres_of(rows):
    return [(float(row['cx_px']), float(row['cy_px'])) for row in rows]


def flight_errors(summary, truth):
    """Errors over deviations of a flight's velocity and spin; none where there is none."""
    flight = summary['impact'].get('flight')
    if not flight:
        return []
    angle = 180 / math.pi / RATE
    names = {'vx_m_s': ('vx_m_s', 1), 'vy_m_s': ('vy_m_s', 1), 'omega_rad_s': ('rot_deg', angle),
             'omega_t_rad_s': ('rot_x_deg', angle), 'omega_n_rad_s': ('rot_y_deg', angle)}
    errors = []
    for name, (column, unit) in names.items():
        told = flight.get(name)
        if told and told['value'] is not None and truth[0].get(column):
            error = unit * told['value'] - float(truth[0][column])
            errors.append(error / (abs(unit) * told['sd']))
    return errors


def look_at(rows, truth, kinds, found):
    for row in rows:
        right = truth[int(row['frame'])]
        if row['status'] != 'ok':
            found['not ok'] += 1
            continue
        found['ok'] += 1
        wrong = False
        for name in kinds:
            for column in ROW[name]:
                deviation = row.get(deviation_of(column))
                if not row.get(column) or not deviation or not right.get(column):
                    continue
                error = float(row[column]) - float(right[column])
                found.setdefault(name, []).append(error / float(deviation))
                wrong |= abs(error) > 0.02 and abs(error) > 5 * float(deviation)
        found['wrong'] += wrong


def one(name, body, seed, options, found):
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(temporary)
        synth(body, seed, folder / 'clip')
        truth = truth_in(folder / 'clip')
        file = pictures_in(folder / 'clip', 'r+')
        film = Film(file.astype(float), centres_of(truth), [seed, sum(name.encode())])
        if name in IN_BETWEEN:
            synth(body, seed, folder / 'between', PARTS)
            film.between = pictures_in(folder / 'between', 'r', PARTS).astype(float)
            film.centres = centres_of(truth_in(folder / 'between'))[::PARTS]
        file[:] = np.clip(CHANGES[name](film) + 0.5, 0, 255).astype(np.uint8)
        file.flush()
        for row, centre in zip(truth, film.centres):
            row['cx_px'], row['cy_px'] = centre
        tracked = subprocess.run(
            [PROGRAM, 'track', folder / 'clip/video.cihx', '-o', folder / 'track', '--mm-per-px',
             '1000', *options], capture_output=True, text=True)
        if tracked.returncode != 0:
            found['failed'] += 1
            return
        # What a moved camera shows is not where the ball is; velocities are.
        kinds = ('radius', 'speed') if name in MOVED else ROW
        look_at(csv.DictReader(open(folder / 'track/track.csv')), truth, kinds, found)
        summary = json.loads((folder / 'track/summary.json').read_text())
        errors = flight_errors(summary, truth)
        found['flights'] += bool(errors)
        found.setdefault('flight', []).extend(errors)
        for warning in summary['warnings']:
            found['warned'][warning[:110]] += 1


def main():
    arguments = sys.argv[2:]
    if len(arguments) < 2 or not all(number.isdigit() for number in arguments[:2]):
        sys.exit(__doc__)
    seeds = range(int(arguments[0]), int(arguments[1]) + 1)
    names = arguments[2].split(',') if len(arguments) > 2 else list(CHANGES)
    if unknown := [name for name in names if name not in CHANGES]:
        sys.exit(f"no change is called '{unknown[0]}': {', '.join(CHANGES)}")
    wrong = 0
    for name in names:
        for body in ('disc', 'sphere'):
            found = collections.Counter()
            found['warned'] = collections.Counter()
            for seed in seeds:
                one(name, body, seed, arguments[3:], found)
            ratios = ' '.join(f'{kind} {math.sqrt(np.mean(np.square(found[kind]))):.2f}'
                              for kind in ROW if kind in found)
            most = max(map(abs, found.get('flight') or [0]))
            warned = '; '.join(f'{text} ({n})' for text, n in found['warned'].items())
            print(f"{name} {body}: ok {found['ok']}, not ok {found['not ok']}, wrong {found['wrong']}, "
                  f"{ratios}, flights {found['flights']} of {len(seeds)}, at most {most:.1f}"
                  + (f", failed {found['failed']}" if found['failed'] else '')
                  + (f' | {warned}' if warned else ''), flush=True)
            wrong += found['wrong']
    sys.exit(1 if wrong else 0)


if __name__ == '__main__':
    PROGRAM = str(pathlib.Path(sys.argv[1]).resolve()) if len(sys.argv) > 1 else sys.exit(__doc__)
    main()
