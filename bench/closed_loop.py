#!/usr/bin/env python3
"""How often the laboratory finds back what was put into a video.

For every seed a tennis ball strikes a racket at 0 and at 30 degrees (pattern f1, noise 2, another
speed and another fraction of a frame at the touch each time): synth --simulate, track, fit.
Prints, per parameter: how many truths lie inside their 95 % interval, the mean and the largest
relative error, and the mean stated deviation.

    bench/closed_loop.py build/release/impactdic [SEEDS]      about 10 s a seed
"""
import json
import pathlib
import subprocess
import sys
import tempfile

STIFFNESS, DAMPING, FRICTION = 12526.0, 6.85, 0.0941
BODY = '[body]\nshape = "hollow_sphere"\nmass_kg = 0.0567\ndiameter_m = 0.067\n'


def impact_job(angle, vn):
    oblique = angle > 0
    return (f'normal = "linear_spring_damper"\nfriction = "{"coulomb" if oblique else "none"}"\n'
            f'{BODY}[contact]\nstiffness_n_per_m = {STIFFNESS}\ndamping_n_s_per_m = {DAMPING}\n'
            + (f'friction_kinetic = {FRICTION}\n' if oblique else '')
            + f'[surface]\nangle_deg = {angle}\n[initial]\n'
            f'vt_m_s = {-1.81 if oblique else 0.0}\nvn_m_s = {vn}\n')


def fit_job(angle):
    friction = ', "friction_kinetic"' if angle > 0 else ''
    return (f'normal = "linear_spring_damper"\nfriction = "{"coulomb" if angle > 0 else "none"}"\n'
            f'tracks = ["track/track.csv"]\n{BODY}[fit]\n'
            f'parameters = ["stiffness_n_per_m", "damping_n_s_per_m"{friction}]\n')


def close_loop(program, folder, seed, angle):
    """Estimates {name: (value, sd, truth)} of one clip."""
    def run(*arguments):
        subprocess.run([program, *arguments, '-q'], cwd=folder, check=True)

    (folder / 'impact.toml').write_text(impact_job(angle, round(-3.0 - 0.09 * seed, 2)))
    (folder / 'fit.toml').write_text(fit_job(angle))
    run('simulate', 'impact.toml', '-o', 'sim')
    run('synth', '--simulate', 'impact.toml', '--seed', str(seed), '--pattern', 'f1', '--noise',
        '2', '--size', '360x460', '--frames', '170', '--touch-frame', str(48 + 0.173 * seed), '-o',
        'clip')
    run('track', 'clip/video.tif', '--fps', '10000', '--ball-diameter-mm', '67',
        '--surface-angle-deg', str(angle), '--inertia-factor', '0.667', '-o', 'track')
    run('fit', 'fit.toml', '-o', 'fit')
    truth = json.loads((folder / 'sim/summary.json').read_text())
    fit = json.loads((folder / 'fit/summary.json').read_text())['shots'][0]
    found = {key: (fit['parameters'][key], value)
             for key, value in (('stiffness_n_per_m', STIFFNESS), ('damping_n_s_per_m', DAMPING),
                                ('friction_kinetic', FRICTION)) if key in fit['parameters']}
    for key in ('restitution', 'contact_s'):
        found[key] = (fit['derived'][key], truth[key])
    return {key: (e['value'], e['sd'], value) for key, (e, value) in found.items()}


def main():
    program = str(pathlib.Path(sys.argv[1]).resolve())
    seeds = int(sys.argv[2]) if len(sys.argv) > 2 else 12
    for angle in (0, 30):
        table = {}
        for seed in range(1, seeds + 1):
            with tempfile.TemporaryDirectory() as folder:
                for key, row in close_loop(program, pathlib.Path(folder), seed, angle).items():
                    table.setdefault(key, []).append(row)
        print(f'{angle} degrees, {seeds} clips')
        for key, rows in table.items():
            inside = sum(abs(value - truth) < 1.96 * sd for value, sd, truth in rows)
            errors = [value / truth - 1 for value, _, truth in rows]
            print(f'  {key:20} inside {inside} of {len(rows)}, error mean '
                  f'{sum(errors) / len(rows):+.1e}, largest {max(map(abs, errors)):.1e}, stated '
                  f'deviation {sum(sd / truth for _, sd, truth in rows) / len(rows):.1e}')


if __name__ == '__main__':
    main()
