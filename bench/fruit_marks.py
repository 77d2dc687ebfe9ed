#!/usr/bin/env python3
"""How far marked points of turning fruits are carried from where a person saw them.

    bench/fruit_marks.py build/release/impactdic ../shared/data/sphere/fruit/*

Each folder holds obj0000/, the views, and ground_truth.txt, whose lines are `obj0000, first view,
second view, x, y, x', y'` (px). Tracks the views and carries each marked point to the other view
by the outlines and the turn of track.csv; prints the distances to the marked ones. Beside them:
the same turns on circles of each outline's mean radius in place of ellipses; and what is left,
under both, by the turns that fit the marks of a pair of views themselves best, which is the least
that any turn leaves. A pair with one mark leaves nothing: those with more are shown alone.
"""
import argparse
import csv
import itertools
import math
import pathlib
import statistics
import subprocess
import tempfile


def turned(vector, turn):
    """By a rotation vector, rad (Rodrigues)."""
    angle = math.sqrt(sum(value * value for value in turn))
    if angle < 1e-12:
        return vector
    k = [value / angle for value in turn]
    along = sum(a * b for a, b in zip(k, vector)) * (1 - math.cos(angle))
    across = [k[1] * vector[2] - k[2] * vector[1], k[2] * vector[0] - k[0] * vector[2],
              k[0] * vector[1] - k[1] * vector[0]]
    return [v * math.cos(angle) + c * math.sin(angle) + n * along
            for v, c, n in zip(vector, across, k)]


class View:
    """A row of track.csv: the outline, and the turn to the next view."""

    def __init__(self, row, is_round):
        number = {key: float(value) if value else math.nan for key, value in row.items()
                  if key.endswith(('_px', '_deg'))}
        e1, e2 = (0, 0) if is_round else (number['e1_px'], number['e2_px'])
        self.centre = number['cx_px'], number['cy_px']
        self.xx, self.xy, self.yy = number['r_px'] + e1, e2, number['r_px'] - e1
        self.turn = [math.radians(number[key]) for key in ('rot_x_deg', 'rot_y_deg', 'rot_deg')]

    def lifted(self, x, y):
        """The point of the unit sphere that is seen there; X right, Y up, Z to the camera."""
        x, y = x - self.centre[0], y - self.centre[1]
        area = self.xx * self.yy - self.xy * self.xy
        u, v = (self.yy * x - self.xy * y) / area, (self.xx * y - self.xy * x) / area
        depth = math.sqrt(max(0, 1 - u * u - v * v))
        length = math.sqrt(u * u + v * v + depth * depth)
        return u / length, -v / length, depth / length

    def seen(self, point):
        u, v = point[0], -point[1]
        return (self.centre[0] + self.xx * u + self.xy * v,
                self.centre[1] + self.xy * u + self.yy * v)


def distance(views, mark, turn):
    first, second, x, y, marked_x, marked_y = mark
    if first > second:
        turn = [-value for value in turn]
    seen = views[second].seen(turned(views[first].lifted(x, y), turn))
    return math.dist(seen, (marked_x, marked_y))


def by_pair(marks):
    pairs = {}
    for mark in marks:
        pairs.setdefault(min(mark[:2]), []).append(mark)
    return pairs


def best_left(views, marks, turn):
    """Distances under the turn that makes their squares least, by steps that halve."""
    def squares(by):
        return sum(distance(views, mark, by) ** 2 for mark in marks)
    step, best = 0.1, squares(turn)
    while step > 1e-5:
        tries = [[t + step * s for t, s in zip(turn, signs)]
                 for signs in itertools.product((-1, 0, 1), repeat=3)]
        nearest = min(tries, key=squares)
        if squares(nearest) < best:
            turn, best = nearest, squares(nearest)
        else:
            step /= 2
    return [distance(views, mark, turn) for mark in marks]


def words(distances):
    return (f'median {statistics.median(distances):.2f}, mean {statistics.mean(distances):.2f}, '
            f'largest {max(distances):.1f} px of {len(distances)}')


def read_marks(path):
    rows = [line.split(',') for line in path.read_text().splitlines() if line.strip()]
    return [(int(row[1]), int(row[2]), *map(float, row[3:7])) for row in rows]


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('program')
    parser.add_argument('folders', nargs='+', type=pathlib.Path)
    options = parser.parse_args()
    for folder in options.folders:
        marks = read_marks(folder / 'ground_truth.txt')
        with tempfile.TemporaryDirectory() as scratch:
            out = pathlib.Path(scratch) / 'out'
            subprocess.run([options.program, 'track', folder / 'obj0000', '-o', out, '-q'],
                           check=True)
            with open(out / 'track.csv', newline='', encoding='utf-8') as table:
                rows = list(csv.DictReader(table))
        print(folder.name)
        for name, is_round in (('ellipses', False), ('circles', True)):
            views = [View(row, is_round) for row in rows]
            turns = [distance(views, mark, views[min(mark[:2])].turn) for mark in marks]
            least = [left for first, group in by_pair(marks).items() if len(group) > 1
                     for left in best_left(views, group, views[first].turn)]
            print(f'  {name}: {words(turns)}')
            print(f'    the least by any turn, of pairs with several marks: {words(least)}')
            print('    each:', ' '.join(f'{value:.1f}' for value in turns))


if __name__ == '__main__':
    main()
