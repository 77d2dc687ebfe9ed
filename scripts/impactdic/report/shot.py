"""Figures of one shot, from what `track` has written."""

import numpy as np

from ..results import ResultError, read_table
from . import budget
from .figure import BLACK, BLUE, GREEN, RED, SKY, Figure, Panel, Series, Span
from .series import deflection, slope

COMPRESSION, RESTITUTION = "#DCEBF7", "#FBEBD5"


class Shot:
    """A result of `track` in the units that it could be measured in: metres and seconds, else
    pixels and frames."""

    def __init__(self, result, mass_kg=None):
        self.result, self.mass_kg = result, mass_kg
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


def figures(result, mass_kg=None):
    """Every figure that the folder has the data for. `mass_kg`: of the ball, where it is known."""
    from . import frames, path

    shot = Shot(result, mass_kg)
    made = [frames.key_frames(shot), path.trajectory(shot), position(shot)]
    if np.isfinite(shot.vx).any():
        made += [velocity(shot), spin(shot), angle(shot), contact_point(shot), force_loop(shot)]
    made += [quality(shot), budget.figure(result.impact)]
    return [figure for figure in made if figure is not None]


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
    """The surface's normal force against the deflection, from the motion; over the ball's mass
    where that is not known."""
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
    name, unit = ("normal force / mass", "m/s²") if shot.mass_kg is None else ("normal force", "N")
    label = f"{name}, {unit}"
    if shot.mass_kg is not None:
        force, deviation = shot.mass_kg * force, shot.mass_kg * deviation
    instants = [f"{time:.2f} ms" for time in shot.mid_time[contact]]
    loop = Series(
        "contact", at_mid[contact], force[contact], deviation[contact], labels=instants
    )
    against_time = Series(name, shot.mid_time, force, deviation)
    panels = [
        Panel("loop", "deflection, mm", label, [loop]),
        shot.time_panel("against time", label, [against_time]),
    ]
    return Figure(
        "force_deflection",
        "Force and deflection",
        "From the measured motion alone: normal acceleration (slope of a line through five "
        "velocities) less gravity, against the way of the centre since the touch. The area of the "
        + ("loop is the energy lost per mass. Times the mass: the force." if shot.mass_kg is None
           else f"loop is the energy lost. The mass is {1e3 * shot.mass_kg:g} g."),
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
        panels.append(shot.time_panel("windows", "windows used", [windows]))
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
