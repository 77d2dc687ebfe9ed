"""Figures of a folder of `correlate`: the field of displacement and strain, and the region's
motion."""

import numpy as np

from ..errors import ResultError
from .figure import (
    BLACK,
    BLUE,
    GREEN,
    RED,
    Figure,
    Panel,
    Reference,
    Series,
    Surface,
    arrow_pairs,
    one_digit_below,
    thinned,
)
from .first import ENOUGH, First, Light, texture_light
from .text import rounded

MOST_FRAMES = 400  # of which means over the windows are drawn
MOST_ARROWS = 200
STRAINS = (("exx", "along x", BLUE), ("eyy", "along y", RED), ("exy", "shear", GREEN))
HONEST = 1.5  # scatter of still windows over what they state, at most
FOUND, MASKED = 0, 1  # of the windows' status


class Field:
    """What fields.h5 and motion.csv hold, a frame at a time."""

    def __init__(self, result):
        import h5py

        self.result = result
        self.motion = result.columns("motion")
        try:
            with h5py.File(result.folder / "fields.h5", "r") as file:
                self._read(file)
        except (OSError, KeyError) as error:
            raise ResultError("cannot read the displacement fields", result.folder / "fields.h5",
                              error) from error

    def _read(self, file):
        status = file["status"][:]
        usable = (status != MASKED).sum(axis=1)
        self.frames = file["frame"][:]
        self.found = (status == FOUND).sum(axis=1)
        self.share = self.found / np.maximum(usable, 1)
        measured = np.flatnonzero(self.found > 0)
        self.rows = measured[:: max(1, len(measured) // MOST_FRAMES)]
        self.means = {name: [] for name in ("length", "largest", "correlation", "sd",
                                            *(s[0] for s in STRAINS))}
        for row in self.rows:
            windows = self._windows(file, row, status[row])
            lengths = np.hypot(windows["u_px"], windows["v_px"])
            self.means["length"].append(np.mean(lengths))
            self.means["largest"].append(np.max(lengths))
            self.means["correlation"].append(np.nanmean(windows["correlation"]))
            sd = np.hypot(windows["u_sd_px"], windows["v_sd_px"]) / np.sqrt(2)
            self.means["sd"].append(np.nanmedian(sd))
            for name, value in strains(windows).items():
                self.means[name].append(np.nanmedian(value))
        self.means = {name: np.array(values) for name, values in self.means.items()}
        self.shown, self.windows = None, None
        if len(self.rows):
            row = self.rows[int(np.argmax(self.means["length"]))]
            self.shown, self.windows = int(self.frames[row]), self._windows(file, row, status[row])

    @staticmethod
    def _windows(file, row, status):
        names = ("x_px", "y_px", "u_px", "v_px", "u_sd_px", "v_sd_px", "correlation", "ux", "uy",
                 "vx", "vy")
        return {name: file[name][row][status == FOUND].astype(float) for name in names}

    @property
    def step_wise(self):
        """True where each frame is measured against the one before."""
        return self.result.job.get("reference") == "previous"


def strains(windows):
    """Green and Lagrange's strain, E = (Fᵀ F - 1) / 2, which no turn changes."""
    ux, uy, vx, vy = (windows[name] for name in ("ux", "uy", "vx", "vy"))
    return {"exx": ux + (ux**2 + vx**2) / 2, "eyy": vy + (uy**2 + vy**2) / 2,
            "exy": (uy + vx + ux * uy + vx * vy) / 2}


def first_screen(field):
    """The region's motion in a sentence, with its checks."""
    motion, summary = field.motion, field.result.summary
    turns = np.asarray(motion["rot_deg"], float)
    parts = [f"{summary.get('frames_measured', 0)} of {summary.get('frames_analysed', 0)} frames "
             "measured"]
    if field.shown is not None:
        k = int(np.argmax(field.means["largest"]))
        moved = "stepped" if field.step_wise else "moved"
        parts.append(f"windows {moved} by up to {field.means['largest'][k]:.3g} px "
                     f"(frame {field.frames[field.rows[k]]})")
        if np.isfinite(turns).any():
            turn = int(np.nanargmax(np.abs(turns)))
            parts.append(f"turned by {rounded(turns[turn], motion['rot_sd_deg'][turn])}°")
        if np.isfinite(motion.get("dx_m", np.array([np.nan]))).any():
            moved = np.hypot(motion["dx_m"], motion["dy_m"])
            far = int(np.nanargmax(moved))
            sd = float(np.hypot(motion["dx_sd_m"][far], motion["dy_sd_m"][far]) / np.sqrt(2))
            parts.append(f"the region by {rounded(1e3 * moved[far], 1e3 * sd)} mm in the plane of "
                         "motion")
        largest = max((field.means[name] for name, _, _ in STRAINS),
                      key=lambda values: np.nanmax(np.abs(values)))
        parts.append(f"median strain up to {largest[np.nanargmax(np.abs(largest))]:#.2g}")
    return First(", ".join(parts), _lights(field))


def _lights(field):
    made = texture_light(field.result.summary)
    if len(field.rows):
        share = float(np.mean(field.share[field.rows]))
        made.append(Light("windows", "good" if share >= ENOUGH else "bad",
                          f"{100 * share:.0f} % of them were found"))
    floor = field.result.summary.get("noise_floor")
    if floor:
        spatial, temporal, stated = (np.sqrt(np.mean(np.square(floor[f"{name}_sd_px"])))
                                     for name in ("spatial", "temporal", "stated"))
        first, last = floor["frames"]
        made.append(Light("noise floor", "good" if spatial <= HONEST * stated else "bad",
                          f"{spatial:.4f} px over the windows, {temporal:.4f} px over the still "
                          f"frames {first} to {last}; {stated:.4f} px are stated"))
    return made


def figures(field):
    made = []
    if field.shown is not None:
        made += [displacement(field), strain(field)]
    if len(field.rows) > 1:  # a line needs two points
        made += [motion(field), over_time(field)]
    return [figure for figure in made if figure is not None]


def _grid(x, y, values):
    """Columns, rows and values on their grid; None where the places are on no grid."""
    columns, rows = np.unique(x), np.unique(y)
    if len(columns) < 2 or len(rows) < 2 or len(columns) * len(rows) > 20 * len(x):
        return None
    grid = np.full((len(rows), len(columns)), np.nan)
    grid[np.searchsorted(rows, y), np.searchsorted(columns, x)] = values
    return columns, rows, grid


def _map(field, title, values, unit, series=()):
    grid = _grid(field.windows["x_px"], field.windows["y_px"], values)
    if grid is None:
        return None
    return Panel(title, "x, px", "y, px", list(series), surface=Surface(*grid, unit),
                 same_scale=True, y_down=True)


def _figure(name, title, caption, panels):
    panels = [panel for panel in panels if panel is not None]
    return Figure(name, title, caption, panels, "Displacement field") if panels else None


def displacement(field):
    w = field.windows
    x, y, u, v = (w[name] for name in ("x_px", "y_px", "u_px", "v_px"))
    length = np.hypot(u, v)
    keep = thinned(x, y, MOST_ARROWS)
    width = max(np.ptp(x), np.ptp(y), 1.0)
    factor = 0.08 * width / np.max(length) if np.max(length) > 0 else 1.0
    arrows = Series("displacement", *arrow_pairs(x[keep], y[keep], factor * u[keep],
                                                 factor * v[keep]), colour=BLACK, kind="arrows")
    panels = [_map(field, "u, to the right", u, "u, px"), _map(field, "v, downwards", v, "v, px"),
              _map(field, "length and direction", length, "displacement, px", [arrows])]
    if panels[2] is not None and np.max(length) > 0:
        known = one_digit_below(np.max(length))
        panels[2].reference = Reference(np.min(x), np.max(y) + 0.14 * width, factor * known,
                                        f"{known:g} px")
    since = "the frame before" if field.step_wise else "the reference"
    return _figure("displacement_field", f"Displacement in frame {field.shown}",
                   f"Since {since}; the frame with the largest mean. Image axes, y down.", panels)


def strain(field):
    values = strains(field.windows)
    panels = [_map(field, f"{name}, {what}", values[name], f"strain {name}")
              for name, what, _ in STRAINS]
    return _figure("strain_field", f"Strain in frame {field.shown}",
                   "Green and Lagrange's, from the windows' own gradients; a turn alone makes none.",
                   panels)


def _times(field, frames):
    """The frames on the time axis, and its name."""
    time = np.asarray(field.motion["time_s"], float)
    if not np.isfinite(time).any():
        return frames, "frame, number"
    return 1e3 * np.interp(frames, field.motion["frame"], time), "time, ms"


def motion(field):
    table = field.motion
    time, label = _times(field, table["frame"])

    def series(name, column, sd, colour):
        return Series(name, time, table[column], table[sd], colour)

    what = "step" if field.step_wise else "displacement"
    return Figure(
        "region_motion", "Motion of the region",
        "Rigid part of the motion, of the region's centre. Image axes, y down; counter-clockwise "
        "positive. Bands: 95 %.",
        [Panel("displacement", label, f"{what}, px", [series("dx", "dx_px", "dx_sd_px", BLUE),
                                                      series("dy", "dy_px", "dy_sd_px", RED)]),
         Panel("rotation", label, "rotation, °", [series("rotation", "rot_deg", "rot_sd_deg",
                                                         BLUE)])])


def over_time(field):
    time, label = _times(field, field.frames[field.rows])
    lines = [Series(f"{name}, {what}", time, field.means[name], colour=colour)
             for name, what, colour in STRAINS]
    return Figure(
        "field_over_time", "The field over time",
        "Medians over the windows of a frame (of the correlation: means).",
        [Panel("strain", label, "median strain", lines),
         Panel("correlation", label, "mean correlation (ZNCC)",
               [Series("correlation", time, field.means["correlation"], colour=BLUE)]),
         Panel("deviation", label, "one deviation of a window, px",
               [Series("deviation", time, field.means["sd"], colour=BLUE)]),
         Panel("windows", label, "windows found", from_zero=True, series=[
             Series("windows", time, field.found[field.rows].astype(float), colour=GREEN)])],
        "Quality")
