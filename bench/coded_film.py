#!/usr/bin/env python3
"""Whether `track` tells an impact from none in films that a coder has been through.

Paints clips, codes them as H.264 (libx264, CRF 10 to 30), tracks them without options but the rate,
the ball's diameter and the surface's inclination, and compares what is said of an impact with what
was painted. Half of the clips have an impact: contacts of 1 to 15 frames at 500 to 20 000 frames/s,
restitution 0.5 to 0.95, surfaces of +-40 degrees. The others are circles, throws, rolling balls,
pendulums, hands, releases and lines. Flat discs, radius 24 to 60 px, ten patterns, noise 0.5
to 4. Every clip is made of its number alone.

    bench/coded_film.py build/release/impactdic 1 400 [WORKERS]          # clips 1 to 400 of either kind
    bench/coded_film.py build/release/impactdic impact:147 throw:2 …     # these

Says which impacts are missed, which other paths are taken for one, and which restitutions lie more
than three stated deviations off; exits with 1 where one is missed or taken. Needs ffmpeg with
libx264. A clip takes some 5 s of one core.
"""
import concurrent.futures
import csv
import json
import math
import pathlib
import random
import shutil
import subprocess
import sys
import tempfile

DIAMETER_M = 0.067
PATTERNS = ('a1', 'a2', 'b1', 'b2', 'c1', 'c2', 'd1', 'd2', 'e1', 'f1')
FREE = ('circle', 'throw', 'roll', 'swing', 'hand', 'release', 'line')


def run(*arguments, cwd):
    return subprocess.run(arguments, cwd=cwd, capture_output=True, text=True, check=False)


def painting(rng):
    """Options of synth that light and camera choose, and the ball's radius in px."""
    radius = rng.uniform(24, 60)
    options = ['--pattern', rng.choice(PATTERNS), '--seed', str(rng.randrange(10**6)),
               '--noise', f'{rng.uniform(0.5, 4):.2f}', '--blur', f'{rng.uniform(0.5, 1.2):.2f}',
               '--radius-px', f'{radius:.2f}', '--background', f'{rng.uniform(15, 60):.0f}',
               '--white', f'{rng.uniform(150, 220):.0f}']
    return options, radius


def contact_of(contact_s, restitution, mass_kg):
    """Stiffness and damping of a linear spring-damper that lasts so long and gives back so much."""
    decay = -math.log(restitution) / contact_s  # half a period of the damped oscillation
    frequency = math.pi / contact_s
    return mass_kg * (frequency**2 + decay**2), 2 * mass_kg * decay


def impact_clip(rng, folder):
    """Paints a clip with an impact; returns the options of track, the restitution and the story."""
    options, radius = painting(rng)
    metre_per_px = DIAMETER_M / (2 * radius)
    fps = 10 ** rng.uniform(math.log10(500), math.log10(20000))
    frames = 10 ** rng.uniform(0, math.log10(15))
    step = min(rng.uniform(0.6, 6), 0.12 * 2 * radius * math.pi / frames)  # px a frame
    before, after = rng.randint(12, 40), rng.randint(14, 40)
    restitution = rng.uniform(0.5, 0.95)
    vn = -step * metre_per_px * fps
    stiffness, damping = contact_of(frames / fps, restitution, 0.0567)
    angle = round(rng.uniform(-40, 40), 1)
    friction = rng.uniform(0.05, 0.3)
    (folder / 'job.toml').write_text(
        'normal = "linear_spring_damper"\nfriction = "coulomb"\n[body]\nshape = "hollow_sphere"\n'
        f'mass_kg = 0.0567\ndiameter_m = {DIAMETER_M}\n[contact]\nstiffness_n_per_m = {stiffness}\n'
        f'damping_n_s_per_m = {damping}\nfriction_kinetic = {friction:.3f}\n'
        f'[surface]\nangle_deg = {angle}\n[initial]\nvt_m_s = {vn * rng.uniform(0, 1.2)}\n'
        f'vn_m_s = {vn}\n[environment]\ngravity_m_s2 = 9.81\n')
    simulated = run(PROGRAM, 'simulate', 'job.toml', '-o', 'truth', '-q', cwd=folder)
    if simulated.returncode != 0:
        raise RuntimeError(simulated.stderr)
    truth = json.loads((folder / 'truth/summary.json').read_text())['restitution']
    side = int(2 * radius + 40 + 2.2 * step * max(before, after) + step * frames)
    count = before + after + math.ceil(frames)
    painted = run(PROGRAM, 'synth', '-o', 'clip', '-q', '--simulate', 'job.toml', '--touch-frame',
                  f'{before + rng.random():.3f}', '--frames', str(count), '--fps', f'{fps:.1f}',
                  '--size', f'{side}x{side}', '--format', 'raw', *options, cwd=folder)
    if painted.returncode != 0:
        raise RuntimeError(painted.stderr)
    story = f'{frames:.1f} frames of contact, {step:.1f} px a frame, {fps:.0f} frames/s, R {radius:.0f}'
    return side, fps, ['--surface-angle-deg', str(angle)], truth, story


