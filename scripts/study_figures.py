#!/usr/bin/env python3
"""study_figures.py DIR: figures of the source's chapter 2 from `impactdic study -o DIR`.

From patterns.csv: figure_2_4 (one direction), 2_5 (two directions), 2_6 (rotation) and 2_7 (general
motion), mean absolute error of each pattern and estimator beside the values that the source prints,
and motions_fraction, the same for the four motions on no grid. From density.csv: figure_2_1 (a
window and its spline) and figure_2_2 (time and error against spline points). Each as PNG and SVG.
"""
import argparse
import csv
import math
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

# What section 2.3 of the source states in words: mean absolute error of a pattern, by motion and
# quantity. Its bars have no numbers.
SOURCE = {
    ("x", "dx_abs_px"): {"e1": 0.01, "e2": 0.02, "a3": 0.1, "a2": 0.1, "b2": 0.1, "b3": 0.1,
                         "f1": 0.1, "f2": 0.1},
    ("xy", "dx_abs_px"): {"e1": 0.016},
    ("xy", "dy_abs_px"): {"e1": 0.037},
    ("turn", "rot_abs_deg"): {"e1": 0.1},
}
LABELS = {
    "dx_abs_px": "mean |error| of dx, px/frame",
    "dy_abs_px": "mean |error| of dy, px/frame",
    "rot_abs_deg": "mean |error| of rotation, °/frame",
}
FIGURES = {
    "figure_2_4": ("x", ["dx_abs_px"], "translation in one direction, 1 px/frame"),
    "figure_2_5": ("xy", ["dx_abs_px", "dy_abs_px"], "translation in two directions, 1, 1 px/frame"),
    "figure_2_6": ("turn", ["rot_abs_deg"], "rotation, 3°/frame"),
    "figure_2_7": ("general", ["dx_abs_px", "dy_abs_px", "rot_abs_deg"],
                   "general motion, 1, 1 px/frame and 3°/frame"),
}
# Errors below this are drawn at it: a logarithmic axis has no zero.
FLOOR = 1e-5


def read(path):
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def number(text):
    return float(text) if text else math.nan


def in_order(rows, column):
    return list(dict.fromkeys(row[column] for row in rows))


def save(figure, folder, name):
    for kind in ("png", "svg"):
        figure.savefig(folder / f"{name}.{kind}", dpi=130)
    plt.close(figure)
    print(folder / f"{name}.png")


def draw_errors(axis, rows, motion, quantity):
    """One mark per pattern and estimator; the source's values as crosses."""
    patterns, estimators = in_order(rows, "pattern"), in_order(rows, "estimator")
    width = 0.8 / len(estimators)
    for k, estimator in enumerate(estimators):
        values = {row["pattern"]: number(row[quantity]) for row in rows
                  if row["motion"] == motion and row["estimator"] == estimator}
        places = [i + (k - (len(estimators) - 1) / 2) * width for i in range(len(patterns))]
        axis.plot(places, [max(FLOOR, values.get(p, math.nan)) for p in patterns], "o",
                  markersize=5, label=estimator)
    printed = SOURCE.get((motion, quantity), {})
    known = [p for p in patterns if p in printed]
    if known:
        axis.plot([patterns.index(p) for p in known], [printed[p] for p in known], "kx",
                  label="source, as printed")
    axis.set_yscale("log")
    axis.set_xticks(range(len(patterns)), patterns)
    axis.set_ylabel(LABELS[quantity])
    axis.grid(axis="y", alpha=0.3)
    for i in range(1, len(patterns)):
        axis.axvline(i - 0.5, color="0.9", linewidth=0.8, zorder=0)


def draw_motion(rows, folder, name, motion, quantities, title):
    figure, axes = plt.subplots(len(quantities), 1, squeeze=False, layout="constrained",
                                figsize=(11, 1 + 3.2 * len(quantities)))
    for axis, quantity in zip(axes[:, 0], quantities):
        draw_errors(axis, rows, motion, quantity)
    axes[-1, 0].set_xlabel("pattern")
    axes[0, 0].legend(ncols=8, fontsize="small", loc="lower center", bbox_to_anchor=(0.5, 1.0))
    figure.suptitle(title)
    save(figure, folder, name)


def draw_patterns(folder):
    rows = read(folder / "patterns.csv")
    motions = in_order(rows, "motion")
    for name, (motion, quantities, title) in FIGURES.items():
        if motion in motions:
            draw_motion(rows, folder, name, motion, quantities, title)
    fractions = [m for m in motions if m.endswith("_fraction")]
    for motion in fractions:
        row = next(r for r in rows if r["motion"] == motion)
        title = f"{row['dx_px']}, {row['dy_px']} px/frame and {row['rot_deg']}°/frame"
        draw_motion(rows, folder, "motion_" + motion, motion, list(LABELS), title)


def draw_window(axis, path, title):
    rows = read(path)
    xs, ys = sorted({number(r["x_px"]) for r in rows}), sorted({number(r["y_px"]) for r in rows})
    grey = [[0.0] * len(xs) for _ in ys]
    column = {x: i for i, x in enumerate(xs)}
    line = {y: i for i, y in enumerate(ys)}
    for r in rows:
        grey[line[number(r["y_px"])]][column[number(r["x_px"])]] = number(r["grey"])
    half = (xs[1] - xs[0]) / 2
    axis.imshow(grey, cmap="gray", extent=(xs[0] - half, xs[-1] + half, ys[-1] + half, ys[0] - half))
    axis.set(title=title, xlabel="x, px", ylabel="y, px")


def draw_density(folder):
    figure, axes = plt.subplots(1, 2, layout="constrained", figsize=(9, 4.6))
    draw_window(axes[0], folder / "window.csv", "(a) a window")
    draw_window(axes[1], folder / "window_spline.csv", "(b) 5 points between pixels")
    save(figure, folder, "figure_2_1")

    rows = read(folder / "density.csv")
    names = {"literal": "as the source describes it", "published": "the same result by our route",
             "icgn": "the default method"}
    figure, axes = plt.subplots(1, 2, layout="constrained", figsize=(11, 4.4))
    for axis, quantity, label in ((axes[0], "us_per_window", "time a window, µs"),
                                  (axes[1], "rms_px", "rms error, px")):
        for method in in_order(rows, "method"):
            mine = [r for r in rows if r["method"] == method]
            axis.plot([int(r["points"]) for r in mine], [number(r[quantity]) for r in mine], "o-",
                      label=names.get(method, method))
        axis.set_yscale("log")
        axis.set(xlabel="spline points between pixels", ylabel=label)
        axis.grid(alpha=0.3)
    axes[0].legend(fontsize="small")
    save(figure, folder, "figure_2_2")


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path, help="what impactdic study wrote")
    folder = parser.parse_args().folder
    found = False
    if (folder / "patterns.csv").exists():
        draw_patterns(folder)
        found = True
    if (folder / "density.csv").exists():
        draw_density(folder)
        found = True
    if not found:
        sys.exit(f"study_figures: {folder} holds neither patterns.csv nor density.csv")


if __name__ == "__main__":
    main()
