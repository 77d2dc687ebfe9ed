"""A clip before it is measured: what `impactdic info -o` has written."""

import math

import matplotlib.image
import numpy as np

from . import first
from .figure import BLUE, RED, Figure, Panel, Series


def is_clip(folder, job):
    return job.get("command") == "info" and (folder / "summary.json").exists()


def first_screen(result):
    summary, folder = result.summary, result.folder
    made = first.First(sentence(summary), first.texture_light(summary))
    ball = summary.get("ball")
    seen = (summary.get("advice") or {}).get("frames_with_ball", 0)
    looked = (summary.get("advice") or {}).get("frames_looked_at", 0)
    if ball:
        made.lights.insert(0, first.Light("ball", "good" if seen == looked else "bad",
                                          f"seen in {seen} of {looked} frames looked at"))
    for frame in summary.get("key_frames") or []:
        path = folder / frame["picture"]
        if path.exists():
            grey = np.round(255 * matplotlib.image.imread(path)).astype(np.uint8)
            ball = frame.get("outline")
            outline = ball and first.Shape(ball["cx_px"], ball["cy_px"], ball["radius_px"],
                                           ball["radius_px"], 0.0)
            made.pictures.append(first.KeyPicture(
                f"{frame['moment']}, frame {frame['frame']}", grey, frame["x_px"], frame["y_px"],
                outline, np.empty((0, 2)), None, None, None))
    return made


def sentence(summary):
    """ "512 × 512 px, 8 bits, 1000 frames at 10000 1/s; windows of 15 px err by 0.0021 px" """
    source = summary.get("input") or {}
    text = (f"{source.get('width_px')} × {source.get('height_px')} px, {source.get('bits')} bits, "
            f"{source.get('frames')} frames")
    if source.get("fps"):
        text += f" at {source['fps']:g} 1/s"
    ball = summary.get("ball")
    text += f"; a ball of radius {ball['radius_px']:.1f} px" if ball else "; no ball"
    windows = (summary.get("advice") or {}).get("windows") or {}
    if windows.get("expected_error_px") is not None:
        text += (f"; windows of {windows['window_px']} px are expected to err by "
                 f"{windows['expected_error_px']:.2g} px")
    return text


def figures(summary):
    sizes = (summary.get("advice") or {}).get("window_sizes") or []
    sizes = [size for size in sizes if size.get("windows")]
    if not sizes:
        return []

    def series(name, values, colour):
        return Series(name, np.array([size["window_px"] for size in sizes]),
                      np.array(values, dtype=float), None, colour, "markers")

    errors = [math.nan if size.get("expected_error_px") is None else size["expected_error_px"]
              for size in sizes]
    shares = [100 * size["usable"] / size["windows"] for size in sizes]
    return [Figure(
        "window_sizes",
        "Which window",
        "What noise and texture let one expect of the displacement of a window, and how many windows "
        "have texture enough. Larger windows err less and blur the field.",
        [Panel("expected error", "side of the window, px", "standard deviation, px",
               [series("error", errors, BLUE)], log_y=True),
         Panel("usable windows", "side of the window, px", "usable, %",
               [series("usable", shares, RED)], from_zero=True)],
        "Texture",
    )]


def table_rows(summary):
    """The lines of `info`: label and value."""
    found = []
    for line in summary.get("words") or []:
        # A label of the camera's that is longer than its column ends at the next blank.
        label, _, value = line[16:].partition(" ")
        label, value = (line[:16] + label).strip(), value.strip()
        if value and label != "warning":
            found.append([label, value])
    return found
