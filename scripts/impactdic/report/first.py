"""What the page says before anything else: what happened, in a sentence, and what speaks for and
against it. The page of `impactdic view` says the same (host/view/page/sentence.js, lights.js)."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from . import groups
from .text import rounded, with_sd

ENOUGH = 0.9  # share of the windows that is usable
RPM = 60 / (2 * math.pi)


@dataclass
class Light:
    """A check: good, bad or open (nothing can be said)."""

    name: str
    state: str
    why: str


@dataclass
class Shape:
    """An outline: centre, semi-axes, px, and the angle of the long one from x towards y, rad."""

    x: float
    y: float
    long: float
    short: float
    angle: float


@dataclass
class KeyPicture:
    """A frame of the ball: the picture's first pixel is (x_px, y_px), what is drawn is in px."""

    title: str
    grey: np.ndarray
    x_px: float
    y_px: float
    outline: Shape | None
    path: np.ndarray  # (points, 2)
    motion: tuple[float, float] | None  # as long as it is drawn
    surface: tuple[float, float, float, float] | None  # x0, y0, x1, y1
    bar: tuple[float, str] | None  # length, what it is


@dataclass
class First:
    sentence: str = ""
    lights: list[Light] = field(default_factory=list)
    pictures: list[KeyPicture] = field(default_factory=list)
    video: Path | None = None


def sentence(summary):
    """ "in 3.97 m/s → out 3.26 m/s, spin 0 → 302 rpm, e 0.865 ± 0.001, contact 6.3 ms" """
    impact = summary.get("impact") or {}
    if not impact.get("found"):
        return impact.get("explanation") or "the impact was not looked for"
    si = impact.get("units") == "si"
    parts = []
    speeds = [_speed(impact.get(side), si) for side in ("before", "after")]
    if None not in speeds:
        unit = "m/s" if si else "px/frame"
        parts.append(f"in {short(speeds[0])} {unit} → out {short(speeds[1])} {unit}")
    turns = [_value((impact.get(side) or {}).get("omega_rad_s" if si else "omega_rad_per_frame"))
             for side in ("before", "after")]
    if None not in turns:
        factor, unit = (RPM, "rpm") if si else (math.degrees(1), "°/frame")
        parts.append("spin " + " → ".join(_turn(factor * turn, si) for turn in turns) + f" {unit}")
    if _value(impact.get("restitution")) is not None:
        parts.append(f"e {with_sd(impact['restitution'])}")
    contact = _value(impact.get("contact_s"))
    if contact is not None:
        parts.append(f"contact {short(1e3 * contact)} ms")
    return ", ".join(parts) or str(impact.get("explanation") or impact.get("status"))


def sentence_of_simulated(summary):
    """The same of an impact that `simulate` integrated; "" where it has none (a formula, an older
    file)."""
    start, final = summary.get("start") or {}, summary.get("final") or {}
    names = ("vt_m_s", "vn_m_s", "omega_rad_s")
    if any(side.get(name) is None for side in (start, final) for name in names):
        return ""
    speeds = [math.hypot(side["vt_m_s"], side["vn_m_s"], side.get("vb_m_s") or 0.0)
              for side in (start, final)]
    turns = [_turn(RPM * side["omega_rad_s"], True) for side in (start, final)]
    parts = [f"in {short(speeds[0])} m/s → out {short(speeds[1])} m/s",
             "spin " + " → ".join(turns) + " rpm"]
    if summary.get("restitution") is not None:
        parts.append(f"e {summary['restitution']:.4g}")
    if summary.get("contact_s") is not None:
        parts.append(f"contact {short(1e3 * summary['contact_s'])} ms")
    return ", ".join(parts)


