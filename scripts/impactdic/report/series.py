"""Slopes and sums of measured series."""

import numpy as np


def slope(x, y, sd, half):
    """Slope of the least-squares line through each point and `half` neighbours on both sides, and
    its standard deviation; NaN where one of them is missing. `x` is evenly spaced."""
    offsets = np.arange(-half, half + 1)
    step = np.median(np.diff(x))
    weights = offsets / (step * np.sum(offsets**2))
    result, deviation = np.full(len(y), np.nan), np.full(len(y), np.nan)
    for i in range(half, len(y) - half):
        near = slice(i - half, i + half + 1)
        result[i] = weights @ y[near]
        deviation[i] = np.sqrt(np.sum((weights * sd[near]) ** 2))
    return result, deviation


def deflection(time, vn, start):
    """Minus the way along n since `start`, at the instants `time`. vn[k] is the mean velocity from
    time[k] to the next instant; a gap in it leaves NaN from there on."""
    way = np.concatenate([[0.0], np.cumsum(vn[:-1] * np.diff(time))])
    return np.interp(start, time, way) - way
