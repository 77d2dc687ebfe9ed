"""Figures and tables of a sweep: outcomes over what was swept, as curves or as maps."""

import numpy as np

from .figure import COLOURS, MARKERS, Figure, Panel, Series, Surface

MOST_CURVES = 7  # in one panel
MOST_MAPS = 3  # of one outcome, at values of a third axis
LABELS = {
    "speed_m_s": "speed, m/s",
    "incidence_deg": "angle from the normal, °",
    "drop_angle_deg": "angle of the surface, °",
    "surface_angle_deg": "angle of the surface, °",
    "rod_angle_deg": "angle of the rod, °",
    "omega_rad_s": "angular velocity before, rad/s",
    "spin_ratio": "spin ratio Rω/v, 1",
    "stiffness_n_per_m": "stiffness, N/m",
    "stiffness_n_per_m1p5": "stiffness, N/m^1.5",
    "damping_n_s_per_m": "damping, N s/m",
    "friction_kinetic": "coefficient of friction, 1",
    "friction_static": "static friction, 1",
    "poisson": "Poisson's ratio, 1",
    "yield_strength_pa": "yield strength, Pa",
    "restitution": "given restitution, 1",
    "tangential_restitution": "given tangential restitution, 1",
}
# (column, title, label with unit, factor)
OUTCOMES = [
    ("restitution", "restitution", "restitution, 1", 1),
    ("tangential_restitution", "tangential restitution", "tangential restitution, 1", 1),
    ("friction", "effective friction", "impulse ratio, 1", 1),
    ("omega_after_rad_s", "angular velocity after", "angular velocity, rad/s", 1),
    ("vt_after_m_s", "tangential velocity after", "velocity, m/s", 1),
    ("contact_s", "contact time", "contact time, ms", 1e3),
    ("max_deflection_m", "largest deflection", "deflection, mm", 1e3),
    ("max_force_n", "force at the largest deflection", "force, N", 1),
    ("dent_m", "permanent deformation", "deformation, µm", 1e6),
    ("lost", "share of the energy lost", "share, 1", 1),
]


class Sweep:
    """sweep.csv with its axes."""

    def __init__(self, result):
        self.result = result
        self.table = result.columns("sweep")
        axes = result.summary["axes"]
        self.shape = tuple(len(axis["values"]) for axis in axes)
        self.values = [np.asarray(axis["values"], float) for axis in axes]
        self.names = [LABELS.get(axis["key"], axis["key"]) for axis in axes]
        self.varying = [i for i, length in enumerate(self.shape) if length > 1]

    def outcome(self, column, factor=1.0):
        """On the grid of the axes; None where no shot has it."""
        if column not in self.table:
            return None
        column = self.table[column]
        if column.dtype.kind != "f" or not np.any(np.isfinite(column)):
            return None
        return factor * column.reshape(self.shape)

    def outcomes(self):
        found = ((title, label, self.outcome(column, factor))
                 for column, title, label, factor in OUTCOMES)
        return [(title, label, z) for title, label, z in found if z is not None]


def figures(result, warnings):
    sweep = Sweep(result)
    made = []
    if len(sweep.varying) <= 2 and _curve_axis(sweep) is not None:
        made.append(_curves(sweep))
    else:
        made += _maps(sweep, warnings)
    rebound = _rebound_map(sweep)
    return made + ([rebound] if rebound else [])


def _curve_axis(sweep):
    """The axis along which curves run: the longest, if the other one has few values."""
    if not sweep.varying:
        return 0
    order = sorted(sweep.varying, key=lambda i: -sweep.shape[i])
    others = [sweep.shape[i] for i in order[1:]]
    return order[0] if all(length <= MOST_CURVES for length in others) else None


def _curves(sweep):
    """Figs 5.7 to 5.18: outcomes over one axis, a curve for each value of another."""
    along = _curve_axis(sweep)
    other = next((i for i in sweep.varying if i != along), None)
    panels = []
    for title, label, z in sweep.outcomes():
        z = np.moveaxis(z, along, -1).reshape(-1, sweep.shape[along])
        names = ["" if other is None else _at(sweep, other, k) for k in range(len(z))]
        panels.append(Panel(title, sweep.names[along], label, [
            Series(names[k] or title, sweep.values[along], row, colour=COLOURS[k % len(COLOURS)],
                   kind="line" if sweep.shape[along] > 1 else "markers")
            for k, row in enumerate(z)]))
    return Figure(f"sweep_{sweep.result.name}", f"Outcomes over what was swept: {sweep.result.name}",
                  _fixed(sweep) or "One curve for each value of what was swept beside.", panels,
                  "Models")


