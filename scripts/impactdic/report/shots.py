"""Figures over the shots of a batch."""

import numpy as np

from .figure import BLUE, COLOURS, GREEN, MARKERS, RED, Figure, Panel, Series
from .shot import Shot

MOST_CURVES = 60  # in one panel
MOST_POINTS = 300  # of one curve


class Shots:
    """The rows of shots.csv with an impact whose velocities are known, grouped by angle."""

    def __init__(self, table):
        found = np.isfinite(table["vn_before_m_s"])
        self.table = {name: column[found] for name, column in table.items()}
        self.angles = np.unique(self["surface_angle_deg"])
        self.speed = np.hypot(self["vt_before_m_s"], self["vn_before_m_s"])
        self.normal_speed = np.abs(self["vn_before_m_s"])
        self.incidence = np.rad2deg(
            np.arctan2(np.abs(self["vt_before_m_s"]), self.normal_speed)
        )

    def __getitem__(self, name):
        return self.table[name]

    def __len__(self):
        return len(self["shot"])

    def by_angle(self, x, y, sd, scale=1.0):
        """A series of markers for every angle of the surface."""
        made = []
        for i, angle in enumerate(self.angles):
            rows = self["surface_angle_deg"] == angle
            made.append(
                Series(
                    f"{angle:g}°",
                    x[rows],
                    scale * self[y][rows],
                    scale * self[sd][rows],
                    COLOURS[i % len(COLOURS)],
                    "markers",
                    MARKERS[i % len(MARKERS)],
                    labels=[str(name) for name in self["shot"][rows]],
                )
            )
        return made

    def mean_by_angle(self, name, column, colour, marker="circle"):
        """Averages with the scatter of the shots as deviation (none where there is one shot)."""
        means, scatters = [], []
        for angle in self.angles:
            values = self[column][self["surface_angle_deg"] == angle]
            values = values[np.isfinite(values)]
            means.append(np.mean(values) if len(values) else np.nan)
            scatters.append(np.std(values, ddof=1) if len(values) > 1 else np.nan)
        return Series(name, self.angles, np.array(means), np.array(scatters), colour, "markers",
                      marker)


def figures(table, results):
    """`table`: shots.csv; `results`: the folders of the shots that were measured."""
    shots = Shots(table)
    if len(shots) == 0:
        return []
    made = [restitution(shots), friction(shots), contact(shots), curves(results)]
    return [figure for figure in made if figure is not None]


def restitution(shots):
    """Figs 3.21, 3.22 and 4.8."""
    by_speed = shots.by_angle(shots.normal_speed, "restitution", "restitution_sd")
    mean = shots.mean_by_angle("mean", "restitution", BLUE)
    return Figure(
        "restitution",
        "Coefficient of restitution",
        "Against the normal velocity before the impact, bars of 95 %; and the mean of every angle "
        "of the surface, bars from the scatter of the shots.",
        [
            Panel("against speed", "normal velocity before, m/s", "restitution e", by_speed),
            Panel("against angle", "angle of the surface, °", "restitution e", [mean]),
        ],
        "Many shots",
    )


def friction(shots):
    """Figs 3.23 and 3.24."""
    means = [
        shots.mean_by_angle("Eq. 3.12", "friction_eq_3_12", BLUE),
        shots.mean_by_angle("gravity-corrected", "friction", GREEN, "square"),
    ]
    if np.isfinite(shots["rolling_cap"]).any():
        means.append(shots.mean_by_angle("rolling cap", "rolling_cap", RED, "diamond"))
    incidence = shots.by_angle(shots.incidence, "friction", "friction_sd")
    return Figure(
        "friction",
        "Effective coefficient of friction",
        "The ratio of the impulses; beyond the rolling cap more friction only makes the ball roll. "
        "The angle of incidence is that between the velocity before and the surface's normal.",
        [
            Panel("against speed", "speed before, m/s", "effective friction µ",
                  shots.by_angle(shots.speed, "friction", "friction_sd")),
            Panel("against incidence", "angle of incidence, °", "effective friction µ",
                  incidence),
            Panel("against the surface", "angle of the surface, °", "effective friction µ",
                  means),
        ],
        "Many shots",
    )


def contact(shots):
    speed = "normal velocity before, m/s"
    return Figure(
        "contact",
        "Contact",
        "A linear spring keeps its contact time at every speed; a Hertz contact does not.",
        [
            Panel("duration", speed, "contact time, ms",
                  shots.by_angle(shots.normal_speed, "contact_s", "contact_sd_s", 1e3)),
            Panel("deflection", speed, "largest deflection, mm",
                  shots.by_angle(shots.normal_speed, "max_deflection_m", "max_deflection_sd_m",
                                 1e3)),
            Panel("spin", "tangential velocity before, m/s", "angular velocity after, rad/s",
                  shots.by_angle(shots["vt_before_m_s"], "omega_after_rad_s",
                                 "omega_after_sd_rad_s")),
        ],
        "Many shots",
    )


def curves(results):
    """Normal and tangential velocity of all shots, each from its own touch on."""
    normal, tangential, spins = [], [], []
    with_impact = [r for r in results if r.impact is not None and r.impact.get("t0")]
    for i, result in enumerate(with_impact[:MOST_CURVES]):
        shot = Shot(result)
        start, _, end = shot.instants
        if start is None or end is None or not shot.si:
            continue
        time = shot.mid_time - start
        shown = np.flatnonzero(np.abs(time - (end - start) / 2) < 1.5 * (end - start))
        shown = shown[:: max(1, len(shown) // MOST_POINTS)]
        colour = COLOURS[i % len(COLOURS)]
        for series, y in ((normal, shot.vn), (tangential, shot.vt), (spins, shot.spin)):
            series.append(Series(result.name, time[shown], y[shown], colour=colour))
    if not normal:
        return None
    since = "time since the touch, ms"
    left_out = len(with_impact) - MOST_CURVES
    return Figure(
        "all_shots",
        "Motion of all shots",
        "From the touch on." + (f" {left_out} more shots are not drawn." if left_out > 0 else ""),
        [
            Panel("normal", since, "vn, m/s", normal),
            Panel("tangential", since, "vt, m/s", tangential),
            Panel("spin", since, "angular velocity, rad/s", spins),
        ],
        "Many shots",
    )
