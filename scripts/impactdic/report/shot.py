"""Figures of one shot, from what `track` has written."""

import matplotlib.image
import numpy as np

from ..results import ResultError, read_table
from . import budget
from .figure import BLACK, BLUE, GREEN, ORANGE, RED, SKY, Figure, Panel, Picture, Series, Span
from .series import deflection, slope

MOST_ARROWS = 400
COMPRESSION, RESTITUTION = "#DCEBF7", "#FBEBD5"


class Shot:
    """A result of `track` in the units that it could be measured in: metres and seconds, else
    pixels and frames."""

    def __init__(self, result):
        self.result = result
        self.track = track = result.columns("track")
        summary = result.summary
        if "frames_analysed" not in summary:
            raise ResultError("the summary is not one of track", result.folder / "summary.json")
        scale = summary.get("scale_m_per_px")
        fps = summary.get("analysed_fps")
        self.si = bool(scale and fps)
        self.length = "mm" if self.si else "px"
        self.time_unit = "ms" if fps else "frame"
        self.speed = "m/s" if self.si else "px/frame"
        self.spin_unit = "rad/s" if fps else "rad/frame"
        self.mm_per_px = 1e3 * scale if self.si else 1.0
        self.per_second = fps if fps else 1.0
        self.angle = np.deg2rad(summary.get("surface_angle_deg") or 0.0)
        self.time = 1e3 * track["time_s"] if fps else np.arange(len(track["frame"]), dtype=float)
        step = np.median(np.diff(self.time)) if len(self.time) > 1 else 1.0
        self.mid_time = self.time + step / 2  # a motion is the mean velocity until the next frame
        self._set_motion()
        self.instants = self._instants()

    def _set_motion(self):
        track, mm = self.track, self.mm_per_px
        if self.si:
            self.x, self.y = 1e3 * track["x_m"], 1e3 * track["y_m"]
        else:
            self.x, self.y = track["cx_px"], -track["cy_px"]
        self.x_sd, self.y_sd = track["cx_sd_px"] * mm, track["cy_sd_px"] * mm
        per_m_s = 1e-3 * mm * self.per_second if self.si else 1.0
        self.vx, self.vy = track["dx_px"] * per_m_s, -track["dy_px"] * per_m_s
        self.vx_sd, self.vy_sd = track["dx_sd_px"] * per_m_s, track["dy_sd_px"] * per_m_s
        self.spin = np.deg2rad(track["rot_deg"]) * self.per_second
        self.spin_sd = np.deg2rad(track["rot_sd_deg"]) * self.per_second
        known = track["r_px"][np.isfinite(track["r_px"])]
        free = (self.result.summary.get("ball") or {}).get("radius_px")  # compressed frames aside
        self.radius = mm * (free or (np.median(known) if len(known) else np.nan))
        c, s = np.cos(self.angle), np.sin(self.angle)
        self.vt, self.vn = c * self.vx + s * self.vy, c * self.vy - s * self.vx
        self.vt_sd = np.hypot(c * self.vx_sd, s * self.vy_sd)
        self.vn_sd = np.hypot(s * self.vx_sd, c * self.vy_sd)
        self.t, self.n = c * self.x + s * self.y, c * self.y - s * self.x
        self.t_sd = np.hypot(c * self.x_sd, s * self.y_sd)
        self.n_sd = np.hypot(s * self.x_sd, c * self.y_sd)

    def _instants(self):
        """t0, maximum compression and end on the time axis; None where they are not known."""
        impact = self.result.impact or {}
        found = [impact.get(key) for key in ("t0", "t_max_compression", "t_end")]
        frames = self.track["frame"]
        per_frame = np.median(np.diff(frames)) if len(frames) > 1 else 1.0
        step = self.mid_time[0] - self.time[0]
        return [
            None if i is None else self.time[0] + 2 * step * (i["frame"] - frames[0]) / per_frame
            for i in found
        ]

    @property
    def spans(self):
        start, turn, end = self.instants
        if None in (start, turn, end):
            return []
        return [
            Span(start, turn, "compression", COMPRESSION),
            Span(turn, end, "restitution", RESTITUTION),
        ]

    def time_panel(self, title, y_label, series):
        return Panel(title, f"time, {self.time_unit}", y_label, series, spans=self.spans)