def free_path(kind, frames, rng):
    """x, y (down), px, at each frame, and what a free fall is accelerated by, px a frame^2."""
    size, phase = rng.uniform(15, 90), rng.uniform(0, 2 * math.pi)
    rate = 2 * math.pi / (frames * rng.uniform(0.25, 2))
    vx, vy, ratio = rng.uniform(-2, 2), rng.uniform(-2, 2), rng.uniform(1.3, 3.7)
    middle, gravity = frames * rng.uniform(0.2, 0.8), rng.uniform(0, 4) / frames
    other = rng.uniform(0, 2 * math.pi)
    paths = {
        'circle': lambda t: (size * math.cos(rate * t + phase), size * math.sin(rate * t + phase)),
        'throw': lambda t: (vx * t, gravity * (t - middle) ** 2 / 2),
        'roll': lambda t: (vx * t * (1 - t / frames / 3), 0),
        'swing': lambda t: (2 * size * math.sin(0.6 * math.sin(rate * t + phase)),
                            2 * size * math.cos(0.6 * math.sin(rate * t + phase))),
        'hand': lambda t: (size * math.sin(rate * t + phase),
                           size * (math.sin(rate * t + other)
                                   + 0.3 * math.sin(ratio * rate * t + phase))),
        'release': lambda t: (0, gravity * max(0, t - middle) ** 2 / 2),
        'line': lambda t: (vx * t, vy * t),
    }
    return [paths[kind](t) for t in range(frames)], gravity


def free_clip(rng, folder, kind):
    options, radius = painting(rng)
    frames = rng.randint(40, 110)
    path, gravity = free_path(kind, frames, rng)
    falls = kind in ('throw', 'release')
    fps = math.sqrt(9.81 * 2 * radius / DIAMETER_M / gravity) if falls else 1000
    x, y = zip(*path)
    width = int(max(x) - min(x) + 2 * radius + 40)
    height = int(max(y) - min(y) + 2 * radius + 40)
    spin = rng.uniform(0, 3)
    with open(folder / 'path.csv', 'w', newline='') as file:
        rows = csv.writer(file)
        rows.writerow(['cx_px', 'cy_px', 'angle_deg'])
        for t, (here_x, here_y) in enumerate(path):
            rows.writerow([here_x - min(x) + radius + 20, here_y - min(y) + radius + 20, spin * t])
    painted = run(PROGRAM, 'synth', '-o', 'clip', '-q', '--motion', 'path.csv', '--size',
                  f'{width}x{height}', '--format', 'raw', *options, cwd=folder)
    if painted.returncode != 0:
        raise RuntimeError(painted.stderr)
    angle = f'{rng.uniform(-180, 180):.1f}'
    return (width, height), fps, ['--surface-angle-deg', angle], f'R {radius:.0f}'


def code(folder, width, height, fps, crf):
    coded = run('ffmpeg', '-loglevel', 'error', '-y', '-f', 'rawvideo', '-pix_fmt', 'gray', '-s',
                f'{width}x{height}', '-r', '25', '-i', 'clip/video.raw', '-vf',
                'pad=ceil(iw/2)*2:ceil(ih/2)*2', '-c:v', 'libx264', '-crf', str(crf), '-pix_fmt',
                'yuv420p', '-threads', '1', 'film.mp4', cwd=folder)
    if coded.returncode != 0:
        raise RuntimeError(coded.stderr)


