"""Digital image correlation of balls that hit surfaces, in high-speed film.

    import impactdic as idic

    clip = idic.open("shot.cine")                 # or an array (frames, height, width)
    shot = idic.track(clip, idic.Ball(diameter_mm=67), surface_deg=30)
    shot, shot.track, shot.fields                 # figures, pandas, xarray
    field = idic.correlate(reference, picture)    # two pictures
    shot = idic.load("shot_01")                   # what the program has written

Image axes: x right, y down, px, pixel centres at integers; rotation positive counter-clockwise on
the screen; what could not be measured is NaN, and a status says why. Columns: docs/file-formats.md.
"""

import importlib

from .errors import (BuildError, Error, FileError, FormatError, InvalidArgument, MissingPackage,
                     OpenClError, ResultError)
from .results import Result, load, read_table, shots_of

# What needs more than numpy, or the compiled part, is imported when it is first used.
_LATER = {
    "Ball": "run", "ResultWarning": "run", "batch": "run", "correlate": "run", "track": "run",
    "track_blocks": "run", "Clip": "clip", "open": "clip", "Batch": "shot", "Shot": "shot",
    "Fit": "models", "Simulation": "models", "fit": "models", "simulate": "models",
    "sweep": "sweep", "synth": "models", "devices": "engine", "to_mat": "export", "to_vtk": "export",
}

__all__ = ["BuildError", "Error", "FileError", "FormatError", "InvalidArgument", "MissingPackage",
           "OpenClError", "Result", "ResultError", "load", "read_table", "shots_of", *_LATER]


def __getattr__(name):
    if name == "__version__":
        from .engine import module

        return module().__version__
    if name not in _LATER:
        raise AttributeError(f"impactdic has no '{name}'")
    value = getattr(importlib.import_module(f".{_LATER[name]}", __name__), name)
    globals()[name] = value
    return value


def __dir__():
    return sorted([*globals(), *_LATER])
