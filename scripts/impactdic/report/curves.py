"""Tables of commands that have no page of their own (synth, rod): every column over time."""

import numpy as np

from ..results import read_table
from ..tables import unit_of
from .figure import COLOURS, Figure, Panel, Series

MOST_POINTS = 2000  # of one curve
OTHERS = {"report", "shots", "excluded"}  # tables that are none of these


def tables_in(folder):
    """Name and columns of the tables with a time or a frame in every row."""
    found = []
    for path in sorted(folder.glob("*.csv")):
        if path.stem in OTHERS:
            continue
        table = read_table(path)
        if ("time_s" in table or "frame" in table) and len(next(iter(table.values()))):
            found.append((path.name, table))
    return found


def figure(name, table):
    """A panel for each unit."""
    time = table.get("time_s")
    known = time is not None and time.dtype.kind == "f" and np.isfinite(time).any()
    at, label = (1e3 * time, "time, ms") if known else (table.get("frame"), "frame")
    if at is None or at.dtype.kind != "f":
        return None
    step = max(1, len(at) // MOST_POINTS)
    panels = {}
    for column, values in table.items():
        if column in ("time_s", "frame") or values.dtype.kind != "f" or not np.isfinite(values).any():
            continue
        unit = unit_of(column)
        panel = panels.setdefault(unit, Panel("", label, unit or "value"))
        panel.series.append(Series(column, at[::step], values[::step],
                                   colour=COLOURS[len(panel.series) % len(COLOURS)]))
    stem = name.removesuffix(".csv")
    return Figure(stem, name, "Every column of the table; units stand in the names.",
                  list(panels.values()), "Tables") if panels else None