def told(folder, fps, options):
    """What track says of an impact: (status, restitution, its deviation)."""
    tracked = run(PROGRAM, 'track', 'film.mp4', '--fps', f'{fps:.1f}', '--ball-diameter-mm',
                  f'{DIAMETER_M * 1000}', '--no-checksum', '-q', '-j', '1', '-o', 'track', *options,
                  cwd=folder)
    if tracked.returncode != 0:
        return tracked.stderr.strip()[:60] or f'exit {tracked.returncode}', None, None
    impact = json.loads((folder / 'track/summary.json').read_text())['impact']
    restitution = impact.get('restitution') or {}
    return impact['status'], restitution.get('value'), restitution.get('sd')


def one(kind, number):
    rng = random.Random(f'{kind} {number}')
    crf = rng.randint(10, 30)
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        try:
            if kind == 'impact':
                side, fps, options, truth, story = impact_clip(rng, folder)
                width = height = side
            else:
                (width, height), fps, options, story = free_clip(rng, folder, kind)
                truth = None
            code(folder, width, height, fps, crf)
            status, value, sd = told(folder, fps, options)
        except RuntimeError as error:
            return kind, number, f'not made: {str(error).strip()[:120]}', None, None, None, ''
    return kind, number, status, value, sd, truth, f'CRF {crf}, {story}'


def clips_of(arguments):
    """The clips that are asked for, (kind, number), and how many at a time."""
    if ':' in arguments[0]:
        named = [name.partition(':')[::2] for name in arguments]
        for kind, number in named:
            if kind not in ('impact', *FREE) or not number.isdigit():
                sys.exit(f"no clip is called '{kind}:{number}': impact or one of {', '.join(FREE)}, "
                         'a colon and a number')
        return [(kind, int(number)) for kind, number in named], 2
    if len(arguments) < 2 or not all(number.isdigit() for number in arguments):
        sys.exit(__doc__)
    numbers = range(int(arguments[0]), int(arguments[1]) + 1)
    clips = [('impact', n) for n in numbers] + [(FREE[n % len(FREE)], n) for n in numbers]
    return clips, int(arguments[2]) if len(arguments) > 2 else 2


def main():
    if shutil.which('ffmpeg') is None:
        print('skipped: no ffmpeg')
        sys.exit(77)
    clips, workers = clips_of(sys.argv[2:])
    statuses, errors, wrong = {}, [], 0
    with concurrent.futures.ThreadPoolExecutor(workers) as pool:
        for kind, number, status, value, sd, truth, story in pool.map(lambda clip: one(*clip), clips):
            count = statuses.setdefault(kind, {})
            count[status] = count.get(status, 0) + 1
            found = status in ('found', 'not_resolved')
            if not (found if kind == 'impact' else status == 'none'):
                wrong += 1
                print(f'{kind} {number}: {status} ({story})', flush=True)
            elif found and value is not None and sd:
                errors.append((value - truth) / sd)
                if abs(errors[-1]) > 3:
                    print(f'{kind} {number}: restitution {value:.4f} +- {sd:.4f}, truth '
                          f'{truth:.4f} ({story})', flush=True)
            elif found:
                print(f'{kind} {number}: no restitution ({story})', flush=True)
    for kind, count in statuses.items():
        print(kind, ', '.join(f'{status} {n}' for status, n in sorted(count.items())))
    if errors:
        within = [sum(abs(e) < n for e in errors) / len(errors) for n in (2, 3)]
        print(f'restitution of {len(errors)}: within two stated deviations {100 * within[0]:.1f} %, '
              f'three {100 * within[1]:.1f} %, rms error over stated '
              f'{math.sqrt(sum(e * e for e in errors) / len(errors)):.2f}')
    sys.exit(1 if wrong else 0)


PROGRAM = str(pathlib.Path(sys.argv[1]).resolve()) if len(sys.argv) > 2 else sys.exit(__doc__)

if __name__ == '__main__':
    main()
