"""Which shots of a batch go together: those of one ball at one angle of the surface. Means never mix
others. The page of `impactdic view` goes by the same rules (host/view/page/compare.js)."""

import math

import numpy as np

from ..results import read_table


def text(table, name, row):
    """A cell as text; "" where there is none."""
    cell = table[name][row] if name in table else ""
    if isinstance(cell, (float, np.floating)):
        return "" if math.isnan(cell) else f"{cell:g}"
    return str(cell)


def number(table, name, row):
    """A cell as a number; NaN where there is none."""
    try:
        return float(table[name][row]) if name in table else math.nan
    except ValueError:
        return math.nan


def ball_of(table, row):
    """Its name, else what is known of it: diameter, mass, I / (m R²); "" of nothing."""
    name = text(table, "ball", row)
    if name:
        return name
    known = (("ball_diameter_mm", "{} mm"), ("mass_g", "{} g"), ("inertia_factor", "I/mR² {}"))
    return ", ".join(words.format(text(table, column, row)) for column, words in known
                     if text(table, column, row))


def left_out(folder):
    """The shots that a person has left out of the means, and why: excluded.csv of `impactdic view`."""
    path = folder / "excluded.csv"
    if not path.exists():
        return {}
    table = read_table(path)
    return {text(table, "shot", row): text(table, "reason", row)
            for row in range(len(table["shot"]))}


def counted(table, excluded):
    """Whether each shot counts in a mean: measured, not left out, no figure in doubt."""
    return np.array([text(table, "status", row) == "ok" and not text(table, "doubtful", row)
                     and text(table, "shot", row) not in excluded
                     for row in range(len(table["status"]))], dtype=bool)


def mean(values, deviations=None):
    """Mean of shots and its deviation: by the scatter of the values, or by their own deviations where
    those say more, as few shots may agree by chance. NaN where neither is known."""
    values = np.asarray(values, dtype=float)
    own = np.full(len(values), np.nan) if deviations is None else np.asarray(deviations, float)
    known = np.isfinite(values)
    values, own, count = values[known], own[known], int(known.sum())
    if count == 0:
        return math.nan, math.nan
    said = [np.std(values, ddof=1) / math.sqrt(count)] if count > 1 else []
    if np.isfinite(own).all() and own.any():
        said.append(np.sqrt(np.sum(own**2)) / count)
    return float(np.mean(values)), float(max(said, default=math.nan))
