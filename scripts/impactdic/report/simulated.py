"""Figures and tables of one impact that `simulate` integrated."""

import numpy as np

from .figure import BLACK, BLUE, COLOURS, GREEN, ORANGE, RED, Figure, Panel, Series, Span
from .text import rounded

MOST_POINTS = 2000  # of a curve
MOST_SPANS = 12  # of phases that can be told apart by colour
SHADES = ["#E8F1F8", "#FCEFD9", "#E2F3EC", "#F8E6DC", "#F6E9F0", "#EAF6FC"]
ENERGIES = [("kinetic_j", "kinetic"), ("normal_elastic_j", "normal, elastic"),
            ("tangential_elastic_j", "tangential, elastic"), ("damping_j", "damped"),
            ("slip_j", "slip"), ("plastic_j", "plastic")]


def figures(result):
    """Figs 3.3 to 3.5 and 4.2: path, velocity, force and energy over the impact."""
    path = result.columns("trajectory")
    if len(path["time_s"]) < 3:
        return []  # a formula has no path
    keep = slice(None, None, max(1, len(path["time_s"]) // MOST_POINTS))
    path = {name: column[keep] for name, column in path.items()}
    time = 1e3 * path["time_s"]
    made = [_motion(result, path, time), _force(result, path, time)]
    if "kinetic_j" in path:
        made.append(_energy(result, path, time))
    return made


def _curves(title, y_label, time, curves):
    return Panel(title, "time, ms", y_label, [
        Series(name, time, y, colour=COLOURS[i]) for i, (name, y) in enumerate(curves)])


def _motion(result, path, time):
    mm = {name: 1e3 * path[name] for name in ("qt_m", "qn_m", "qb_m") if name in path}
    panels = [
        _curves("displacement of the centre", "displacement, mm", time,
                [(f"along {name[1]}", y - y[0]) for name, y in mm.items()]),
        _curves("velocity of the centre", "velocity, m/s", time,
                [(f"v{axis}", path[f"v{axis}_m_s"]) for axis in "tnb" if f"v{axis}_m_s" in path]),
        _curves("contact point", "velocity, m/s", time,
                [(f"along {axis}", path[f"tip_v{axis}_m_s"]) for axis in "tnb"
                 if f"tip_v{axis}_m_s" in path]),
        _curves("angular velocity", "angular velocity, rad/s", time,
                [(f"about {axis}", path[name]) for axis, name in
                 (("b", "omega_rad_s"), ("t", "omega_t_rad_s"), ("n", "omega_n_rad_s"))
                 if name in path]),
    ]
    return Figure(f"motion_{result.name}", f"The motion through the impact: {result.name}",
                  "Along the surface (t) and out of it (n); b is t × n.", panels, "Models")


def _force(result, path, time):
    spans = []
    phases = result.summary["phases"]
    tangential = result.summary.get("friction_phases") or [
        phase for phase in phases if phase.get("kind") == "tangential"]
    if len(tangential) <= MOST_SPANS:
        names = list(dict.fromkeys(phase["name"] for phase in tangential))
        seen = set()
        for phase in tangential:
            name = phase["name"].replace("_", " ")
            spans.append(Span(1e3 * phase["start_s"], 1e3 * phase["end_s"],
                              name if name not in seen else "",
                              SHADES[names.index(phase["name"]) % len(SHADES)]))
            seen.add(name)
    over_time = Panel("force over time", "time, ms", "force, N", [
        Series("normal", time, path["normal_force_n"], colour=BLUE),
        Series("tangential", time, path["tangential_force_n"], colour=RED)], spans)
    deflection = 1e3 * path.get("deflection_m", path.get("compression_m"))
    loading = np.arange(len(time)) <= int(np.nanargmax(deflection))
    touching = (path["normal_force_n"] != 0) | (deflection > 0)
    hysteresis = Panel("normal force over deflection", "deflection, mm", "force, N", [
        Series(name, deflection[part & touching], path["normal_force_n"][part & touching],
               colour=colour, dash=dash)
        for name, part, colour, dash in (("compression", loading, BLUE, False),
                                         ("restitution", ~loading, ORANGE, True))])
    return Figure(f"force_{result.name}", f"Forces of the contact: {result.name}",
                  "Shaded: what the friction law does. The area between loading and unloading is the "
                  "energy that the contact keeps.", [over_time, hysteresis], "Models")


def _energy(result, path, time):
    scale = 1e3
    series = [Series(name, time, scale * path[key], colour=COLOURS[i])
              for i, (key, name) in enumerate(ENERGIES) if np.any(path[key] != 0)]
    start = result.summary["energy"]["kinetic_start_j"]
    series.append(Series("at the start, and the weight's work", time,
                         scale * (start + path["gravity_j"]), colour=BLACK, dash=True))
    residual = Series("unexplained", time, 1e9 * path["residual_j"], colour=GREEN)
    return Figure(f"energy_{result.name}", f"Where the energy is: {result.name}",
                  "All parts add up to the dashed line; what they fail to explain is the error of the "
                  "integration.",
                  [Panel("energy", "time, ms", "energy, mJ", series),
                   Panel("unexplained energy", "time, ms", "energy, nJ", [residual])], "Models")


def tables(result, table):
    """Outcome and phases. `table` makes one of title, header, rows and section."""
    summary = result.summary
    figures_of = [("restitution", "restitution", 1, ""), ("contact", "contact_s", 1e3, "ms"),
                  ("most compressed after", "t_max_compression_s", 1e3, "ms"),
                  ("largest deflection", "max_deflection_m", 1e3, "mm"),
                  ("dent", "residual_m", 1e6, "µm"),
                  ("force at the largest deflection", "max_force_n", 1, "N"),
                  ("largest force", "peak_force_n", 1, "N"),
                  ("micro-impacts", "micro_impacts", 1, "")]
    rows = [[name, f"{rounded(factor * summary[key])} {unit}".strip()]
            for name, key, factor, unit in figures_of if summary.get(key) is not None]
    for name, key, unit in (("vt after", "vt_m_s", "m/s"), ("vn after", "vn_m_s", "m/s"),
                            ("angular velocity after", "omega_rad_s", "rad/s")):
        rows.append([name, f"{rounded(summary['final'][key])} {unit}"])
    friction = summary.get("effective_friction")
    if friction and friction.get("sound") is not None:
        rows.append(["effective friction", rounded(friction["sound"])])
    made = [table(f"Simulated impact ({result.name})", ["figure", "value"], rows, "Models")]
    phases = summary["phases"] + summary.get("friction_phases", [])
    if phases:
        made.append(table(f"Phases ({result.name})", ["phase", "from, ms", "to, ms"],
                          [[phase["name"].replace("_", " "), f"{1e3 * phase['start_s']:.4f}",
                            f"{1e3 * phase['end_s']:.4f}"] for phase in phases], "Models"))
    return made
