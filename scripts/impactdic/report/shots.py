"""Figures over the shots of a batch."""

import numpy as np

from . import groups
from .figure import BLACK, COLOURS, MARKERS, Figure, Panel, Series
from .shot import Shot

MOST_CURVES = 60  # in one panel
MOST_POINTS = 300  # of one curve
GRAVITY_M_S2 = 9.81
MEANS = ("the means over shots of one ball at one angle of the surface, bars of 95 % by their scatter; "
         "shots whose figures are in doubt do not count.")


class Shots:
    """The rows of shots.csv with an impact whose velocities are known, without those that a person
    has left out, grouped by ball and angle."""

    def __init__(self, table, excluded=()):
        found = np.isfinite(table["vn_before_m_s"])
        found &= np.array([str(name) not in excluded for name in table["shot"]], dtype=bool)
        self.table = {name: column[found] for name, column in table.items()}
        self.counted = groups.counted(self.table, excluded)
        self.angles = np.unique(self["surface_angle_deg"])
        self.ball = np.array([groups.ball_of(self.table, row) for row in range(len(self))], dtype=str)
        self.balls = sorted(set(self.ball))
        self.speed = np.hypot(self["vt_before_m_s"], self["vn_before_m_s"])
        self.normal_speed = np.abs(self["vn_before_m_s"])
        self.incidence = np.rad2deg(
            np.arctan2(np.abs(self["vt_before_m_s"]), self.normal_speed)
        )

    def __getitem__(self, name):
        return self.table[name]

    def __len__(self):
        return len(self["shot"])

    def groups(self, x, y, sd, scale=1.0):
        """A series of markers for every ball at every angle of the surface."""
        made = []
        for ball in self.balls:
            for angle in np.unique(self["surface_angle_deg"][self.ball == ball]):
                rows = (self.ball == ball) & (self["surface_angle_deg"] == angle)
                made.append(Series(
                    self._named(ball, f"{angle:g}°"), x[rows], scale * self[y][rows],
                    scale * self[sd][rows], COLOURS[len(made) % len(COLOURS)], "markers",
                    MARKERS[len(made) % len(MARKERS)],
                    labels=[str(name) for name in self["shot"][rows]]))
        return made

    def means(self, quantities):
        """Means against the angle of the surface, a series for each ball and each (name, column), with
        their deviations (groups.mean). Shots whose figures are in doubt do not count."""
        made = []
        for ball in self.balls:
            for marker, (name, column) in zip(MARKERS, quantities):
                rows = [(self.ball == ball) & (self["surface_angle_deg"] == angle) & self.counted
                        for angle in self.angles]
                own = self.table.get(f"{column}_sd")
                found = np.array([groups.mean(self[column][row], None if own is None else own[row])
                                  for row in rows]).reshape(-1, 2)
                made.append(Series(self._named(ball, name), self.angles, found[:, 0], found[:, 1],
                                   COLOURS[len(made) % len(COLOURS)], "markers", marker))
        return made

    def _named(self, ball, name):
        return f"{ball or 'another ball'}: {name}" if len(self.balls) > 1 else name


def figures(table, results, excluded=()):
    """`table`: shots.csv; `results`: the folders of the shots that were measured; `excluded`: names of
    those that a person has left out."""
    shots = Shots(table, excluded)
    results = [result for result in results if result.name not in excluded]
    if len(shots) == 0:
        return []
    made = [restitution(shots), friction(shots), contact(shots), drop(shots), curves(results)]
    return [figure for figure in made if figure is not None]


def restitution(shots):
    """Figs 3.21, 3.22 and 4.8."""
    by_speed = shots.groups(shots.normal_speed, "restitution", "restitution_sd")
    return Figure(
        "restitution",
        "Coefficient of restitution",
        "Against the normal velocity before the impact, bars of 95 %; and " + MEANS,
        [
            Panel("against speed", "normal velocity before, m/s", "restitution e", by_speed),
            Panel("against angle", "angle of the surface, °", "restitution e",
                  shots.means([("mean", "restitution")])),
        ],
        "Many shots",
    )


def friction(shots):
    """Figs 3.23 and 3.24."""
    quantities = [("Eq. 3.12", "friction_eq_3_12"), ("gravity-corrected", "friction")]
    if np.isfinite(shots["rolling_cap"]).any():
        quantities.append(("rolling cap", "rolling_cap"))
    incidence = shots.groups(shots.incidence, "friction", "friction_sd")
    return Figure(
        "friction",
        "Effective coefficient of friction",
        "The ratio of the impulses; beyond the rolling cap more friction only makes the ball roll. "
        "The angle of incidence is that between the velocity before and the surface's normal. Last "
        + MEANS,
        [
            Panel("against speed", "speed before, m/s", "effective friction µ",
                  shots.groups(shots.speed, "friction", "friction_sd")),
            Panel("against incidence", "angle of incidence, °", "effective friction µ",
                  incidence),
            Panel("against the surface", "angle of the surface, °", "effective friction µ",
                  shots.means(quantities)),
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
                  shots.groups(shots.normal_speed, "contact_s", "contact_sd_s", 1e3)),
            Panel("deflection", speed, "largest deflection, mm",
                  shots.groups(shots.normal_speed, "max_deflection_m", "max_deflection_sd_m",
                                 1e3)),
            Panel("spin", "tangential velocity before, m/s", "angular velocity after, rad/s",
                  shots.groups(shots["vt_before_m_s"], "omega_after_rad_s",
                                 "omega_after_sd_rad_s")),
        ],
        "Many shots",
    )


def drop(shots):
    """The speed at the touch against the one that the height lets expect."""
    height = np.array([groups.number(shots.table, "drop_height_mm", i) for i in range(len(shots))])
    fell = np.isfinite(height) & np.isfinite(shots.speed)
    if not fell.any():
        return None
    expected = np.sqrt(2 * GRAVITY_M_S2 * 1e-3 * height[fell])
    made = []
    for i, ball in enumerate(shots.balls):
        rows = shots.ball[fell] == ball
        made.append(Series(ball or "shots", expected[rows], shots.speed[fell][rows], None,
                           COLOURS[i % len(COLOURS)], "markers", MARKERS[i % len(MARKERS)],
                           labels=[str(name) for name in shots["shot"][fell][rows]]))
    ends = np.array([0, 1.1 * max(expected.max(), shots.speed[fell].max())])
    made.append(Series("as the height says", ends, ends, colour=BLACK, dash=True))
    return Figure(
        "drop",
        "Speed at the touch and height of the drop",
        "Measured speed before the impact against √(2 g h). A slip of scale or frame rate moves all "
        "shots off the line, one of the height a single shot; drag lets fast balls fall below it.",
        [Panel("", "√(2 g h), m/s", "speed before, m/s", made)],
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
