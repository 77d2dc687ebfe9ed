#!/usr/bin/env python3
"""What `track` makes of impacts that nobody chose.

Draws by the seed: the ball's size and pattern, its greys and its lamp, the impact, the camera's rate
and noise, and two of the changes of impact_film.py.

    bench/film/random_impacts.py build/release/impactdic FIRST LAST [OPTION OF TRACK ...]

One line a clip of which something is wrong or lost, and at last the sums: impacts that were found,
rows with status ok and those of them that are wrong as in impact_film.py, and how many errors of
restitution, friction and spin are larger than two and three stated deviations. Needs numpy. A clip
takes 5 s.
"""
import argparse
import collections
import pathlib
import sys

import numpy as np

from impact_film import one, set_job

PATTERNS = 'a1 a2 b1 b2 b3 c1 c2 c3 d1 d2 e1 e2 f1 f2'.split()
JOBS = 'racket_15 racket_30 racket_45 racket_57 wood_20 wood_30 wood_40'.split()
FRAMES = {2000: 90, 4000: 110, 8000: 160, 10000: 190, 20000: 260}  # by the rate
# Of two changes the first one here is made first: the ball's own, what is behind it, what flies about,
# light, lens and sensor.
ORDER = ('rings flakes fuzz sloping cast paper floor glossy shadowed recoils strings hand spare debris '
         'dust front flash dims saturated defocused sensor plain').split()


def drawn(program, options, seed):
    """(arguments as of impact_film.py, changes, body)"""
    random = np.random.default_rng([seed, 99])
    arguments = argparse.Namespace(program=program, options=options)
    arguments.radius = float(np.round(np.exp(random.uniform(np.log(28), np.log(120))), 1))
    arguments.side = min(720, int(arguments.radius * random.uniform(5.5, 8)) // 2 * 2)
    arguments.noise = float(random.choice([1, 2, 3, 4]))
    body = str(random.choice(['disc', 'sphere']))
    job = str(random.choice(JOBS))
    arguments.job = str(pathlib.Path(__file__).resolve().parents[2] / f'sim/jobs/{job}.toml')
    rate = int(random.choice(list(FRAMES)))
    arguments.frames = FRAMES[rate]
    arguments.touch = round(arguments.frames * random.uniform(0.25, 0.45), 1)
    arguments.patterns = [str(random.choice(PATTERNS))]
    synth = f'--fps {rate} --white {int(random.uniform(150, 220))} --ink {int(random.uniform(25, 70))}'
    if body == 'sphere':
        synth += (f' --lamp {round(random.uniform(0, 0.4), 2)}'
                  f' --lamp-deg {int(random.uniform(-180, 180))}')
    arguments.synth = synth
    changes = sorted(random.choice(ORDER, 2, replace=False), key=ORDER.index)
    set_job(arguments)
    return arguments, '+'.join(changes), body


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('program', type=lambda path: str(pathlib.Path(path).resolve()))
    parser.add_argument('first', type=int)
    parser.add_argument('last', type=int)
    given, options = parser.parse_known_args()
    rows, errors = collections.Counter(), {'e': [], 'mu': [], 'spin': []}
    for seed in range(given.first, given.last + 1):
        arguments, changes, body = drawn(given.program, options, seed)
        found = collections.Counter(warned=collections.Counter(), statuses=collections.Counter())
        one(arguments, changes, body, seed, found)
        for name in ('found', 'ok', 'not ok', 'wrong', 'failed'):
            rows[name] += found[name]
        for name, values in errors.items():
            values += [found[name]] if found['found'] else []
        if found['wrong'] or not found['found'] or max(found[name] for name in errors) > 3:
            told = 'found' if found['found'] else next(iter(found['statuses']), 'failed')
            print(f"{seed} {changes} {body}: {told}, ok {found['ok']}, not ok {found['not ok']}, wrong "
                  f"{found['wrong']}, e {found['e']:.1f} mu {found['mu']:.1f} spin {found['spin']:.1f} | "
                  f"{arguments.patterns[0]}, {arguments.radius} px, noise {arguments.noise:.0f}, "
                  f"{pathlib.Path(arguments.job).stem}, {arguments.synth}", flush=True)
    print(f"found {rows['found']} of {given.last - given.first + 1}, ok {rows['ok']}, not ok {rows['not ok']}, wrong "
          f"{rows['wrong']}" + (f", failed {rows['failed']}" if rows['failed'] else ''))
    for name, values in errors.items():
        beyond = [sum(value > sds for value in values) for sds in (2, 3)]
        print(f'{name}: beyond 2 deviations {beyond[0]}, 3 deviations {beyond[1]} of {len(values)}')
    sys.exit(1 if rows['wrong'] else 0)


if __name__ == '__main__':
    main()