def _at(sweep, axis, index):
    name, unit = sweep.names[axis].rsplit(", ", 1)
    return f"{name} {sweep.values[axis][index]:g}{'' if unit == '1' else ' ' + unit}"


def _fixed(sweep):
    fixed = [_at(sweep, i, 0) for i, length in enumerate(sweep.shape) if length == 1]
    return "At " + ", ".join(fixed) + "." if fixed else ""


def _maps(sweep, warnings):
    """Each outcome over the two longest axes; at the first, middle and last value of a third."""
    order = sorted(sweep.varying, key=lambda i: (-sweep.shape[i], i))
    x, y = sorted(order[:2])
    others = [i for i in sweep.varying if i not in (x, y)]
    if len(others) > 1:
        warnings.append("the sweep has more than three axes: maps stand at the first value of "
                        + ", ".join(sweep.names[i] for i in others[1:]) + "; sweep.csv has all")
    places = [0]
    if others:
        length = sweep.shape[others[0]]
        places = sorted({0, length // 2, length - 1})[:MOST_MAPS]
    made = []
    for place in places:
        index = [0] * len(sweep.shape)
        index[x] = index[y] = slice(None)
        if others:
            index[others[0]] = place
        panels = []
        for title, label, z in sweep.outcomes():
            grid = z[tuple(index)]
            if not np.any(np.isfinite(grid)):
                continue
            panels.append(Panel(title, sweep.names[x], sweep.names[y], surface=Surface(
                sweep.values[x], sweep.values[y], grid.T, label, contours=True)))
        if not panels:
            continue  # no shot of it has a motion after
        at = _at(sweep, others[0], place) if others else ""
        suffix = f"_{place}" if others else ""
        made.append(Figure(f"map_{sweep.result.name}{suffix}",
                           f"Rebound maps: {sweep.result.name}" + (f", {at}" if at else ""),
                           "Lines: equal value. Blank: no motion after the impact. " + _fixed(sweep),
                           panels, "Models"))
    return made


def _rebound_map(sweep):
    """Maw, Barber and Fawcett (1976): the contact point's velocity after over that before, both
    over the normal velocity before. Of balls alone: the contact point lies a radius below."""
    body = sweep.result.job.get("body", {})
    table = sweep.table
    if body.get("shape") == "rod" or "diameter_m" not in body:
        return None
    radius = body["diameter_m"] / 2
    speed = np.abs(table["vn_before_m_s"])
    with np.errstate(invalid="ignore", divide="ignore"):
        before = (table["vt_before_m_s"] + radius * table["omega_before_rad_s"]) / speed
        after = (table["vt_after_m_s"] + radius * table["omega_after_rad_s"]) / speed
    known = np.isfinite(before) & np.isfinite(after)
    if known.sum() < 3 or np.ptp(before[known]) == 0:
        return None
    split = next((i for i in sweep.varying if sweep.shape[i] <= MOST_CURVES), None)
    groups = np.zeros(sweep.shape, int) if split is None else np.broadcast_to(
        np.arange(sweep.shape[split]).reshape([-1 if i == split else 1
                                               for i in range(len(sweep.shape))]), sweep.shape)
    groups = groups.reshape(-1)
    series = []
    for group in np.unique(groups[known]):
        take = np.flatnonzero(known & (groups == group))
        take = take[np.argsort(before[take], kind="stable")]
        take = take[::max(1, len(take) // 3000)]
        name = "shots" if split is None else _at(sweep, split, group)
        series.append(Series(name, before[take], after[take], kind="markers",
                             colour=COLOURS[group % len(COLOURS)],
                             marker=MARKERS[group % len(MARKERS)]))
    panel = Panel("contact point", "velocity before / |normal velocity before|, 1",
                  "velocity after / |normal velocity before|, 1", series)
    return Figure(f"rebound_{sweep.result.name}", f"The contact point's rebound: {sweep.result.name}",
                  "Where the sign has turned the contact point springs back.", [panel], "Models")


def tables(result, table):
    """What was swept, and how many shots have a motion after."""
    summary = result.summary
    rows = []
    for axis in summary["axes"]:
        values = axis["values"]
        text = ", ".join(f"{v:g}" for v in values) if len(values) <= 6 else \
            f"{values[0]:g} to {values[-1]:g}, {len(values)} values"
        rows.append([LABELS.get(axis["key"], axis["key"]), text])
    by_status = summary["shots_by_status"]
    rows.append(["shots", f"{summary['shots']}: {by_status['ok']} rebound, {by_status['held']} held by "
                          f"their weight, {by_status['failed']} failed"])
    return [table(f"Sweep ({result.name})", ["what is swept", "values"], rows, "Models")]
