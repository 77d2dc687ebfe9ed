"""The ball before, during and after the contact, and how its surface moves (Fig. 2.10)."""

import matplotlib.image
import numpy as np

from . import first
from ..errors import ResultError
from .figure import (
    BLUE,
    ORANGE,
    RED,
    Figure,
    Panel,
    Picture,
    Reference,
    Series,
    arrow_pairs,
    one_digit_below,
    round_below,
    thinned,
)
from .shot import Shot

MOST_ARROWS = 150


def key_frames(shot):
    """Fig. 2.10: the ball before, during and after the contact, and how its surface moves."""
    originals, moved = [], []
    factor = _arrow_factor(shot)
    for frame in shot.result.summary.get("key_frames") or []:
        path = shot.result.folder / frame["picture"]
        if not path.exists():
            continue
        grey = _grey(path)
        originals.append(_original(shot, frame, grey))
        field = _velocity_field(shot, frame, grey, factor)
        if field is not None:
            moved.append(field)
    if not originals:
        return None
    caption = "The measured outline (red) and the path of its centre (orange)."
    if moved:
        caption += (
            " Below, on the ball's surface set white: the windows and their displacement to the "
            f"next frame, {factor:g} times as long; the reference says what that is."
        )
    return Figure("frames", "Frames and velocity field", caption, originals + moved, "Frames")


def first_screen(result):
    """The shot in a sentence, with its checks, its key frames and its film."""
    shot, summary = Shot(result), result.summary
    made = first.First(first.sentence(summary), first.lights(summary))
    for frame in summary.get("key_frames") or []:
        path = result.folder / frame["picture"]
        if path.exists():
            made.pictures.append(_key_picture(shot, frame, _grey(path)))
    if (result.folder / "overlay.mp4").exists():
        made.video = result.folder / "overlay.mp4"
    return made


def _grey(path):
    return np.round(255 * matplotlib.image.imread(path)).astype(np.uint8)


