"""Made films and impact models: synth, simulate, fit."""

from pathlib import Path

import numpy as np

from . import engine, tables
from .errors import FileError, InvalidArgument
from .results import tomllib
from .shot import Batch, Shot

_POSE = ("cx_px", "cy_px", "angle_deg", "compression", "compression_axis_deg", "rx_deg", "ry_deg",
         "z_px", "qw", "qx", "qy", "qz")


def read_job(job):
    """A job as a dictionary: given as one, or the path of a TOML file."""
    if isinstance(job, dict):
        return dict(job)
    try:
        return tomllib.loads(Path(job).read_text(encoding="utf-8"))
    except OSError as error:
        raise FileError("cannot read the job", job, error.strerror) from error
    except tomllib.TOMLDecodeError as error:
        raise InvalidArgument("the job is no TOML", job, error) from error


def _three(values, name, allowed):
    """Two or one of three numbers are filled up with zeros as the command line has them."""
    values = np.atleast_1d(np.asarray(values, dtype=float))
    if values.shape == (3,):
        return tuple(values)
    if values.shape == (allowed,):
        return (*values, 0.0) if allowed == 2 else (0.0, 0.0, *values)
    raise InvalidArgument(f"must be {allowed} or 3 numbers", name)


def synth(*, velocity_px=None, spin_deg=None, poses=None, simulate=None, progress=False, **options):
    """A film of a speckled ball with exactly known motion.

    velocity_px: (dx, dy) or (dx, dy, dz) a frame, px, x right, y down. spin_deg: (x, y, z), or z
    alone, degrees a frame; x and y turn a sphere, and make the ball one. simulate: a job of
    `simulate` (a dictionary or a file), whose path the ball follows. poses: a table with the columns
    cx_px, cy_px and angle_deg or rx_deg, ry_deg, rz_deg of every frame.
    options: those of `impactdic synth`, underscores for dashes: pattern, frames, radius_px, size
    (width, height), fps, seed, noise, blur, shading, exposure, bits, body, start_px (x, y), …

    Returns (film, truth): an array (frames, height, width) of uint8, or uint16 above 8 bits, and a
    pandas.DataFrame with the columns of truth.csv. The film is that of the program to the last bit.
    Raises InvalidArgument.
    """
    if velocity_px is not None:
        options["velocity_px"] = _three(velocity_px, "velocity_px", 2)
    if spin_deg is not None:
        if options.get("rotation_deg") is not None:
            raise InvalidArgument("the rotation is given twice", "rotation_deg, spin_deg", "choose one")
        options["spin_deg"] = _three(spin_deg, "spin_deg", 1)
        if any(options["spin_deg"][:2]):
            options.setdefault("body", "sphere")
    if poses is not None:
        options["poses"] = _pose_rows(poses)
    if simulate is not None:
        job = read_job(simulate)
        options["simulate"] = {key: job[key] for key in job if key != "output"}
    if len([key for key in ("poses", "simulate") if key in options]) > 1 or (
            ("poses" in options or "simulate" in options) and (velocity_px is not None
                                                               or spin_deg is not None)):
        raise InvalidArgument("the motion is given twice", "velocity_px, spin_deg, poses, simulate",
                              "choose one")
    made = engine.module().synth(options, engine.listener(progress))
    return made["film"], _truth(made, options.get("body") == "sphere")


def _pose_rows(poses):
    columns = {name: np.asarray(poses[name], dtype=float) for name in poses}
    if "cx_px" not in columns or "cy_px" not in columns:
        raise InvalidArgument("must have the columns cx_px and cy_px", "poses")
    zero = np.zeros(len(columns["cx_px"]))
    angle = columns.get("rz_deg", columns.get("angle_deg", zero))
    return np.column_stack([
        columns["cx_px"], columns["cy_px"], angle, columns.get("compression", zero),
        columns.get("compression_axis_deg", zero + 90), columns.get("rx_deg", zero),
        columns.get("ry_deg", zero), columns.get("z_px", zero)]).tolist()


