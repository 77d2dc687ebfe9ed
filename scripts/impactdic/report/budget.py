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
    """(name, figure) of each figure that states what its deviation is made of."""
    before, after = impact.get("before") or {}, impact.get("after") or {}
    friction = impact.get("friction") or {}
    named = [
        (f"{name} {side}", flight.get(f"{key}_m_s") or flight.get(f"{key}_px_per_frame"))
        for side, flight in (("before", before), ("after", after))
        for name, key in (("vt", "vt"), ("vn", "vn"))
    ] + [
        ("spin after", after.get("omega_rad_s") or after.get("omega_rad_per_frame")),
        ("restitution", impact.get("restitution")),
        ("friction", friction.get("gravity_corrected")),
        ("contact time", impact.get("contact_s")),
        ("deflection", impact.get("max_deflection_m")),
    ]
    return [(name, figure) for name, figure in named if figure and figure.get("sd_parts")]


def shares(figure):
    """Of the variance, in %, by source."""
    parts = figure["sd_parts"]
    whole = sum(part**2 for part in parts.values())
    return {source: 100 * part**2 / whole for source, part in parts.items()} if whole > 0 else {}


def rows(impact):
    """A row a figure: its name, its deviation and the share of each source."""
    return [
        [name, f"{figure['sd']:.2g}"]
        + [f"{shares(figure).get(source, 0):.0f} %" for source in SOURCES]
        for name, figure in headline(impact)
    ]


def figure(impact):
    """The shares drawn; None where no figure states them."""
    named = headline(impact or {})
    if not named:
        return None
    places = np.arange(1.0, len(named) + 1)
    series = []
    for k, (source, name) in enumerate(SOURCES.items()):
        share = np.array([shares(one).get(source, 0.0) for _, one in named])
        if share.any():
            labels = [f"{what}: {part:.1f} % {name}" for (what, _), part in zip(named, share)]
            series.append(Series(name, places, share, colour=COLOURS[k], kind="markers",
                                 marker=MARKERS[k], labels=labels))
    names = "; ".join(f"{i} {name}" for i, (name, _) in enumerate(named, 1))
    return Figure(
        "budget",
        "What the deviations are made of",
        f"Shares of the variance. {names}. Type A is evaluated from scatter, the others are not "
        "(JCGM 100:2008).",
        [Panel("", "figure, number", "share of the variance, %", series, from_zero=True)],
        "Quality",
    )
