"""Displacement fields as xarray.Dataset, dimensions (time, window)."""

import numpy as np

from . import engine
from .errors import ResultError
from .tables import unit_of

# Of fields.h5, and of what the engine hands over.
STATUS = ("ok", "masked", "no_texture", "low_correlation", "at_search_edge", "not_converged",
          "out_of_view")
SCHEMA = 1  # the newest schema_version of fields.h5 that is known here
_WORDS = {
    "x_px": "centre of the window, x right", "y_px": "centre of the window, y down",
    "u_px": "displacement, x right", "v_px": "displacement, y down",
    "u_sd_px": "one standard deviation of u_px", "v_sd_px": "one standard deviation of v_px",
    "ux": "du/dx", "uy": "du/dy", "vx": "dv/dx", "vy": "dv/dy",
    "correlation": "zero-mean normalised cross-correlation",
    "peak_ratio": "highest peak over the highest elsewhere", "status": "what came of the window",
}


def _attributes(name):
    attributes = {"units": unit_of(name) or "1", "long_name": _WORDS.get(name, name)}
    if name == "status":
        attributes["flag_values"] = np.arange(len(STATUS), dtype=np.int8)
        attributes["flag_meanings"] = " ".join(STATUS)
    return attributes


def dataset(columns, frames, fps, attributes):
    """`columns`: arrays (time, window) by name. `frames`: frame number of each row."""
    xarray = engine.package("xarray", "a displacement field")
    frames = np.asarray(frames)
    rows = {name: (("time", "window"), values, _attributes(name))
            for name, values in columns.items()}
    for name in ("x_px", "y_px"):  # the same in every row where the windows stay
        values = columns[name]
        if len(values) and np.array_equal(values, np.broadcast_to(values[:1], values.shape)):
            rows[name] = (("window",), values[0], _attributes(name))
    coordinates = {name: rows.pop(name) for name in ("x_px", "y_px")}
    time = frames / fps if fps else frames.astype(float)
    coordinates["time"] = ("time", time, {"units": "s" if fps else "frame"})
    coordinates["frame"] = ("time", frames)
    return xarray.Dataset(rows, coords=coordinates, attrs=attributes)


def open_file(path):
    """fields.h5 as an h5py.File, of this or an older schema. Files without `schema_version` are of
    schema 0: the same datasets, without the group for viewers and the words of `status`."""
    h5py = engine.package("h5py", "a displacement field")
    try:
        file = h5py.File(path, "r")
    except OSError as error:
        raise ResultError("cannot read the displacement fields", path, error) from error
    version = float(np.ravel(file.attrs.get("schema_version", 0))[0])
    missing = [name for name in ("time", "frame", "status") if name not in file]
    if version <= SCHEMA and not missing:
        return file
    file.close()
    if missing:
        raise ResultError(f"this is no file of displacement fields: it has no {missing[0]}", path)
    raise ResultError(f"the displacement fields have schema {version:g}, this version reads up to "
                      f"{SCHEMA}", path, "a newer impactdic")


def open_fields(path):
    """fields.h5 as it lies on the disk: values are read when they are asked for."""
    xarray = engine.package("xarray", "a displacement field")
    from xarray.backends import BackendArray
    from xarray.core import indexing

    h5py = engine.package("h5py", "a displacement field")
    file = open_file(path)

    class Stored(BackendArray):
        def __init__(self, data):
            self.data, self.shape, self.dtype = data, data.shape, data.dtype

        def __getitem__(self, key):
            return indexing.explicit_indexing_adapter(
                key, self.shape, indexing.IndexingSupport.OUTER_1VECTOR, self.data.__getitem__)

    def text(value):
        value = value.decode() if isinstance(value, bytes) else value
        return value.item() if isinstance(value, np.generic) else value

    variables = {}
    for name, data in file.items():
        if not isinstance(data, h5py.Dataset) or name in ("time", "window", "frame"):
            continue
        attributes = {key: text(value) for key, value in data.attrs.items()
                      if key in ("units", "description")}
        attributes.update(_attributes(name) if name == "status" else {})
        lazy = indexing.LazilyIndexedArray(Stored(data))
        dimensions = ("time", "window")[:data.ndim]
        variables[name] = xarray.Variable(dimensions, lazy, attributes)
    coordinates = {"time": ("time", file["time"][:], {"units": "s"}),
                   "frame": ("time", file["frame"][:])}
    for name in ("x_px", "y_px"):
        if name in variables:
            coordinates[name] = variables.pop(name)
    made = xarray.Dataset(variables, coords=coordinates,
                          attrs={key: text(value) for key, value in file.attrs.items()
                                 if np.ndim(value) == 0})
    made.set_close(file.close)
    return made