def figures(result):
    """Every figure that the folder has the data for."""
    shot = Shot(result)
    made = [key_frames(shot), trajectory(shot), position(shot)]
    if np.isfinite(shot.vx).any():
        made += [velocity(shot), spin(shot), angle(shot), contact_point(shot), force_loop(shot)]
    made += [quality(shot), budget.figure(result.impact)]
    return [figure for figure in made if figure is not None]


def key_frames(shot):
    """Fig. 2.10: the ball before, during and after the contact, and how its surface moves."""
    originals, moved = [], []
    factor = _arrow_factor(shot)
    for frame in shot.result.summary.get("key_frames") or []:
        path = shot.result.folder / frame["picture"]
        if not path.exists():
            continue
        grey = np.round(255 * matplotlib.image.imread(path)).astype(np.uint8)
        originals.append(_original(shot, frame, grey))
        field = _velocity_field(shot, frame, grey, factor)
        if field is not None:
            moved.append(field)
    if not originals:
        return None
    caption = "The measured circle (red) and the path of its centre (orange)."
    if moved:
        caption += (
            " Below, on the ball's surface set white: the windows (diamonds) and their "
            f"displacement to the next frame, {factor:g} times as long."
        )
    return Figure("frames", "Frames and velocity field", caption, originals + moved, "Frames")


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


def _circle(shot, row):
    cx, cy, r = (shot.track[key][row] for key in ("cx_px", "cy_px", "r_px"))
    angle = np.linspace(0, 2 * np.pi, 121)
    return Series("circle", cx + r * np.cos(angle), cy + r * np.sin(angle), colour=RED)


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
    return _frame_panel(frame, grey, [_circle(shot, row), path])


