"""correlate: arrays in, a dataset out."""

import numpy as np
import pytest

import impactdic as idic
from conftest import program


@pytest.fixture(scope="module")
def pair():
    """A pattern that fills the picture, moved by (1.3, -0.7) px."""
    film, _ = idic.synth(frames=2, radius_px=300, size=(128, 128), velocity_px=(1.3, -0.7))
    return film


def test_two_pictures(pair):
    field = idic.correlate(pair[0], pair[1], window=21)
    assert field["u_px"].dims == ("window",)
    found = field["status"] == 0
    assert found.mean() > 0.9
    assert abs(float(field["u_px"].where(found).median()) - 1.3) < 0.005  # px; bias of the method
    assert abs(float(field["v_px"].where(found).median()) + 0.7) < 0.005
    assert abs(float(field["dx_px"]) - 1.3) < 0.005
    assert field["u_px"].attrs["units"] == "px"
    assert field["status"].attrs["flag_meanings"].split()[2] == "no_texture"


def test_the_same_bits_as_the_program(pair, tmp_path):
    film = np.concatenate([pair, pair[:1]])
    (tmp_path / "film.raw").write_bytes(film.tobytes())
    program("correlate", "-q", tmp_path / "film.raw", "--raw", "128x128x8", "-o", tmp_path / "out",
            "--window", 15, "--spacing", 16)
    wanted = idic.load(tmp_path / "out")
    field = idic.correlate(film, window=15, spacing=16)
    assert field.sizes["time"] == 2 and field["frame"].values.tolist() == [1, 2]
    stored = wanted.fields
    rows = np.flatnonzero(np.isin(stored["frame"], field["frame"]))
    for name in ("x_px", "u_px", "v_px", "u_sd_px", "correlation", "ux", "status"):
        ours = np.broadcast_to(field[name].values, (2, field.sizes["window"]))
        assert np.array_equal(ours, stored[name].values[rows], equal_nan=True), name
    assert np.array_equal(field["dx_px"], wanted.motion["dx_px"][1:])
    again = idic.correlate(film, window=15, spacing=16, out=tmp_path / "again")
    assert np.array_equal(again["u_px"], stored["u_px"], equal_nan=True)


def test_regions(pair):
    mask = np.zeros((128, 128), bool)
    mask[:, 64:] = True
    field = idic.correlate(pair[0], pair[1], mask=mask)
    on = field["status"] == 0
    assert on.any() and float(field["x_px"].where(on).min()) > 64
    field = idic.correlate(pair[0], pair[1], roi=(20, 20, 60, 60), spacing=10)
    assert float(field["x_px"].max()) < 80
    corners = [(20, 20), (100, 20), (60, 100)]
    assert (idic.correlate(pair[0], pair[1], polygon=corners)["status"] == 0).any()


@pytest.mark.parametrize("arguments, words", [
    ({"window": 3}, "window"),
    ({"mask": np.ones((5, 5), bool)}, "mask"),
    ({"against": "nothing"}, "nothing"),
    ({"polygon": [(1, 2)]}, "polygon"),
    ({"polygon": "all"}, "polygon"),
    ({"method": "magic"}, "magic"),
])
def test_a_wrong_request_is_refused(pair, arguments, words):
    with pytest.raises(idic.InvalidArgument, match=words):
        idic.correlate(pair[0], pair[1], **arguments)


def test_one_picture_is_refused(pair):
    with pytest.raises(idic.InvalidArgument, match="two frames"):
        idic.correlate(pair[:1])
    with pytest.raises(idic.InvalidArgument):
        idic.correlate(pair[0])
    with pytest.raises(idic.InvalidArgument, match="picture 1"):
        idic.correlate(pair[0], pair[1].astype(float))
