#!/usr/bin/env python3
"""What `track` makes of film that a camera, a room or a converter has changed.

Paints clips of a disc or a sphere that flies (`synth`, R 60 px, 40 frames of 360 x 240 pixels, noise
1.5), changes every picture, tracks them without options but the rate, and compares rows and flight
with the truth.

    bench/film/altered_film.py build/release/impactdic FIRST LAST [NAME,...] [OPTION OF TRACK ...]

One line a change and body, over the seeds: rows with status ok; rows of those by more than five
stated deviations and 0.02 px or degrees off; rms errors over stated deviations of centre, radius,
displacement and turn; the largest error over deviation of the flights' velocities and spins, and how
many clips have a flight; what was warned of. Needs numpy; jpeg also Pillow. A clip takes 1 to 2 s.
"""
import collections
import csv
import io
import json
import math
import pathlib
import subprocess
import sys
import tempfile

import numpy as np

WIDTH, HEIGHT, RADIUS, FRAMES, NOISE = 360, 240, 60, 40, 1.5
BACKGROUND, BLUR = 60, math.hypot(0.6, 12**-0.5)  # the lens's of synth, and a pixel's
PATTERNS = ('a1', 'b1', 'b2', 'c1', 'c3', 'd1', 'd3', 'e1', 'f1')
Y, X = np.mgrid[0:HEIGHT, 0:WIDTH]


def blurred(picture, sigma):
    reach = int(4 * sigma) + 1
    kernel = np.exp(-0.5 * (np.arange(-reach, reach + 1) / sigma) ** 2)
    kernel /= kernel.sum()
    for axis in (0, 1):
        margin = [(reach, reach) if a == axis else (0, 0) for a in (0, 1)]
        padded = np.pad(picture, margin, mode='edge')
        shape = picture.shape[axis]
        picture = sum(weight * padded.take(range(k, k + shape), axis)
                      for k, weight in enumerate(kernel))
    return picture


def covered(distance):
    """By the ball, so far from its centre."""
    return 0.5 * np.vectorize(math.erfc)((distance - RADIUS) / (math.sqrt(2) * BLUR))