def sentence_of_fit(summary):
    """What a fit found: its parameters, and whether its law explains the shots; "" of a comparison."""
    parameters = {key: p for key, p in (summary.get("parameters") or {}).items()
                  if key != "contact_time_s"}  # of one shot alone, where its law sees the touch
    if not parameters:
        return ""
    said = [f"{key} {with_sd(p)}" for key, p in parameters.items() if p.get("determined")]
    lost = [key for key, p in parameters.items() if not p.get("determined")]
    verdicts = [shot["adequacy"] for shot in summary.get("shots", []) if shot.get("adequacy")]
    words = ", ".join(said) + ("; " if said and lost else "")
    words += f"not determined: {', '.join(lost)}" if lost else ""
    if len(verdicts) == 1:
        words += f"; the law is {verdicts[0]}"
    elif verdicts:
        words += f"; the law is adequate in {verdicts.count('adequate')} of {len(verdicts)} shots"
    return words


def lights(summary):
    """Impulse closure, gravity, texture, scale."""
    impact, found = summary.get("impact") or {}, []
    if impact.get("found"):
        closure = impact.get("impulse_closure") or {}
        state = {"closes": "good", "undetermined": "open"}.get(closure.get("verdict"), "bad")
        found.append(Light("closure", state, closure.get("explanation") or "not worked out"))
        gravity = impact.get("gravity") or {}
        measured = gravity.get("measured_m_s2")
        why = "not measured" if _value(measured) is None else f"{with_sd(measured)} m/s² measured"
        state = {True: "good", False: "bad"}.get(gravity.get("agrees_with_9_81"), "open")
        found.append(Light("gravity", state, why))
    found += texture_light(summary)
    scale = summary.get("scale") or {}
    if summary.get("scale_m_per_px"):
        found.append(Light("scale", "good", f"from {scale['from']}" if scale.get("from")
                           else f"{1e3 * summary['scale_m_per_px']:.4g} mm/px"))
    else:
        found.append(Light("scale", "open", "no scale is given: lengths are in px"))
    return found


def sentence_of_shots(table, excluded=()):
    """Of shots.csv: mean restitution and its deviation, for each ball at each angle of the surface. Shots that a person has left out (`excluded`) or whose figures are in doubt do not
    count."""
    found, doubtful = {}, 0
    counts = groups.counted(table, excluded)
    for row in range(len(table["status"])):
        e = groups.number(table, "restitution", row)
        if groups.text(table, "status", row) != "ok" or not math.isfinite(e):
            continue
        if counts[row]:
            key = (groups.ball_of(table, row), groups.number(table, "surface_angle_deg", row))
            found.setdefault(key, []).append((e, groups.number(table, "restitution_sd", row)))
        elif groups.text(table, "shot", row) not in excluded:
            doubtful += 1
    parts = [_mean_e(ball, angle, values) for (ball, angle), values in sorted(found.items())]
    if doubtful:
        parts.append(f"{doubtful} in doubt and left out")
    if excluded:
        parts.append(f"{len(excluded)} left out by hand")
    return ", ".join(parts)


def _mean_e(ball, angle, values):
    count = len(values)
    where = ([ball] if ball else []) + ([f"at {angle:g}°"] if math.isfinite(angle) else [])
    mean, deviation = groups.mean(*zip(*values))
    return (f"e {rounded(mean, deviation)}"
            + "".join(f" {word}" for word in where) + f" ({count} shot{'s' if count > 1 else ''})")


def texture_light(summary):
    """One light, or none where no texture was looked at."""
    windows = (summary.get("advice") or {}).get("windows") or {}
    if not windows.get("windows"):
        return []
    share = windows["usable"] / windows["windows"]
    return [Light("texture", "good" if share >= ENOUGH else "bad",
                  f"{100 * share:.0f} % of the windows are usable")]


def _value(figure):
    value = (figure or {}).get("value")
    return value if value is not None and math.isfinite(value) else None


def _speed(side, si):
    unit = "m_s" if si else "px_per_frame"
    parts = [_value((side or {}).get(f"{axis}_{unit}")) for axis in ("vt", "vn")]
    return None if None in parts else math.hypot(*parts)


def short(value):
    """Three digits, zeros among them."""
    return f"{value:#.3g}".rstrip(".") if abs(value) < 999.5 else f"{value:.0f}"


def _turn(value, whole):
    text = f"{value:.0f}" if whole else f"{value:.2f}"
    return text.lstrip("-") if float(text) == 0 else text