def _turns_deg(q):
    """Rotation vectors from each orientation to the next, camera axes; the last one NaN."""
    w, x, y, z = q.T
    a, b = q[1:], q[:-1] * [1, -1, -1, -1]
    vector = a[:, :1] * b[:, 1:] + b[:, :1] * a[:, 1:] + np.cross(a[:, 1:], b[:, 1:])
    scalar = a[:, 0] * b[:, 0] - np.sum(a[:, 1:] * b[:, 1:], axis=1)
    sign = np.where(scalar < 0, -1.0, 1.0)
    length = np.linalg.norm(vector, axis=1)
    angle = 2 * np.arctan2(length, np.abs(scalar))
    factor = np.where(length > 0, angle / np.where(length > 0, length, 1), 2.0)
    return np.vstack([np.rad2deg(sign * factor)[:, None] * vector, np.full((1, 3), np.nan)])


def _truth(made, sphere):
    pose = dict(zip(_POSE, made["poses"].T))
    count = len(made["poses"])
    steps = {name: np.append(np.diff(pose[name]), np.nan) for name in ("cx_px", "cy_px", "angle_deg")}
    radius = np.full(count, made["radius_px"])
    if sphere and made["distance_radii"]:
        distance = made["distance_radii"] * made["radius_px"]
        radius = np.where(pose["z_px"] == 0, radius, radius * distance / (distance - pose["z_px"]))
    columns = {"frame": np.arange(count), "time_s": np.arange(count) / made["fps"],
               "cx_px": pose["cx_px"], "cy_px": pose["cy_px"], "r_px": radius,
               "dx_px": steps["cx_px"], "dy_px": steps["cy_px"], "rot_deg": steps["angle_deg"]}
    if sphere:
        turns = _turns_deg(made["poses"][:, 8:])
        columns["rot_deg"] = turns[:, 2]
        columns.update(z_px=pose["z_px"], rx_deg=pose["rx_deg"], ry_deg=pose["ry_deg"],
                       rz_deg=pose["angle_deg"], qw=pose["qw"], qx=pose["qx"], qy=pose["qy"],
                       qz=pose["qz"], rot_x_deg=turns[:, 0], rot_y_deg=turns[:, 1])
    if np.any(pose["compression"]):
        columns.update(compression=pose["compression"],
                       compression_axis_deg=pose["compression_axis_deg"])
    return tables.frame(columns, surface_angle_deg=made["surface_angle_deg"],
                        leaves_view=made["leaves_view"])


class Simulation(dict):
    """Figures of an integrated impact by the keys of summary.json (restitution, contact_s, …);
    `trajectory` is its path, a pandas.DataFrame; `derivatives`, where they were asked for, a
    DataFrame of the outcomes (rows) by the numbers of the job (columns), else None."""

    @property
    def trajectory(self):
        return tables.frame(self["trajectory"])

    @property
    def derivatives(self):
        if "derivatives" not in self:
            return None
        return tables.frame(self["derivatives"]).T

    def __repr__(self):
        after = self["final"]
        return (f"Simulation: restitution {self['restitution']:.4g}, contact "
                f"{1e3 * self['contact_s']:.4g} ms, after: vt {after['vt_m_s']:.4g} m/s, vn "
                f"{after['vn_m_s']:.4g} m/s, spin {after['omega_rad_s']:.4g} rad/s")


def simulate(job, *, rate_hz=0.0, times_s=(), derivatives=None):
    """Integrates an impact model. job: a dictionary with the keys of a job of `impactdic simulate`
    (normal, friction, preset, body, contact, shell, surface, initial, environment, solver), or its
    file.
    rate_hz: points of the path a second, 0: 200 over the first contact; or times_s, ascending.
    derivatives: also those of the outcome by every number of the job; None: as the job has it.
    Returns a Simulation. Raises InvalidArgument naming the key."""
    job = read_job(job)
    output = job.pop("output", None) or {}
    wanted = output.get("derivatives", False) if derivatives is None else derivatives
    return Simulation(engine.module().simulate(job, float(rate_hz or output.get("rate_hz", 0)),
                                               [float(t) for t in times_s], bool(wanted)))


