"""fields.h5: what it says of itself, and files of other schemas."""

import shutil

import h5py
import numpy as np
import pytest

import impactdic as idic
from conftest import program


@pytest.fixture
def folder(impact_shot, tmp_path):
    return shutil.copytree(impact_shot.folder, tmp_path / "shot")


def test_a_file_says_what_its_numbers_mean(folder):
    with h5py.File(folder / "fields.h5") as file:
        known = file.attrs
        assert known["schema_version"] == 1 and known["analysed_fps"] == 10000
        assert known["surface_angle_deg"] == 0 and 5e-4 < known["scale_m_per_px"] < 2e-3
        words = file["status"].attrs["flag_meanings"].decode().split()
        assert len(words) == len(file["status"].attrs["flag_values"]) == 7 and words[0] == "ok"
        group = file[known["default"].decode()]
        assert group.attrs["NX_class"] == b"NXdata" and "u_px_errors" in group


def test_an_older_schema_is_read(folder, impact_shot):
    with h5py.File(folder / "fields.h5", "r+") as file:
        del file["displacement"], file.attrs["schema_version"], file.attrs["default"]
        del file["status"].attrs["flag_meanings"], file["status"].attrs["flag_values"]
    old, new = idic.load(folder), impact_shot
    assert np.array_equal(old.fields["u_px"], new.fields["u_px"], equal_nan=True)
    assert old.fields["status"].attrs["flag_meanings"] == new.fields["status"].attrs["flag_meanings"]
    assert np.array_equal(old.field(3)["v_px"], new.field(3)["v_px"])


def test_a_newer_schema_and_other_files_are_refused(folder):
    with h5py.File(folder / "fields.h5", "r+") as file:
        file.attrs["schema_version"] = 2.0
    for read in (lambda shot: shot.fields, lambda shot: shot.field(3)):
        with pytest.raises(idic.ResultError, match="schema 2"):
            read(idic.load(folder))
    with h5py.File(folder / "fields.h5", "w") as file:
        file["time"] = [0.0]
    with pytest.raises(idic.ResultError, match="no frame"):
        idic.load(folder).fields
    (folder / "fields.h5").write_bytes(b"no hdf5")
    with pytest.raises(idic.ResultError, match="cannot read"):
        idic.load(folder).fields


def test_the_calibration_is_inside(tmp_path):
    program("synth", "-q", "-o", tmp_path / "clip", "--frames", 3, "--size", "128x128",
            "--radius-px", 30, "--velocity-px", "1,0.5")
    video, ruler = tmp_path / "clip" / "video.tif", tmp_path / "ruler.toml"
    program("calibrate", video, "--target", "ruler", "--marks", "20,50,120,50", "--pitch-mm", 60, "-o",
            ruler)
    shot = idic.track(video, camera=str(ruler), fps=1000)
    assert shot.fields.attrs["camera_calibration"] == ruler.read_text()
