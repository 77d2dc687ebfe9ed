"""Reads what the commands of impactdic write. A value that was not measured is NaN."""

import csv
import json
from functools import cached_property
from pathlib import Path

import numpy as np

from . import tables
from .errors import ResultError

try:
    import tomllib
except ImportError:  # before Python 3.11
    import tomli as tomllib


def read_table(path):
    """A CSV file as a dictionary of columns: arrays of float, or of text where a cell is none."""
    try:
        with open(path, newline="", encoding="utf-8") as file:
            rows = list(csv.reader(file))
    except OSError as error:
        raise ResultError("cannot read the table", path, error.strerror) from error
    except (UnicodeDecodeError, csv.Error) as error:
        raise ResultError("the table is no text", path, error) from error
    if not rows:
        raise ResultError("the table is empty", path)
    header, rows = rows[0], [row for row in rows[1:] if row]
    if any(len(row) != len(header) for row in rows):
        raise ResultError("a row has not as many cells as the header", path)
    return {name: _column([row[i] for row in rows]) for i, name in enumerate(header)}


def _plain(cell):
    """Without the apostrophe that keeps spreadsheets from running a text that begins like a formula."""
    return cell[1:] if cell[:1] == "'" and cell[1:].lstrip()[:1] in tuple("=+-@") else cell


def _column(cells):
    cells = [_plain(cell) for cell in cells]
    try:
        return np.array([float(cell) if cell else np.nan for cell in cells])
    except ValueError:
        return np.array(cells)


class Result:
    """The folder of one run; of `track`, `correlate`, `fit`, `compare` or `simulate`."""

    def __init__(self, folder):
        self.folder = Path(folder)
        if not self.folder.is_dir():
            raise ResultError("there is no such folder", folder)

    def __repr__(self):
        files = sorted(path.name for path in self.folder.glob("*.*") if path.is_file())
        return f"Result {self.name!r}: {', '.join(files) or 'no files'}"

    @property
    def name(self):
        return self.folder.resolve().name

    @cached_property
    def summary(self):
        """summary.json"""
        path = self.folder / "summary.json"
        try:
            return json.loads(path.read_text(encoding="utf-8"))
        except OSError as error:
            raise ResultError("cannot read the summary", path, error.strerror) from error
        except ValueError as error:
            raise ResultError("the summary is damaged", path, str(error)) from error

    @cached_property
    def job_text(self):
        """job.toml as it stands; empty where there is none."""
        path = self.folder / "job.toml"
        return path.read_text(encoding="utf-8") if path.exists() else ""

    @cached_property
    def job(self):
        """job.toml as a dictionary."""
        return tomllib.loads(self.job_text)

    def columns(self, name):
        """A table of the folder as a dictionary of arrays: "track", "pose", "motion", …"""
        return read_table(self.folder / f"{name}.csv")

    def table(self, name):
        """The same as a pandas.DataFrame, units in attrs["units"]."""
        return tables.frame(self.columns(name))

    @cached_property
    def track(self):
        """track.csv, one row a frame: a pandas.DataFrame, units in attrs["units"]."""
        return self.table("track")

    @cached_property
    def pose(self):
        """pose.csv: where the ball is and how far it has turned since the first frame."""
        return self.table("pose")

    @cached_property
    def motion(self):
        """motion.csv of `correlate`."""
        return self.table("motion")

    @cached_property
    def trajectory(self):
        """trajectory.csv of `simulate`."""
        return self.table("trajectory")

    @cached_property
    def fields(self):
        """fields.h5 as an xarray.Dataset (time, window); values are read when they are used."""
        from .fields import open_fields

        return open_fields(self.folder / "fields.h5")

    def field(self, frame):
        """The windows of one frame that were found, as a dictionary of arrays: x_px, y_px (their
        centres), u_px, v_px (displacement to the next frame), correlation and more."""
        from . import engine
        from .fields import open_file

        path = self.folder / "fields.h5"
        h5py = engine.package("h5py", "a displacement field")
        with open_file(path) as file:
            rows = np.flatnonzero(file["frame"][:] == frame)
            if len(rows) == 0:
                raise ResultError(f"there is no field of frame {frame}", path)
            row = int(rows[0])
            found = file["status"][row] == 0
            return {
                name: data[row][found]
                for name, data in file.items()
                if isinstance(data, h5py.Dataset) and data.ndim == 2 and name != "status"
            }

    @property
    def impact(self):
        """The impact of summary.json; None where there is none."""
        impact = self.summary.get("impact") or {}
        return impact if impact.get("found") else None

    @property
    def warnings(self):
        """What a person should check, one line each."""
        return list(self.summary.get("warnings") or [])


def load(folder):
    """The results in `folder`: a Shot of `track`, a Batch of `batch`, else a Result."""
    from .shot import Batch, Shot

    folder = Path(folder)
    if (folder / "shots.csv").exists():
        return Batch(folder)
    if (folder / "track.csv").exists():
        return Shot(folder)
    return Result(folder)


def shots_of(folder):
    """The results of every shot that `batch` measured into `folder`, in the order of shots.csv."""
    table = read_table(Path(folder) / "shots.csv")
    done = np.asarray(table["status"]) == "ok"
    names = [str(name) for name in np.asarray(table["shot"])[done]]
    for name in names:
        # A table that was tampered with must not lead out of its folder.
        if Path(name).name != name:
            raise ResultError(f"'{name}' is no name of a shot", Path(folder) / "shots.csv")
    return [load(Path(folder) / "shots" / name) for name in names]
