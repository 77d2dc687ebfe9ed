"""What the deviations of an impact are made of."""

from __future__ import annotations

import numpy as np

from .figure import COLOURS, MARKERS, Figure, Panel, Series

# Those that have a part in any figure, in this order.
SOURCES = {
    "noise": "noise (type A)",
    "circle": "circle, shared by all frames",
    "contact": "instants of the contact",
    "angle": "angle of the surface",
    "scale": "scale",
    "time": "frame rate",
    "camera": "lens and plane of motion",
}


def headline(impact):
    """(name, figure, factor, unit) of each figure that states what its deviation is made of: times
    the factor it is in the unit."""
    before, after = impact.get("before") or {}, impact.get("after") or {}
    friction = impact.get("friction") or {}
    si = impact.get("units") == "si"
    speed, turn = ("m_s", "rad_s") if si else ("px_per_frame", "rad_per_frame")
    named = [
        (f"{name} {side}", flight.get(f"{name}_{speed}"), 1, "m/s" if si else "px/frame")
        for side, flight in (("before", before), ("after", after))
        for name in ("vt", "vn")
    ] + [
        ("spin after", after.get(f"omega_{turn}"), 1, "rad/s" if si else "rad/frame"),
        ("restitution", impact.get("restitution"), 1, ""),
        ("friction", friction.get("gravity_corrected"), 1, ""),
        ("contact time", impact.get("contact_s"), 1e3, "ms"),
        ("deflection", impact.get("max_deflection_m"), 1e3, "mm"),
    ]
    return [one for one in named if one[1] and one[1].get("sd_parts")]


def shares(figure):
    """Of the variance, in %, by source."""
    parts = figure["sd_parts"]
    whole = sum(part**2 for part in parts.values())
    return {source: 100 * part**2 / whole for source, part in parts.items()} if whole > 0 else {}


def rows(impact):
    """A row a figure: its name, its deviation and the share of each source."""
    return [
        [name, f"{factor * figure['sd']:#.2g} {unit}".strip()]
        + [f"{shares(figure).get(source, 0):.0f} %" for source in SOURCES]
        for name, figure, factor, unit in headline(impact)
    ]


def figure(impact):
    """The shares drawn; None where no figure states them."""
    named = headline(impact or {})
    if not named:
        return None
    names = [one[0] for one in named]
    places = np.arange(float(len(named)))
    series = []
    for k, (source, name) in enumerate(SOURCES.items()):
        share = np.array([shares(one).get(source, 0.0) for _, one, _, _ in named])
        if share.any():
            labels = [f"{what}: {part:.1f} % {name}" for what, part in zip(names, share)]
            series.append(Series(name, places, share, colour=COLOURS[k], kind="markers",
                                 marker=MARKERS[k], labels=labels))
    return Figure(
        "budget",
        "What the deviations are made of",
        "Shares of the variance. Type A is evaluated from scatter, the others are not "
        "(JCGM 100:2008).",
        [Panel("", "figure", "share of the variance, %", series, from_zero=True,
               x_names=names)],
        "Quality",
    )
