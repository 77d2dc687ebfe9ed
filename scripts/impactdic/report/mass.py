"""The mass of the ball, which a clip does not show."""

import math

from ..errors import ResultError
from ..results import load, read_table
from . import models
from .tables import number


def of_shot(result, asked_kg=None):
    """`asked_kg`, else what the batch's table or a job of fit or compare in the folder says, in kg;
    None where nothing does."""
    if asked_kg:
        return asked_kg
    batch = result.folder.resolve().parent.parent
    for find in (lambda: _of_table(batch, result.name), lambda: _of_models(result.folder)):
        try:
            mass = find()
        except (ResultError, OSError, ValueError):  # it serves one figure, and may be damaged
            continue
        if mass is not None and math.isfinite(mass) and mass > 0:
            return mass
    return None


def _of_table(folder, shot):
    path = folder / "shots.csv"
    if not path.exists():
        return None
    table = read_table(path)
    if "mass_g" not in table:
        return None
    rows = [i for i, name in enumerate(table["shot"]) if str(name) == shot]
    return number(table["mass_g"][rows[0]]) / 1e3 if rows else None


def _of_models(folder):
    for path in models.folders_in(folder):
        mass = load(path).job.get("body", {}).get("mass_kg")
        if isinstance(mass, (int, float)):
            return float(mass)
    return None
