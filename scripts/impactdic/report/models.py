"""Figures of models: `simulate`, and `fit` and `compare` against measurement."""

import subprocess
import tempfile
from pathlib import Path

import numpy as np

from ..results import ResultError, load, read_table
from . import simulated, sweep
from .figure import BLACK, COLOURS, Figure, Panel, Series, Span, Surface
from .series import deflection
from .shot import Shot

# Those that are integrated; the others are formulas, or laws of their own, and have no path here.
FRICTION_LAWS = ["none", "coulomb", "three_phase", "full_sliding", "brody", "maw_barber_fawcett"]
# What only one friction law takes.
OWN_KEYS = {"friction_static": "three_phase", "poisson": "maw_barber_fawcett"}


def kind_of(folder):
    """fit, compare, sweep, simulate or nothing."""
    for kind, file in (("compare", "comparison.csv"), ("fit", "parameters.csv"),
                       ("sweep", "sweep.csv"), ("simulate", "trajectory.csv")):
        if (folder / file).exists() and (folder / "summary.json").exists():
            return kind
    return None


def folders_in(folder):
    """The results of fit, compare and simulate that `folder` is or holds."""
    candidates = [folder] + sorted(path for path in folder.iterdir() if path.is_dir())
    return [path for path in candidates if kind_of(path)]


def figures(folder, program, warnings):
    """Those of a folder of fit or compare. `program` integrates the models; what could not be drawn
    goes into `warnings`."""
    result = load(folder)
    made = []
    if kind_of(folder) == "simulate":
        return simulated.figures(result)
    if kind_of(folder) == "sweep":
        return sweep.figures(result, warnings)
    if kind_of(folder) == "compare":
        for i, shot in enumerate(result.summary.get("shots", [])):  # none where rods are compared
            try:
                made.append(comparison(result, shot, i, program))
            except (ResultError, OSError, subprocess.CalledProcessError) as error:
                warnings.append(f"no curves of {shot['measured']['track']}: {_reason(error)}")
    for number, shot in enumerate(result.summary.get("shots", [])):
        path = folder / f"residuals_{number}.csv"
        if path.exists():
            table = read_table(path)
            made += over_measurement(result, shot, table, number)
            made.append(residuals(result, shot, table, number))
    for path in sorted(folder.glob("errors_[0-9]*.csv")):
        made.append(error_surfaces(result, path))
    return made


def _reason(error):
    text = getattr(error, "stderr", None) or str(error)
    return text.strip().splitlines()[-1]