def _key_picture(shot, frame, grey):
    row = _row_of(shot, frame)
    width = grey.shape[1]
    path = np.column_stack([shot.track["cx_px"][: row + 1], shot.track["cy_px"][: row + 1]])
    path = path[np.isfinite(path).all(axis=1)]
    title = f"{frame['moment']}, frame {frame['frame']}"
    if shot.time_unit == "ms":
        title = f"{frame['moment']}, {shot.time[row]:.2f} ms"
    motion = [float(shot.track[key][row]) for key in ("dx_px", "dy_px")]
    factor = _motion_factor(shot)
    moving = np.isfinite(motion).all() and np.hypot(*motion) > 0
    if moving:  # what the arrow stands for
        title += f", {first.short(np.hypot(*motion) * _speed_per_px(shot))} {shot.speed}"
    bar = None
    if shot.si:
        length = round_below(0.3 * width * shot.mm_per_px)
        bar = (length / shot.mm_per_px, f"{length:g} mm")
    return first.KeyPicture(title, grey, frame["x_px"], frame["y_px"], shape_of(shot, row),
                            path[:: max(1, len(path) // 400)],
                            tuple(factor * m for m in motion) if moving else None,
                            _surface_line(shot, frame, grey), bar)


def _motion_factor(shot):
    """Makes the fastest motion nine tenths of the radius long: the arrow of the ball."""
    fastest = _fastest(shot)
    return 0.9 * np.nanmedian(shot.track["r_px"]) / fastest if fastest > 0 else 1.0


def _surface_line(shot, frame, grey):
    """Where the ball touches first, through the whole picture; None where that is not known."""
    start = shot.instants[0]
    if start is None:
        return None
    radius = (shot.result.summary.get("ball") or {}).get("radius_px")
    at = [np.interp(start, shot.time, shot.track[key]) for key in ("cx_px", "cy_px")]
    if radius is None or not np.isfinite(at).all():
        return None
    c, s = np.cos(shot.angle), -np.sin(shot.angle)  # along the surface, y down
    x, y = at[0] - radius * s, at[1] + radius * c
    # How far along it may go both ways before it leaves the picture.
    first, last = -np.inf, np.inf
    height, width = grey.shape
    for place, step, low, size in ((x, c, frame["x_px"], width), (y, s, frame["y_px"], height)):
        if abs(step) < 1e-9:
            if not low <= place <= low + size - 1:
                return None
            continue
        ends = sorted(((low - place) / step, (low + size - 1 - place) / step))
        first, last = max(first, ends[0]), min(last, ends[1])
    if not first < last:
        return None
    return (x + first * c, y + first * s, x + last * c, y + last * s)


def _frame_panel(frame, picture, series):
    return Panel(
        f"{frame['moment']}, frame {frame['frame']}",
        "x, px",
        "y, px",
        series,
        picture=Picture(picture, frame["x_px"], frame["y_px"]),
        same_scale=True,
        y_down=True,
    )


def shape_of(shot, row):
    """The outline that was fitted: centre x and y, long and short semi-axis, px, and the angle of the
    long one in the picture (from x towards y, y down), rad. Results of older versions have circles."""
    cx, cy, r = (float(shot.track[key][row]) for key in ("cx_px", "cy_px", "r_px"))
    e1, e2 = (float(shot.track[key][row]) if key in shot.track else np.nan
              for key in ("e1_px", "e2_px"))
    if not np.isfinite(e1):
        return first.Shape(cx, cy, r, r, 0.0)
    oval = np.hypot(e1, e2)
    return first.Shape(cx, cy, r + oval, r - oval, np.arctan2(e2, e1) / 2)


def _outline(shot, row):
    shape = shape_of(shot, row)
    angle = np.linspace(0, 2 * np.pi, 121)
    along, across = shape.long * np.cos(angle), shape.short * np.sin(angle)
    c, s = np.cos(shape.angle), np.sin(shape.angle)
    name = "circle" if shape.long == shape.short else "ellipse"
    return Series(name, shape.x + along * c - across * s, shape.y + along * s + across * c,
                  colour=RED)


def _row_of(shot, frame):
    return int(np.flatnonzero(shot.track["frame"] == frame["frame"])[0])


def _original(shot, frame, grey):
    row = _row_of(shot, frame)
    path = Series(
        "path of the centre",
        shot.track["cx_px"][: row + 1],
        shot.track["cy_px"][: row + 1],
        colour=ORANGE,
    )
    return _frame_panel(frame, grey, [_outline(shot, row), path])


def _velocity_field(shot, frame, grey, factor):
    row = _row_of(shot, frame)
    try:
        windows = shot.result.field(frame["frame"])
    except ResultError:
        return None
    x, y, u, v = (windows[key].astype(float) for key in ("x_px", "y_px", "u_px", "v_px"))
    if len(x) == 0:
        return None
    keep = thinned(x, y, MOST_ARROWS)
    x, y, u, v = x[keep], y[keep], u[keep], v[keep]
    ends = arrow_pairs(x, y, factor * u, factor * v)
    arrows = Series("displacement", *ends, colour=BLUE, kind="arrows")
    labels = [f"u {a:.4f} px, v {b:.4f} px" for a, b in zip(u, v)]
    places = Series("windows", x, y, None, BLUE, "markers", size=3, labels=labels)
    panel = _frame_panel(frame, _white_ball(shot, frame, grey, row),
                         [_outline(shot, row), arrows, places])
    if _fastest(shot) > 0:
        panel.reference = _reference(shot, frame, grey, factor)
    return panel


def _white_ball(shot, frame, grey, row):
    shape = shape_of(shot, row)
    y, x = np.indices(grey.shape)
    x, y = x + frame["x_px"] - shape.x, y + frame["y_px"] - shape.y
    c, s = np.cos(shape.angle), np.sin(shape.angle)
    inside = np.hypot((c * x + s * y) / shape.long, (c * y - s * x) / shape.short) <= 1
    return np.where(inside, np.uint8(255), grey)


def _reference(shot, frame, grey, factor):
    """In the picture's lower left corner: the speed of one digit below the fastest of the clip."""
    height, width = grey.shape
    per_px = _speed_per_px(shot)
    speed = one_digit_below(_fastest(shot) * per_px)
    return Reference(frame["x_px"] + 0.04 * width, frame["y_px"] + 0.95 * height,
                     factor * speed / per_px, f"{speed:g} {shot.speed}")


def _speed_per_px(shot):
    """Of a motion from frame to frame, in the shot's unit."""
    return 1e-3 * shot.mm_per_px * shot.per_second if shot.si else 1.0


def _arrow_factor(shot):
    """Makes the arrow of the fastest frame up to three tenths of the radius long."""
    fastest = _fastest(shot)
    if fastest == 0:
        return 1.0
    return max(1.0, round_below(0.3 * np.nanmedian(shot.track["r_px"]) / fastest))


def _fastest(shot):
    """The largest motion of the centre between two frames, px."""
    return np.nanmax(np.hypot(shot.track["dx_px"], shot.track["dy_px"]), initial=0)
