"""Results in the formats of other programs."""

import base64
from pathlib import Path
from xml.sax.saxutils import quoteattr

import numpy as np

from . import engine
from .errors import InvalidArgument, ResultError

_TYPES = {"f": "Float32", "d": "Float64", "b": "Int8", "B": "UInt8", "i": "Int32", "q": "Int64",
          "l": "Int64"}


def _binary(name, values, components=1):
    """A DataArray of VTK's XML: little-endian, base64, behind its length in bytes."""
    values = np.ascontiguousarray(values)
    data = values.astype(values.dtype.newbyteorder("<"), copy=False).tobytes()
    text = base64.b64encode(np.uint64(len(data)).astype("<u8").tobytes() + data).decode()
    return (f'<DataArray type="{_TYPES[values.dtype.char]}" Name={quoteattr(name)} '
            f'NumberOfComponents="{components}" format="binary">{text}</DataArray>')


def _points_file(path, points, columns):
    """Windows as points of a .vtp file."""
    count = len(points)
    data = "".join(_binary(name, values, 1 if values.ndim == 1 else values.shape[1])
                   for name, values in columns.items())
    corners = _binary("connectivity", np.arange(count, dtype=np.int64))
    offsets = _binary("offsets", np.arange(1, count + 1, dtype=np.int64))
    path.write_text(
        '<?xml version="1.0"?>\n<VTKFile type="PolyData" version="1.0" byte_order="LittleEndian" '
        f'header_type="UInt64"><PolyData><Piece NumberOfPoints="{count}" NumberOfVerts="{count}" '
        'NumberOfLines="0" NumberOfStrips="0" NumberOfPolys="0">'
        f'<PointData Vectors="displacement">{data}</PointData>'
        f'<Points>{_binary("points", points, 3)}</Points><Verts>{corners}{offsets}</Verts>'
        "</Piece></PolyData></VTKFile>\n", encoding="ascii")


def to_vtk(shot, folder):
    """Writes fields_NNNNNN.vtp, one a frame, and fields.pvd, which plays them in ParaView with the
    track's clock. Axes: x right, y UP (VTK's), in metres where the scale is known, else px. Windows
    that were not found are left out. Point data: displacement (3), displacement_sd (2), correlation.
    Returns the path of fields.pvd. Raises ResultError, InvalidArgument."""
    folder = Path(folder)
    fields = shot.fields
    if "u_px" not in fields:
        raise InvalidArgument("the results have no displacement field", shot.folder)
    scale = shot.summary.get("scale_m_per_px") or 1.0
    height = (shot.summary.get("input") or {}).get("height_px") or 1
    try:
        folder.mkdir(parents=True, exist_ok=True)
        entries = []
        for row, (frame, time) in enumerate(zip(fields["frame"].values, fields["time"].values)):
            one = fields.isel(time=row)
            found = one["status"].values == 0
            x, y, u, v, u_sd, v_sd, correlation = (
                one[name].values[found] for name in ("x_px", "y_px", "u_px", "v_px", "u_sd_px",
                                                     "v_sd_px", "correlation"))
            flat = np.zeros(len(x))
            points = scale * np.column_stack([x, height - 1 - y, flat])
            columns = {"displacement": scale * np.column_stack([u, -v, flat]),
                       "displacement_sd": scale * np.column_stack([u_sd, v_sd]),
                       "correlation": correlation}
            name = f"fields_{int(frame):06d}.vtp"
            _points_file(folder / name, points, columns)
            entries.append(f'<DataSet timestep="{float(time)!r}" file="{name}"/>')
        series = folder / "fields.pvd"
        series.write_text('<?xml version="1.0"?>\n<VTKFile type="Collection" version="1.0" '
                          'byte_order="LittleEndian"><Collection>' + "".join(entries) +
                          "</Collection></VTKFile>\n", encoding="ascii")
    except OSError as error:
        raise ResultError("cannot write", folder, error.strerror) from error
    return series


def to_mat(shot, path):
    """Writes a MAT file of version 5: `track` and `pose` (a struct of columns), `fields` (a struct
    of arrays, time x window), `impact` (figures with value and sd), `units`. Returns the path."""
    io = engine.package("scipy.io", "a MAT file")

    def table(columns):
        return {name: values if values.dtype.kind != "U" else values.astype(object)
                for name, values in columns.items()}

    contents = {"schema": 1.0, "track": table(shot.columns("track"))}
    if (shot.folder / "pose.csv").exists():
        contents["pose"] = table(shot.columns("pose"))
    if (shot.folder / "fields.h5").exists():
        fields = shot.fields
        contents["fields"] = {name: fields[name].values for name in fields.variables}
    contents["impact"] = {key: {part: np.nan if value is None else value
                                for part, value in figure.items()}
                          for key, figure in shot.figures.items()}
    contents["warnings"] = np.array(shot.warnings, dtype=object)
    path = Path(path)
    try:
        io.savemat(path, contents, long_field_names=True, oned_as="column")
    except OSError as error:
        raise ResultError("cannot write", path, error.strerror) from error
    return path