class Fit:
    """Calibrated parameters. `parameters`: a table of all shots together; `shots`: one dictionary a
    shot (parameters, rivals, chi_square, adequate, …); `rivals`: laws that were compared."""

    def __init__(self, outcome, model):
        self._outcome, self.model = outcome, model
        self.shots = outcome["shots"]
        self.cancelled = outcome["cancelled"]
        self.warnings = [w for shot in self.shots for w in shot["warnings"]]

    @property
    def parameters(self):
        """One row a parameter: value, sd (weighted over the shots), mean, scatter_sd, …"""
        pooled = self._outcome["pooled"]
        names = ("parameter", "value", "sd", "between_sd", "mean", "scatter_sd", "determined")
        return tables.frame({name: [row[name] for row in pooled] for name in names})

    @property
    def rivals(self):
        """One row a law and shot, the best first: above_best is the distance in AICc."""
        names = ("normal", "friction", "restitution_damping", "chi_square", "p_value", "aicc",
                 "above_best")
        rows = [(shot["file"], rival) for shot in self.shots for rival in shot["rivals"]]
        columns = {"file": [file for file, _ in rows]}
        columns.update({name: [rival[name] for _, rival in rows] for name in names})
        return tables.frame(columns)

    def __repr__(self):
        lines = [f"Fit of {self.model} to {len(self.shots)} shots"]
        lines += [f"  warning: {warning}" for warning in self.warnings]
        for row in self._outcome["pooled"]:
            lines.append(f"  {row['parameter']}: {row['value']:.6g} ± {row['sd']:.2g}")
        return "\n".join(lines)


def _tracks(shots):
    """Every shot's table on the disk."""
    if isinstance(shots, (Shot, str, Path)):
        shots = [shots]
    found = []
    for shot in shots:
        if isinstance(shot, Batch):
            found += shot.shots
        else:
            found.append(shot if isinstance(shot, Shot) else Shot(Path(shot)))
    if not found:
        raise InvalidArgument("there is no shot to fit", "shots")
    return found


def fit(shots, model="linear_spring_damper", *, friction="none", compare=None, ball=None,
        contact=None, preset="sound", gravity_m_s2=9.81, parameters=None, unknowns=("contact_time_s",),
        progress=False, **options):
    """Calibrates an impact law on measured shots.

    shots: Shots, a Batch, or folders of `track`. model, friction, preset, contact: as in a job of
    `impactdic fit`. ball: mass, diameter and inertia; that of the shots without it.
    parameters: what is fitted; without it the stiffness and the damping of a spring law.
    compare: "all" also fits rival laws to every shot and ranks them.
    options: unknowns, method, flight_frames, outlier_sd, surface_angle_deg, threads.
    Returns a Fit. Raises InvalidArgument, FileError, FormatError.
    """
    found = _tracks(shots)
    ball = ball or next((shot.ball for shot in found if shot.ball), None)
    if ball is None:
        raise InvalidArgument("the ball's mass, diameter and inertia are not known", "ball",
                              "ball=Ball(diameter_mm=…, mass_g=…, inertia_factor=…)")
    if compare not in (None, False, True, "all"):
        raise InvalidArgument("must be \"all\" or None", "compare")
    if parameters is None:
        hertz = model == "hertz_damper"
        parameters = ["stiffness_n_per_m1p5" if hertz else "stiffness_n_per_m", "damping_n_s_per_m"]
        if model not in ("hertz_damper", "linear_spring_damper"):
            parameters = ["yield_strength_pa"]
    impact = {"normal": model, "friction": friction, "preset": preset, "body": ball.body(),
              "contact": dict(contact or {}), "environment": {"gravity_m_s2": gravity_m_s2}}
    options.update(parameters=list(parameters), unknowns=list(unknowns), rivals=bool(compare))
    outcome = engine.module().fit([str(shot.folder / "track.csv") for shot in found], impact,
                                  options, engine.listener(progress))
    return Fit(outcome, model)