def comparison(result, shot, number, program):
    """Figs 3.30 to 3.37 and 4.9 to 4.12: one shot and every model of it."""
    measured = shot["measured"]
    panels = {
        "normal": Panel("normal displacement", "time since the touch, ms", "displacement, mm"),
        "tangential": Panel("tangential displacement", "time since the touch, ms",
                            "displacement, mm"),
        "vt": Panel("tangential velocity", "time since the touch, ms", "velocity, m/s"),
        "tip": Panel("contact point", "time since the touch, ms", "velocity, m/s"),
        "spin": Panel("angular velocity", "time since the touch, ms", "angular velocity, rad/s"),
    }
    laws = [model for model in shot["models"] if model["model"] in FRICTION_LAWS]
    if Path(measured["track"]).is_file():
        _add_path(panels, measured)
    elif laws:
        _add_velocities(panels, measured, laws[0]["contact_s"])
    for i, model in enumerate(laws):
        path = integrate(result, shot, model, program)
        name, colour = model["model"], COLOURS[i % len(COLOURS)]
        time = 1e3 * path["time_s"]
        keep = slice(None, None, max(1, len(time) // 300))
        curves = {
            "normal": 1e3 * (path["qn_m"] - path["qn_m"][0]),
            "tangential": 1e3 * (path["qt_m"] - path["qt_m"][0]),
            "vt": path["vt_m_s"],
            "tip": path["tip_vt_m_s"],
            "spin": path["omega_rad_s"],
        }
        for key, values in curves.items():
            panels[key].series.append(
                Series(name, time[keep], values[keep], colour=colour, dash=i > 0)
            )
    suffix = "" if len(result.summary["shots"]) == 1 else f"_{number + 1}"
    name = name_of(measured["track"])
    return Figure(
        f"models_{result.name}{suffix}",
        f"Models against measurement: {name}, {measured['surface_angle_deg']:g}°",
        "Every model knows the motion before the touch only. Crosses: measured.",
        list(panels.values()),
        "Models",
    )


def name_of(track):
    """A shot's own name: that of its folder, or the one that a table of shots gives it."""
    return Path(track).parent.name if track.endswith("track.csv") else Path(track).name


def _add_velocities(panels, measured, contact_s):
    """Of a shot of which a table says only the velocities."""
    for key, name in (("vt", "vt_m_s"), ("spin", "omega_rad_s")):
        figures = [measured[side][name] for side in ("before", "after")]
        known = [(time, f) for time, f in zip((0.0, 1e3 * contact_s), figures)
                 if f["value"] is not None]
        panels[key].series.append(
            Series("measured", np.array([time for time, _ in known]),
                   np.array([f["value"] for _, f in known]),
                   np.array([f["sd"] or 0.0 for _, f in known]), BLACK, "markers", "x")
        )


def _add_path(panels, measured):
    shot = Shot(load(Path(measured["track"]).parent))
    if not shot.si:
        raise ResultError("the track has no SI results", measured["track"])
    start = 1e3 * measured["contact_start_s"]["value"]
    length = 1e3 * measured["contact_s"]["value"]
    radius = 1e-3 * shot.radius

    def add(key, time, y, sd=None):
        near = (time > start - 0.1 * length) & (time < start + 1.1 * length)
        near = np.flatnonzero(near & np.isfinite(y))
        panels[key].series.append(
            Series("measured", time[near] - start, y[near], None if sd is None else sd[near],
                   BLACK, "markers", "x")
        )

    seconds = 1e-3 * shot.time
    add("normal", shot.time, -1e3 * deflection(seconds, shot.vn, 1e-3 * start))
    add("tangential", shot.time, -1e3 * deflection(seconds, shot.vt, 1e-3 * start))
    add("vt", shot.mid_time, shot.vt, shot.vt_sd)
    add("tip", shot.mid_time, shot.vt + radius * shot.spin,
        np.hypot(shot.vt_sd, radius * shot.spin_sd))
    add("spin", shot.mid_time, shot.spin, shot.spin_sd)


def integrate(result, shot, model, program):
    """trajectory.csv of `impactdic simulate` with the law and the friction of `model` from the
    motion that it began with."""
    if program is None:
        raise ResultError("models are integrated by the program", "report",
                          "call it as impactdic report")
    job = result.job
    contact = {**job["contact"], **result.summary["contact"]}
    contact["friction_kinetic"] = model["friction_kinetic"]
    for key, owner in OWN_KEYS.items():
        if model["model"] != owner:
            contact.pop(key, None)
    sections = {
        "": {"normal": job["normal"], "friction": model["model"],
             "preset": job.get("preset", "sound")},
        "body": job["body"],
        "contact": contact,
        "surface": {"angle_deg": shot["measured"]["surface_angle_deg"]},
        "initial": shot["initial"],
        "environment": job.get("environment", {}),
        "output": {"rate_hz": 50000.0},
    }
    with tempfile.TemporaryDirectory() as scratch:
        path = Path(scratch) / "job.toml"
        path.write_text(_to_toml(sections), encoding="utf-8")
        subprocess.run([program, "simulate", path, "-o", Path(scratch) / "out", "-q"],
                       check=True, capture_output=True, text=True)
        return load(Path(scratch) / "out").columns("trajectory")


def _to_toml(sections):
    lines = []
    for name, keys in sections.items():
        if name:
            lines.append(f"[{name}]")
        for key, value in keys.items():
            lines.append(f'{key} = "{value}"' if isinstance(value, str) else f"{key} = {value!r}")
    return "\n".join(lines) + "\n"


def over_measurement(result, shot, table, number):
    """The fitted model's path over the measured one, where the track is still there."""
    track = Path(shot["shot"]["track"])
    if not track.is_file():
        return []
    measured, curves = read_table(track), []
    for i, (column, name) in enumerate((("x_m", "x, right"), ("y_m", "y, up"))):
        of = table["series"] == column
        if column not in measured or not np.any(of):
            continue
        at = table["time_s"][of]
        row = np.searchsorted(measured["time_s"], at - 1e-9).clip(0, len(measured["time_s"]) - 1)
        if not np.allclose(measured["time_s"][row], at, rtol=0, atol=1e-9):
            return []  # the track was measured again since
        place = 1e3 * (measured[column][row] - measured[column][row[0]])
        curves += [Series(f"{name}, measured", 1e3 * at, place, colour=COLOURS[i], kind="markers",
                          size=5),
                   Series(f"{name}, model", 1e3 * at, place + 1e3 * table["residual"][of],
                          colour=COLOURS[i])]
    panel = Panel("", "time, ms", "displacement, mm", curves, [_contact(shot["shot"])])
    suffix = "" if len(result.summary["shots"]) == 1 else f"_{number + 1}"
    return [Figure(f"fit_{result.name}{suffix}",
                   f"The fit over the measurement: {name_of(shot['shot']['track'])}",
                   "Dots: measured, from the first frame on. Lines: the model.", [panel],
                   "Models")] if curves else []


def _contact(measured):
    start = 1e3 * measured["contact_start_s"]["value"]
    return Span(start, start + 1e3 * measured["contact_s"]["value"], "contact", "#FCEFD9")


RESIDUALS = [("centre", "residual, µm", 1e6, ("x_m", "y_m")),
             ("motion from frame to frame", "residual, µm", 1e6, ("dx_m", "dy_m")),
             ("rotation from frame to frame", "residual, mrad", 1e3, ("turn_rad",))]


def residuals(result, shot, table, number):
    """What the fitted model leaves of each measurement. Structure in it is what the law lacks."""
    measured = shot["shot"]
    contact, panels = _contact(measured), []
    for title, label, factor, names in RESIDUALS:
        curves = []
        for i, name in enumerate(names):
            of = table["series"] == name
            if np.any(of):
                curves.append(Series(name.split("_")[0], 1e3 * table["time_s"][of],
                                     factor * table["residual"][of], colour=COLOURS[i],
                                     kind="markers", marker="circle"))
        if curves:
            panels.append(Panel(title, "time, ms", label, curves, [contact]))
    over = table["residual"] / table["sd"]
    edges = np.linspace(-5, 5, 41)
    counts, _ = np.histogram(np.clip(over, -5, 5), edges)
    middle = (edges[1:] + edges[:-1]) / 2
    normal = len(over) * (edges[1] - edges[0]) * np.exp(-middle**2 / 2) / np.sqrt(2 * np.pi)
    panels.append(Panel("over the stated deviations", "residual over its deviation", "number", [
        Series("found", middle, counts.astype(float), colour=COLOURS[0]),
        Series("noise as stated", middle, normal, colour=BLACK, dash=True)]))
    suffix = "" if len(result.summary["shots"]) == 1 else f"_{number + 1}"
    chi = shot.get("reduced_chi_square")
    words = "" if chi is None else f" Chi square over freedom {chi:.3g}: {shot['adequacy']}."
    return Figure(f"residuals_{result.name}{suffix}",
                  f"What the fit leaves: {name_of(measured['track'])}",
                  "Model minus measurement, every frame." + words, panels, "Models")


def error_surfaces(result, path):
    """Figs 3.25 to 3.28: errors of the published grid search."""
    table = read_table(path)
    stiffness_key, damping_key = list(table)[:2]
    stiffness, damping = np.unique(table[stiffness_key]), np.unique(table[damping_key])
    panels = []
    for column, name in (("displacement_error", "displacement"), ("velocity_error", "velocity"),
                         ("product", "product"), ("sum", "sum")):
        z = table[column].reshape(len(stiffness), len(damping)).T
        panels.append(
            Panel(name, f"stiffness, {_unit(stiffness_key)}", "damping, N s/m",
                  surface=Surface(stiffness, damping, z, "relative error"))
        )
    return Figure(
        f"{path.stem}_{result.name}",
        "Errors over stiffness and damping",
        "Mean relative error of displacement and of velocity after the impact, their product and "
        "their sum.",
        panels,
        "Models",
    )


def _unit(key):
    return "N/m^1.5" if key.endswith("1p5") else "N/m"