def _velocity_field(shot, frame, grey, factor):
    row = _row_of(shot, frame)
    try:
        windows = shot.result.field(frame["frame"])
    except ResultError:
        return None
    x, y, u, v = (windows[key].astype(float) for key in ("x_px", "y_px", "u_px", "v_px"))
    if len(x) == 0:
        return None
    thin = slice(None, None, max(1, len(x) // MOST_ARROWS))
    x, y, u, v = x[thin], y[thin], u[thin], v[thin]
    gap = np.full(len(x), np.nan)
    arrows = Series(
        "displacement",
        np.column_stack([x, x + factor * u, gap]).ravel(),
        np.column_stack([y, y + factor * v, gap]).ravel(),
        colour=BLUE,
        kind="arrows",
    )
    labels = [f"u {a:.4f} px, v {b:.4f} px" for a, b in zip(u, v)]
    places = Series("windows", x, y, None, BLUE, "markers", "diamond", labels=labels)
    return _frame_panel(frame, _white_ball(shot, frame, grey, row),
                        [_circle(shot, row), arrows, places])


def _white_ball(shot, frame, grey, row):
    cx, cy, r = (shot.track[key][row] for key in ("cx_px", "cy_px", "r_px"))
    y, x = np.indices(grey.shape)
    inside = np.hypot(x + frame["x_px"] - cx, y + frame["y_px"] - cy) <= r
    return np.where(inside, np.uint8(255), grey)


def _arrow_factor(shot):
    """Makes the longest arrow about an eighth of the radius."""
    moved = np.hypot(shot.track["dx_px"], shot.track["dy_px"])
    fastest = np.nanmax(moved, initial=0)
    if fastest == 0:
        return 1.0
    return _round_factor(0.125 * np.nanmedian(shot.track["r_px"]) / fastest)


def _round_factor(value):
    """1, 2, 5, 10, 20, ...: the one at or below `value`."""
    power = 10.0 ** np.floor(np.log10(value))
    return max(1.0, power * max(step for step in (1, 2, 5) if step * power <= value * 1.0001))


def trajectory(shot):
    """Figs 3.10 and 3.16."""
    names = ("contact starts", "most compressed", "contact ends")
    marks = [
        (name, instant, marker)
        for name, instant, marker in zip(names, shot.instants, ("circle", "diamond", "square"))
        if instant is not None
    ]

    def panel(title, x, y, x_name, y_name):
        series = [Series("centre of the ball", x, y)]
        for name, instant, marker in marks:
            at = [np.array([np.interp(instant, shot.time, values)]) for values in (x, y)]
            series.append(Series(name, *at, colour=RED, kind="markers", marker=marker))
        x_label, y_label = f"{x_name}, {shot.length}", f"{y_name}, {shot.length}"
        return Panel(title, x_label, y_label, series, same_scale=True)

    return Figure(
        "trajectory",
        "Trajectory of the centre",
        "Global axes: x right, y up. Local axes: t along the surface, n out of it.",
        [
            panel("global axes", shot.x, shot.y, "x", "y"),
            panel("local axes", shot.t, shot.n, "t", "n"),
        ],
    )


def position(shot):
    """Figs 2.11, 2.15 and 3.11 to 3.20: displacement of the centre since the first frame."""
    first = np.flatnonzero(np.isfinite(shot.x))
    origin = int(first[0]) if len(first) else 0

    def panel(title, names, values, deviations):
        series = [
            Series(name, shot.time, value - value[origin], deviation, colour)
            for name, value, deviation, colour in zip(names, values, deviations, (BLUE, RED))
        ]
        return shot.time_panel(title, f"displacement, {shot.length}", series)

    return Figure(
        "position",
        "Displacement of the centre",
        "From the circles. Bands: 95 % (they are often narrower than the line).",
        [
            panel("global axes", "xy", (shot.x, shot.y), (shot.x_sd, shot.y_sd)),
            panel("local axes", "tn", (shot.t, shot.n), (shot.t_sd, shot.n_sd)),
        ],
    )


def velocity(shot):
    """Figs 2.12, 2.16, 4.3, 4.4 and 4.6."""

    def panel(title, names, values, deviations):
        series = [
            Series(name, shot.mid_time, value, deviation, colour)
            for name, value, deviation, colour in zip(names, values, deviations, (BLUE, RED))
        ]
        return shot.time_panel(title, f"velocity, {shot.speed}", series)

    return Figure(
        "velocity",
        "Velocity of the centre",
        "From the motion of the speckles: the mean between two frames, drawn in their middle. "
        "Bands: 95 %.",
        [
            panel("global axes", ("vx", "vy"), (shot.vx, shot.vy), (shot.vx_sd, shot.vy_sd)),
            panel("local axes", ("vt", "vn"), (shot.vt, shot.vn), (shot.vt_sd, shot.vn_sd)),
        ],
    )


def spin(shot):
    """Figs 2.13, 2.17, 4.5 and 4.7."""
    series = [Series("angular velocity", shot.mid_time, shot.spin, shot.spin_sd)]
    note = "Counter-clockwise positive. Band: 95 %."
    track = shot.track
    if "rot_x_deg" in track and np.isfinite(track["rot_x_deg"]).any():  # a sphere
        series[0].name = "towards the camera"
        for name, column, colour in (("to the right", "rot_x", RED), ("upwards", "rot_y", GREEN)):
            rate = np.deg2rad(track[f"{column}_deg"]) * shot.per_second
            deviation = np.deg2rad(track[f"{column}_sd_deg"]) * shot.per_second
            series.append(Series(name, shot.mid_time, rate, deviation, colour))
        note = "Components of the spin vector; its sense by the right hand. Bands: 95 %."
    return Figure(
        "angular_velocity",
        "Angular velocity",
        note,
        [shot.time_panel("", f"angular velocity, {shot.spin_unit}", series)],
    )


def angle(shot):
    """How far the ball has turned, where keyframes say so (`track --estimator ball`)."""
    path = shot.result.folder / "pose.csv"
    if not path.exists():
        return None
    pose = read_table(path)
    if not np.isfinite(pose["angle_deg"]).any():  # a sphere has an orientation, and no such angle
        return None
    steps = np.concatenate([[0.0], np.cumsum(shot.track["rot_deg"][:-1])])
    time = 1e3 * pose["time_s"] if shot.time_unit == "ms" else pose["frame"] - pose["frame"][0]
    series = [
        Series("keyframes", time, pose["angle_deg"], pose["angle_sd_deg"], BLUE),
        Series("sum of the steps", shot.time, steps, colour=RED, dash=True),
    ]
    return Figure(
        "angle",
        "Angle turned",
        "Counter-clockwise positive. Keyframes do not drift; the sum of the steps does. Band: 95 %.",
        [shot.time_panel("", "angle, °", series)],
    )


def contact_point(shot):
    """Fig. 4.10: where it is zero, the ball sticks or rolls."""
    radius = shot.radius * (1e-3 if shot.si else 1.0)
    rate = shot.spin if shot.si else np.deg2rad(shot.track["rot_deg"])
    rate_sd = shot.spin_sd if shot.si else np.deg2rad(shot.track["rot_sd_deg"])
    tip, deviation = shot.vt + radius * rate, np.hypot(shot.vt_sd, radius * rate_sd)
    series = [
        Series("contact point", shot.mid_time, tip, deviation, RED),
        Series("centre", shot.mid_time, shot.vt, shot.vt_sd, BLUE),
    ]
    return Figure(
        "contact_point",
        "Slip of the contact point",
        "Tangential velocity of the contact point, that of a rigid ball: vt + R ω. Bands: 95 %.",
        [shot.time_panel("", f"velocity, {shot.speed}", series)],
    )


def force_loop(shot):
    """The surface's normal force over the ball's mass against the deflection, from the motion."""
    start, _, end = shot.instants
    if start is None or end is None or not shot.si:
        return None
    gravity = shot.result.summary.get("gravity_angle_deg", -90.0)
    gravity_n = 9.81 * np.sin(np.deg2rad(gravity) - shot.angle)
    seconds = 1e-3 * shot.mid_time
    force, deviation = slope(seconds, shot.vn, shot.vn_sd, half=2)
    force = force - gravity_n
    # Deflection: how far the centre has gone towards the surface since the touch.
    depth = deflection(1e-3 * shot.time, shot.vn, 1e-3 * start)
    at_mid = 1e3 * np.interp(seconds, 1e-3 * shot.time, depth)
    contact = (shot.mid_time > start) & (shot.mid_time < end)
    label = "normal force / mass, m/s²"
    instants = [f"{time:.2f} ms" for time in shot.mid_time[contact]]
    loop = Series(
        "contact", at_mid[contact], force[contact], deviation[contact], labels=instants
    )
    against_time = Series("normal force / mass", shot.mid_time, force, deviation)
    panels = [
        Panel("loop", "deflection, mm", label, [loop]),
        shot.time_panel("against time", label, [against_time]),
    ]
    return Figure(
        "force_deflection",
        "Force and deflection",
        "From the measured motion alone: normal acceleration (slope of a line through five "
        "velocities) less gravity, against the way of the centre since the touch. The area of the "
        "loop is the energy lost per mass. Times the mass: the force.",
        panels,
        "Contact",
    )


def quality(shot):
    """What the measurement rests on."""
    track = shot.track
    panels = [
        shot.time_panel(
            "radius", "radius, px", [Series("radius", shot.time, track["r_px"], track["r_sd_px"])]
        ),
    ]
    if np.isfinite(track["rot_deg"]).any():
        used = np.where(np.isfinite(track["rot_deg"]), track["windows"], np.nan)
        windows = Series("windows", shot.mid_time, used, colour=GREEN)
        panels.append(shot.time_panel("windows", "windows used, 1", [windows]))
        deviations = [
            Series("dx", shot.mid_time, track["dx_sd_px"], colour=BLUE),
            Series("dy", shot.mid_time, track["dy_sd_px"], colour=RED),
            Series("centre x", shot.time, track["cx_sd_px"], colour=SKY),
            Series("centre y", shot.time, track["cy_sd_px"], colour=BLACK),
        ]
        panels.append(shot.time_panel("standard deviations", "one deviation, px", deviations))
    return Figure(
        "quality",
        "Quality of the measurement",
        "A radius that changes in flight, windows that get lost or deviations that grow say where "
        "to look at the frames.",
        panels,
        "Quality",
    )
