"""Figures of a folder of `study`: which pattern and which method measure how exactly."""

import numpy as np

from ..results import read_table
from .figure import COLOURS, MARKERS, Figure, Panel, Series
from .first import First
from .tables import Table

FLOOR = 1e-5  # errors below it are drawn at it: a logarithmic axis has no zero
QUANTITIES = (("dx_abs_px", "error of dx, px/frame"), ("dy_abs_px", "error of dy, px/frame"),
              ("rot_abs_deg", "error of rotation, °/frame"))
METHODS = {"literal": "as the source describes it", "published": "the same result by our route",
           "icgn": "the default method"}
MOST_ESTIMATORS = len(MARKERS)


def is_study(folder):
    return (folder / "patterns.csv").exists() or (folder / "density.csv").exists()


def first_screen(result):
    return First(str(result.summary.get("finding") or ""))


def figures(folder):
    made = []
    if (folder / "patterns.csv").exists():
        table = read_table(folder / "patterns.csv")
        made += [_motion(table, str(motion)) for motion in dict.fromkeys(table["motion"])]
    if (folder / "density.csv").exists():
        made.append(_density(read_table(folder / "density.csv")))
    return made


def _motion(table, motion):
    """Figs 2.4 to 2.7: mean absolute error of every pattern and estimator for one motion."""
    mine = table["motion"] == motion
    patterns = [str(p) for p in dict.fromkeys(table["pattern"])]
    estimators = list(dict.fromkeys(table["estimator"]))[:MOST_ESTIMATORS]
    places = np.array([patterns.index(p) for p in table["pattern"]], float)
    panels = []
    for column, label in QUANTITIES:
        series = []
        for k, estimator in enumerate(estimators):
            rows = mine & (table["estimator"] == estimator)
            aside = 0.7 * (k - (len(estimators) - 1) / 2) / len(estimators)
            series.append(Series(str(estimator), places[rows] + aside,
                                 np.maximum(FLOOR, table[column][rows]), None,
                                 COLOURS[k % len(COLOURS)], "markers", MARKERS[k % len(MARKERS)],
                                 labels=[str(p) for p in table["pattern"][rows]]))
        panels.append(Panel(label.split(",")[0], "pattern", f"mean absolute {label}", series,
                            x_names=patterns, log_y=True))
    row = int(np.flatnonzero(mine)[0])
    steps = [float(table[name][row]) for name in ("dx_px", "dy_px", "rot_deg")]
    return Figure(f"study_{motion}", f"Motion '{motion}'",
                  f"{steps[0]:g}, {steps[1]:g} px/frame and {steps[2]:g}°/frame; mean over the "
                  "pairs of frames.", panels, "Study")


def _density(table):
    """Fig. 2.2: time and error against the spline points between pixels."""
    panels = []
    for column, label in (("us_per_window", "time a window, µs"), ("rms_px", "rms error, px")):
        series = []
        for k, method in enumerate(dict.fromkeys(table["method"])):
            rows = table["method"] == method
            series.append(Series(METHODS.get(str(method), str(method)), table["points"][rows],
                                 np.maximum(FLOOR, table[column][rows]), None, COLOURS[k],
                                 "markers", MARKERS[k]))
        panels.append(Panel(label.split(",")[0], "spline points between pixels", label, series,
                            log_y=True))
    return Figure("study_density", "Spline points between pixels",
                  "What more points cost, and what they gain.", panels, "Study")


def tables(result):
    """Of the estimators, over all motions that the study has."""
    rows = []
    for name, groups in (result.summary.get("estimators") or {}).items():
        every = groups.get("all") or {}
        rows.append([name] + ["" if every.get(key) is None else f"{every[key]:.2g}" for key in (
            "motion_rms_px", "rot_rms_deg", "bound_px")] + [str(every.get("pairs_failed", ""))])
    if not rows:
        return []
    return [Table("Estimators, all patterns and motions",
                  ["estimator", "rms of the motion, px", "rms of the rotation, °",
                   "bound by the noise, px", "pairs failed"], rows, "Study")]
