"""Every public function with what it cannot use: one clear line, no crash; and memory of any kind."""

import numpy as np
import pytest

import impactdic as idic
from conftest import BALL

PICTURES = {
    "floats": np.zeros((3, 64, 64)),
    "nan": np.full((3, 64, 64), np.nan, np.float32),
    "signed": np.zeros((3, 64, 64), np.int16),
    "one picture": np.zeros((64, 64), np.uint8),
    "colour": np.zeros((3, 64, 64, 3), np.uint8),
    "no frames": np.zeros((0, 64, 64), np.uint8),
    "no pixels": np.zeros((3, 64, 0), np.uint8),
    "objects": np.array([[["a"]]], dtype=object),
    "nothing": None,
    "a number": 3.5,
}


@pytest.mark.parametrize("kind", PICTURES)
@pytest.mark.parametrize("function", [idic.open, idic.track, idic.correlate])
def test_what_is_no_clip(function, kind):
    with pytest.raises(idic.InvalidArgument) as caught:
        function(PICTURES[kind])
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("kind", [kind for kind in PICTURES if kind not in ("nothing", "a number")])
def test_blocks_of_what_is_no_clip(kind):
    if len(PICTURES[kind]) == 0:
        assert list(idic.track_blocks(PICTURES[kind], no_field=True)) == []
        return
    with pytest.raises(idic.InvalidArgument):
        list(idic.track_blocks(PICTURES[kind], no_field=True))


def test_blocks_that_are_none(film):
    for pictures in (None, 7):
        with pytest.raises(idic.InvalidArgument, match="pictures"):
            list(idic.track_blocks(pictures))
    for block in (1, 0, -3, float("nan"), "many"):
        with pytest.raises(idic.InvalidArgument, match="block"):
            list(idic.track_blocks(film[0], block=block))
    changing = [film[0][0], film[0][1], film[0][2][:64]]
    with pytest.raises(idic.InvalidArgument, match="picture 2"):
        list(idic.track_blocks(iter(changing), block=3))


def layouts(film):
    locked = film.copy()
    locked.flags.writeable = False
    wide = np.zeros((*film.shape[:2], 160), np.uint8)
    wide[:, :, :128] = film
    return {"read-only": locked, "gaps": wide[:, :, :128], "columns first": np.asfortranarray(film),
            "list": list(film)}


@pytest.mark.parametrize("layout", ["read-only", "gaps", "columns first", "list"])
def test_memory_of_any_kind_correlates_the_same(film, layout):
    options = {"window": 15, "spacing": 20, "roi": (40, 40, 48, 48), "frames": (0, 3)}
    plain = idic.correlate(film[0], **options)
    assert idic.correlate(layouts(film[0])[layout], **options).equals(plain)


def test_batches_of_nothing(tmp_path):
    with pytest.raises(idic.InvalidArgument, match="no such folder"):
        idic.batch(tmp_path / "nowhere", tmp_path / "out", BALL)
    (tmp_path / "empty").mkdir()
    with pytest.raises(idic.Error, match="empty"):
        idic.batch(tmp_path / "empty", tmp_path / "out", BALL)
    with pytest.raises(idic.InvalidArgument, match="windows"):
        idic.batch(tmp_path / "empty", tmp_path / "out", BALL, windows=3)


def test_results_that_are_none(tmp_path):
    for read in (idic.load, idic.Result, idic.shots_of, idic.read_table):
        with pytest.raises(idic.ResultError, match="nowhere"):
            read(tmp_path / "nowhere")
    (tmp_path / "table.csv").write_text("a,b\n1\n")
    with pytest.raises(idic.ResultError, match="cells"):
        idic.read_table(tmp_path / "table.csv")
    (tmp_path / "table.csv").write_text("")
    with pytest.raises(idic.ResultError, match="empty"):
        idic.read_table(tmp_path / "table.csv")
    (tmp_path / "table.csv").write_bytes(b"a\n\xff\xfe\n")
    with pytest.raises(idic.ResultError, match="text"):
        idic.read_table(tmp_path / "table.csv")
    (tmp_path / "summary.json").write_text("{")
    with pytest.raises(idic.ResultError, match="damaged"):
        idic.load(tmp_path).summary


def test_exports_that_cannot_be(film, impact_shot, tmp_path):
    bare = idic.track(film[0][:3], no_field=True)
    with pytest.raises(idic.Error):
        bare.to_vtk(tmp_path / "vtk")
    (tmp_path / "file").write_text("")
    with pytest.raises(idic.ResultError, match="cannot write"):
        impact_shot.to_vtk(tmp_path / "file" / "vtk")
    with pytest.raises(idic.ResultError, match="cannot write"):
        impact_shot.report(tmp_path / "nowhere" / "page.html")
    pytest.importorskip("scipy")
    with pytest.raises(idic.ResultError, match="cannot write"):
        impact_shot.to_mat(tmp_path / "nowhere" / "shot.mat")


@pytest.mark.parametrize("values", [{}, {"diameter_mm": 67}, {"diameter_mm": 67, "mass_g": -1},
                                    {"diameter_mm": float("nan"), "mass_g": 1, "inertia_factor": 1}])
def test_balls_that_a_model_cannot_use(values):
    with pytest.raises(idic.InvalidArgument, match="ball"):
        idic.Ball(**values).body()
