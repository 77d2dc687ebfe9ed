"""Sweeps: many impacts of one model."""

import warnings

import numpy as np

from . import engine, tables
from .errors import InvalidArgument
from .models import read_job

_STATUS = ("ok", "held", "failed")
_WORDS = {
    "restitution": "of the contact point's normal velocity",
    "tangential_restitution": "minus the contact point's tangential velocity after over before",
    "friction": "ratio of impulses, gravity taken out",
    "rolling_cap": "the friction that lets the ball roll at the end",
    "lost": "share of the kinetic energy that the body does not take along",
    "phases": "of the friction law, in their order", "reason": "why a shot failed",
}


def _values(name, values):
    """Numbers of an axis: an array, one number, or {"from", "to", "count"} as in a job file."""
    if isinstance(values, dict):
        if set(values) != {"from", "to", "count"}:
            raise InvalidArgument("must have from, to and count", name)
        values = np.linspace(values["from"], values["to"], int(values["count"]))
    try:
        values = np.atleast_1d(np.asarray(values, dtype=float))
    except (TypeError, ValueError):
        raise InvalidArgument("must be numbers", name) from None
    if values.ndim != 1 or values.size == 0 or not np.isfinite(values).all():
        raise InvalidArgument("must be finite numbers, one or more", name)
    return values


def sweep(job, *, threads=0, progress=False, **axes):
    """Integrates every combination of speeds, angles, spins and constants of one impact law.

    job: as `simulate` takes it; its own table `sweep` gives axes, too. axes: by their keys in a job
    file (docs/sweeps.md): speed_m_s, incidence_deg (from the normal), drop_angle_deg,
    surface_angle_deg, omega_rad_s, spin_ratio, friction_kinetic, the law's stiffness and damping, …;
    each an array, a number, or {"from": a, "to": b, "count": n}. At most a million shots.
    threads: shots at a time, 0: as many as there are cores. progress: as `track`.

    Returns an xarray.Dataset whose dimensions are the axes, in their order: velocities and spins
    before and after, restitution, friction, contact_s, … as in sweep.csv; NaN where a shot has no
    such figure, `status` and `reason` say why. Ctrl-C returns what was done. Raises InvalidArgument.
    """
    job = read_job(job)
    job.pop("output", None)
    named = {**(job.pop("sweep", None) or {}), **axes}
    if not named:
        raise InvalidArgument("there is nothing to sweep", "axes", "speed_m_s=[1, 2, 3]")
    given = {name: _values(name, values) for name, values in named.items()}
    outcome = engine.module().sweep(job, [(name, values.tolist()) for name, values in given.items()],
                                    int(threads), engine.listener(progress))
    if outcome["cancelled"]:
        from .run import ResultWarning

        warnings.warn("the sweep was stopped before its end: shots not begun are failed",
                      ResultWarning, stacklevel=2)
    return _dataset(given, outcome)


def _dataset(given, outcome):
    xarray = engine.package("xarray", "a sweep")
    shape = tuple(len(values) for values in given.values())
    variables = {}
    for name, values in outcome["columns"].items():
        attributes = {"units": tables.unit_of(name) or "1", "long_name": _WORDS.get(name, name)}
        if name in ("phases", "reason"):
            attributes.pop("units")
        if name == "status":
            attributes["flag_values"] = np.arange(len(_STATUS), dtype=np.int8)
            attributes["flag_meanings"] = " ".join(_STATUS)
        variables[name] = (tuple(given), np.asarray(values).reshape(shape), attributes)
    coordinates = {name: (name, values, {"units": tables.unit_of(name) or "1"})
                   for name, values in given.items()}
    return xarray.Dataset(variables, coords=coordinates,
                          attrs={"cancelled": int(outcome["cancelled"])})