def around(picture, side=3):
    """Each pixel's neighbours: (height, width, side, side)."""
    padded = np.pad(picture, side // 2, mode='reflect')
    return np.lib.stride_tricks.sliding_window_view(padded, (side, side))


class Film:
    """Pictures of light, 0 ... 255, with the ball's centre in each."""

    def __init__(self, pictures, centres, seed):
        self.pictures, self.centres = pictures, centres
        self.random = np.random.default_rng(seed)

    def noise(self, sigma=NOISE):
        return self.random.normal(0, sigma, self.pictures.shape)

    def each(self, change):
        """With the camera's noise behind the change."""
        changed = np.array([change(p, x, y) for p, (x, y) in zip(self.pictures, self.centres)])
        return changed + self.noise()


def plain(film):
    return film.pictures + film.noise()


def hot_pixels(film):
    places = film.random.choice(WIDTH * HEIGHT, 90, replace=False)
    levels = film.random.integers(60, 255, 90)
    film.pictures.reshape(len(film.pictures), -1)[:, places] = levels
    return plain(film)


def dust(film):
    for _ in range(10):
        x, y = film.random.uniform(0, WIDTH), film.random.uniform(0, HEIGHT)
        film.pictures *= 1 - 0.15 * np.exp(-((X - x) ** 2 + (Y - y) ** 2) / (2 * 4.0**2))
    return plain(film)


def rows_of_noise(film):
    return plain(film) + film.random.normal(0, 2, (len(film.pictures), HEIGHT, 1))


def vignette(film):
    far = ((X - WIDTH / 2) ** 2 + (Y - HEIGHT / 2) ** 2) / (WIDTH / 2) ** 2
    return film.each(lambda p, x, y: p * (1 - 0.5 * far))


def shadow(film):
    """The ball's own, soft, on a wall behind it."""
    def cast(picture, x, y):
        dark = blurred(np.clip(RADIUS - np.hypot(X - x - 33, Y - y - 24), 0, 1), 5) * 0.6
        return picture - BACKGROUND * dark * (1 - covered(np.hypot(X - x, Y - y)))
    return film.each(cast)


def mirror(film):
    """A polished floor."""
    floor = HEIGHT // 2 + RADIUS + 6
    def reflect(picture, x, y):
        rows = min(HEIGHT - floor, floor)
        out = picture.copy()
        out[floor:floor + rows] = 0.7 * picture[floor:floor + rows] + (
            0.3 * picture[floor - rows:floor][::-1])
        return out
    return film.each(reflect)


def string(film):
    return film.each(lambda p, x, y: np.where((np.abs(X - x) < 1) & (Y < y - RADIUS + 2), 90, p))


def insect(film):
    pictures = film.each(lambda p, x, y: p)
    for k, picture in enumerate(pictures):
        near = (X - 20 - 7 * k) ** 2 + (Y - HEIGHT / 2 - 20 * math.sin(k / 3)) ** 2 < 36
        picture[near] = 100
    return pictures


def net(film):
    return film.each(lambda p, x, y: np.where((X % 40 < 2) | (Y % 40 < 2), 120, p))


def flicker(film):
    """By 15 % at either side, in turns."""
    pictures = film.pictures
    for k in range(len(pictures)):
        pictures[k] *= 1 + 0.15 * math.sin(1.3 * k) * (X - WIDTH / 2) / (WIDTH / 2)
    return plain(film)


def glint(film):
    return film.each(lambda p, x, y: p + 170 * np.exp(
        -((X - x + 18) ** 2 + (Y - y + 18) ** 2) / (2 * 4.8**2)))


def gamma(film):
    return film.each(lambda p, x, y: 255 * (np.clip(p, 0, 255) / 255) ** (1 / 2.2))


def sharpened(film):
    pictures = plain(film)
    return np.array([p + 0.8 * (p - blurred(p, 1.2)) for p in pictures])


def median(film):
    return np.array([np.median(around(p), axis=(2, 3)) for p in plain(film)])


def smooth_noise(film):
    noise = np.array([blurred(n, 0.8) for n in film.noise(1)])
    return film.pictures + 2 * noise / noise.std()


def bayer(film):
    """A colour camera's mosaic, interpolated, as luminance."""
    green = (X + Y) % 2 == 1
    cross = np.array([[0, 1, 0], [1, 4, 1], [0, 1, 0]])
    square = np.array([[1, 2, 1], [2, 4, 2], [1, 2, 1]])

    def filled(picture, here, weights):
        sums = (around(picture * here) * weights).sum((2, 3))
        return sums / (around(here.astype(float)) * weights).sum((2, 3))

    def luminance(picture):
        red = filled(picture, (X % 2 == 0) & (Y % 2 == 0), square)
        blue = filled(picture, (X % 2 == 1) & (Y % 2 == 1), square)
        return 0.299 * red + 0.587 * np.where(green, picture, filled(picture, green, cross)) + (
            0.114 * blue)
    return np.array([luminance(p) for p in film.pictures + film.noise(2.5)])


def ghosts(film):
    """A recorder's noise reduction: three tenths of what it has shown before."""
    pictures = plain(film)
    for k in range(1, len(pictures)):
        pictures[k] = 0.7 * pictures[k] + 0.3 * pictures[k - 1]
    return pictures


def jpeg(film):
    from PIL import Image

    def coded(picture):
        file = io.BytesIO()
        Image.fromarray(np.clip(picture + 0.5, 0, 255).astype(np.uint8)).save(
            file, 'JPEG', quality=75)
        return np.asarray(Image.open(file)).astype(float)
    return np.array([coded(p) for p in plain(film)])


def repeated(film):
    """Every seventh picture is the one before it, as a recorder makes good what it has lost."""
    pictures = plain(film)
    pictures[3::7] = pictures[2::7][:len(pictures[3::7])]
    return pictures


CHANGES = {c.__name__: c for c in (
    plain, hot_pixels, dust, rows_of_noise, vignette, shadow, mirror, string, insect, net, flicker,
    glint, gamma, sharpened, median, smooth_noise, bayer, ghosts, jpeg, repeated)}
ROW = {'centre': ('cx_px', 'cy_px'), 'radius': ('r_px',), 'step': ('dx_px', 'dy_px'),
       'turn': ('rot_deg', 'rot_x_deg', 'rot_y_deg')}


def deviation_of(column):
    stem, unit = column.rsplit('_', 1)
    return f'{stem}_sd_{unit}'


def synth(body, seed, folder):
    random = np.random.default_rng([seed, body == 'sphere'])
    step = random.uniform(-1, 1, 2) * (2.2, 0.7)
    options = [f'--velocity-px={step[0]:.3f},{step[1]:.3f}', '--pattern',
               PATTERNS[seed % len(PATTERNS)], '--seed', str(seed)]
    if body == 'sphere':
        turn = random.uniform(-1, 1, 3)
        options += ['--body', 'sphere', '--lamp', '0.2',
                    f'--spin-deg={turn[0]:.3f},{turn[1]:.3f},{turn[2]:.3f}']
    else:
        options += [f'--rotation-deg={random.uniform(-1.2, 1.2):.3f}']
    subprocess.run([PROGRAM, 'synth', '-o', folder, '--size', f'{WIDTH}x{HEIGHT}', '--radius-px',
                    str(RADIUS), '--frames', str(FRAMES), '--format', 'mraw', '--background', str(BACKGROUND),
                    '-q', *options], check=True)


def flight_errors(summary, truth):
    """Errors over deviations of a flight's velocity and spin; none where there is none."""
    flight = summary['impact'].get('flight')
    if not flight:
        return []
    angle = 180 / math.pi
    names = {'vx_px_per_frame': ('dx_px', 1), 'vy_px_per_frame': ('dy_px', -1),
             'omega_rad_per_frame': ('rot_deg', angle), 'omega_t_rad_per_frame': ('rot_x_deg', angle),
             'omega_n_rad_per_frame': ('rot_y_deg', angle)}
    errors = []
    for name, (column, unit) in names.items():
        told = flight.get(name)
        if told and told['value'] is not None and truth[0].get(column):
            error = unit * told['value'] - float(truth[0][column])
            errors.append(error / (abs(unit) * told['sd']))
    return errors


def look_at(rows, truth, found):
    for row in rows:
        right = truth[int(row['frame'])]
        if row['status'] != 'ok':
            found['not ok'] += 1
            continue
        found['ok'] += 1
        wrong = False
        for name, columns in ROW.items():
            for column in columns:
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
        truth = list(csv.DictReader(open(folder / 'clip/truth.csv')))
        file = np.memmap(folder / 'clip/video.mraw', np.uint8, 'r+', shape=(FRAMES, HEIGHT, WIDTH))
        centres = [(float(row['cx_px']), float(row['cy_px'])) for row in truth]
        film = Film(file.astype(float), centres, [seed, sorted(CHANGES).index(name)])
        file[:] = np.clip(CHANGES[name](film) + 0.5, 0, 255).astype(np.uint8)
        file.flush()
        tracked = subprocess.run(
            [PROGRAM, 'track', folder / 'clip/video.cihx', '-o', folder / 'track', *options],
            capture_output=True, text=True)
        if tracked.returncode != 0:
            found['failed'] += 1
            return
        look_at(csv.DictReader(open(folder / 'track/track.csv')), truth, found)
        summary = json.loads((folder / 'track/summary.json').read_text())
        errors = flight_errors(summary, truth)
        found['flights'] += bool(errors)
        found.setdefault('flight', []).extend(errors)
        for warning in summary['warnings']:
            if 'no scale' not in warning:
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
