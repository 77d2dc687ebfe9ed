"""Where the ball's centre goes."""

import numpy as np

from .figure import BLACK, BLUE, ORANGE, RED, SKY, Figure, Panel, Series

MARKS = (("contact starts", "circle"), ("most compressed", "diamond"), ("contact ends", "square"))


def trajectory(shot):
    """Figs 3.10 and 3.16: the path, the ball where the contact starts and ends, and the surface."""
    marks = [(name, instant, marker) for (name, marker), instant in zip(MARKS, shot.instants)
             if instant is not None]
    caption = "Global axes: x right, y up. Local axes: t along the surface, n out of it."
    if shot.instants[0] is not None and np.isfinite(shot.radius):
        caption += " Dashed: the free ball. The surface is drawn where it touches the ball first."

    def panel(title, x, y, names, turned):
        series = [Series("centre of the ball", x, y)]
        for name, instant, marker in marks:
            at = [np.array([np.interp(instant, shot.time, values)]) for values in (x, y)]
            series.append(Series(name, *at, colour=RED, kind="markers", marker=marker))
        series += _surroundings(shot, turned)
        labels = [f"{name}, {shot.length}" for name in names]
        return Panel(title, *labels, series, same_scale=True)

    return Figure(
        "trajectory",
        "Trajectory of the centre",
        caption,
        [
            panel("global axes", shot.x, shot.y, "xy", shot.angle),
            panel("local axes", shot.t, shot.n, "tn", 0.0),
        ],
    )


def _surroundings(shot, turned):
    """Ball and surface in axes in which the surface is inclined by `turned`."""
    start, _, end = shot.instants
    radius = shot.radius
    if start is None or not np.isfinite(radius):
        return []
    c, s = np.cos(turned), np.sin(turned)

    def placed(name, t, n, colour, dash):
        return Series(name, c * t - s * n, s * t + c * n, colour=colour, dash=dash)

    around = np.linspace(0, 2 * np.pi, 73)
    made, touched = [], []
    for name, instant, colour in (("ball, contact starts", start, SKY),
                                  ("ball, contact ends", end, ORANGE)):
        if instant is None:
            continue
        t, n = (np.interp(instant, shot.time, values) for values in (shot.t, shot.n))
        made.append(placed(name, t + radius * np.cos(around), n + radius * np.sin(around), colour,
                           True))
        touched.append(t)
    ground = np.interp(start, shot.time, shot.n) - radius
    along = np.array([min(touched) - 1.2 * radius, max(touched) + 1.2 * radius])
    made.append(placed("surface", along, np.full(2, ground), BLACK, False))
    return made
