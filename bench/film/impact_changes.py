"""What may change an impact's film: floors, dust, light, the sensor. Each change takes the shot and
its pictures, floats of (frames, rows, columns), and gives them back changed."""
import csv
import math

import numpy as np

from film_changes import blurred

BACKGROUND = 60  # grey levels


def set_size(side, radius):
    """Of the pictures, which are squares, and of the ball, px."""
    global SIDE, RADIUS, Y, X
    SIDE, RADIUS = side, radius
    Y, X = np.mgrid[0:SIDE, 0:SIDE].astype(float)


set_size(400, 60)


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


def sloping(shot, pictures):
    """The wall behind is lit from one side: from 20 to 160 grey levels across the picture."""
    for p, behind in zip(pictures, shot.behind()):
        p += behind * (20 + 140 * X / SIDE - BACKGROUND)
    return pictures


def cast(shot, pictures):
    """The ball's own shadow lies on a bright wall behind it, soft at its edge."""
    for k, (p, behind) in enumerate(zip(pictures, shot.behind())):
        x, y = shot.centres[k] + (40, 25)
        p += behind * (150 * (1 - 0.6 * step(RADIUS - np.hypot(X - x, Y - y), 2.5)) - BACKGROUND)
    return pictures


def paper(shot, pictures):
    """Squared paper behind, about as bright as the ball, its lines about as dark as ink."""
    lines = np.maximum(step(0.7 - np.abs(X % 12 - 6)), step(0.7 - np.abs(Y % 12 - 6)))
    for p, behind in zip(pictures, shot.behind()):
        p += behind * (170 - 110 * lines - BACKGROUND)
    return pictures


def sensor(shot, pictures):
    """Columns of other gains (2 %) and offsets (3 grey levels); 20 hot and 20 dead pixels."""
    gains, offsets = shot.random.normal(1, 0.02, SIDE), shot.random.normal(0, 3, SIDE)
    y, x = shot.random.integers(0, SIDE, (2, 40))
    for p in pictures:
        p[:] = p * gains + offsets
        p[y[:20], x[:20]], p[y[20:], x[20:]] = 255, 0
    return pictures


def strings(shot, pictures):
    """A racket's strings below the surface, seen behind the ball."""
    across = X * shot.along[0] + Y * shot.along[1]
    woven = (np.abs(across % 24 - 12) < 2) | (np.abs(shot.depth() % 24 - 12) < 2)
    for k, p in enumerate(pictures):
        p += woven * (shot.depth() > 0) * step(shot.outside(k)) * (230 - p)
    return pictures


CHANGES = {change.__name__: change for change in (
    plain, floor, front, rings, debris, flakes, dust, fuzz, flash, dims, glossy, shadowed, recoils,
    spare, hand, defocused, saturated, sloping, cast, paper, sensor, strings)}
