#!/usr/bin/env python3
"""compare_truth.py TRUTH.csv TRACK.csv: the measured motion against the exact one.

Prints the mean and rms error of the ball's centre (px), motion (px/frame) and rotation
(degrees/frame). With --json prints the same as one JSON object.
"""
import argparse
import csv
import json
import math


def read(path):
    with open(path, newline="") as file:
        return {int(row["frame"]): row for row in csv.DictReader(file)}


def errors(truth, track, column):
    """Measured minus true where both are known."""
    found = []
    for frame, row in track.items():
        if row[column] and frame in truth and truth[frame][column]:
            found.append(float(row[column]) - float(truth[frame][column]))
    return found


def summarise(values):
    if not values:
        return {"count": 0, "mean": None, "rms": None, "largest": None}
    return {
        "count": len(values),
        "mean": sum(values) / len(values),
        "rms": math.sqrt(sum(v * v for v in values) / len(values)),
        "largest": max(abs(v) for v in values),
    }


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("truth")
    parser.add_argument("track")
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    truth, track = read(options.truth), read(options.track)
    columns = ["cx_px", "cy_px", "r_px", "dx_px", "dy_px", "rot_deg"]
    result = {name: summarise(errors(truth, track, name)) for name in columns}
    if options.json:
        print(json.dumps(result))
        return
    print(f"  {'':8} {'frames':>6} {'mean error':>11} {'rms error':>10} {'largest':>9}")
    for name, figures in result.items():
        if figures["count"] == 0:
            print(f"  {name:8} {0:6}  not measured")
            continue
        print(
            f"  {name:8} {figures['count']:6} {figures['mean']:11.5f} {figures['rms']:10.5f} "
            f"{figures['largest']:9.5f}"
        )


if __name__ == "__main__":
    main()
