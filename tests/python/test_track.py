"""track: the program's bits, partial results, callbacks."""

import os
import signal
import threading
import time

import numpy as np
import pytest

import impactdic as idic
from conftest import BALL, FPS, program


def table(path):
    return path.read_bytes()


def test_the_same_bits_as_the_program(film, tmp_path):
    program("synth", "-q", "-o", tmp_path / "clip", "--frames", 12, "--radius-px", 40, "--size",
            "128x128", "--velocity-px", "0.7,-0.4", "--rotation-deg", 2, "--format", "tiff")
    stored = idic.open(tmp_path / "clip" / "video.tif")
    assert np.array_equal(np.asarray(stored), film[0])
    options = ("--fps", 5000, "--ball-diameter-mm", 67, "--surface-angle-deg", 30)
    program("track", "-q", tmp_path / "clip" / "video.tif", "-o", tmp_path / "program", *options)
    ball = idic.Ball(diameter_mm=67)
    shot = idic.track(film[0], ball, surface_deg=30, fps=5000, out=tmp_path / "array")
    idic.track(stored, ball, surface_deg=30, fps=5000, out=tmp_path / "file")
    for name in ("track.csv", "pose.csv"):
        told = table(tmp_path / "program" / name)
        assert table(tmp_path / "array" / name) == told == table(tmp_path / "file" / name)
    wanted = idic.load(tmp_path / "program").fields
    for name in wanted.variables:
        assert np.array_equal(shot.fields[name].values, wanted[name].values, equal_nan=True), name
    truth = film[1]
    assert np.allclose(shot.track["dx_px"][:-1], truth["dx_px"][:-1], atol=0.005)  # of 0.0004 rms


def test_layouts_depths_and_parts_measure_the_same(film):
    options = {"radius_px": (35, 45), "window": 15}
    plain = idic.track(film[0], **options).track
    gaps = np.zeros((12, 128, 150), np.uint8)
    gaps[:, :, :128] = film[0]
    assert idic.track(gaps[:, :, :128], **options).track.equals(plain)
    assert idic.track(list(film[0]), **options).track.equals(plain)
    part = idic.track(idic.open(film[0])[2:9], **options).track
    assert part["frame"].tolist() == list(range(2, 9))
    named = idic.track(film[0], frames=slice(2, 9), **options).track
    assert part.equals(named)
    with pytest.raises(idic.InvalidArgument, match="twice"):
        idic.track(idic.open(film[0])[2:9], frames=(0, 3))


def test_frames_corrected_by_hand_are_marked(film):
    x, y = film[1]["cx_px"][4], film[1]["cy_px"][4]
    options = {"no_field": True, "polygon": [(0, 0), (149, 0), (149, 127), (0, 127)]}
    track = idic.track(film[0], ball_at={7: None, 4: (x + 2, y - 1, 39)}, **options).track
    assert track["by_hand"].tolist() == [0, 0, 0, 0, 1, 0, 0, 3, 0, 0, 0, 0]
    assert track["status"][7] == "no_ball" and np.isnan(track["cx_px"][7])
    assert np.hypot(track["cx_px"][4] - x, track["cy_px"][4] - y) < 0.05
    assert np.isnan(track["e1_px"][4])  # a free ball is round


def test_a_shot_says_what_it_found(impact_shot, tmp_path):
    figures = impact_shot.figures
    text, page = repr(impact_shot), impact_shot._repr_html_()
    assert figures["restitution"]["value"] == impact_shot.impact["restitution"]["value"]
    assert 0.5 < figures["restitution"]["value"] < 1
    for word in ("restitution", "friction", "vn_m_s_after", "omega_rad_s_before"):
        assert word in text and word in page
    assert impact_shot.track.attrs["units"]["vn_m_s"] == "m/s"
    assert impact_shot.track["frame"].dtype == np.int64
    kept = impact_shot.save(tmp_path / "kept")
    assert kept.track.equals(impact_shot.track) and kept.ball == BALL
    with pytest.raises(idic.InvalidArgument, match="force"):
        impact_shot.save(tmp_path / "kept")


def test_warnings_come_first(film):
    shot = idic.track(film[0], no_field=True)
    assert "no scale" in shot.warnings[0]
    assert "no scale" in repr(shot).splitlines()[1]


def test_figures_page_and_exports(impact_shot, tmp_path):
    matplotlib = pytest.importorskip("matplotlib")
    before = matplotlib.get_backend()
    for name in dir(impact_shot.plot):
        assert getattr(impact_shot.plot, name)().axes, name
    assert matplotlib.get_backend() == before
    with pytest.raises(AttributeError, match="velocity"):
        impact_shot.plot.nothing
    page = impact_shot.report(tmp_path / "page.html")
    assert "restitution" in page.read_text()
    assert not (impact_shot.folder / "figures").exists()


def test_vtk(impact_shot, tmp_path):
    import base64
    import xml.etree.ElementTree as tree

    series = impact_shot.to_vtk(tmp_path / "vtk")
    entries = tree.parse(series).findall(".//DataSet")
    assert len(entries) == len(impact_shot.fields["time"])
    fields, scale = impact_shot.fields.isel(time=1), impact_shot.summary["scale_m_per_px"]
    found = fields["status"].values == 0
    root = tree.parse(series.parent / entries[1].get("file"))
    assert float(entries[1].get("timestep")) == fields["time"]
    assert int(root.find(".//Piece").get("NumberOfPoints")) == found.sum() > 10

    def array(name, kind):
        node = next(n for n in root.iter("DataArray") if n.get("Name") == name)
        data = base64.b64decode(node.text)
        assert int.from_bytes(data[:8], "little") == len(data) - 8
        return np.frombuffer(data[8:], kind).reshape(-1, int(node.get("NumberOfComponents")))

    moved = array("displacement", "<f8")
    assert np.allclose(moved[:, 0], scale * fields["u_px"].values[found])
    assert np.allclose(moved[:, 1], -scale * fields["v_px"].values[found])
    assert np.allclose(array("points", "<f8")[:, 1], scale * (111 - fields["y_px"].values[found]))


def test_mat(impact_shot, tmp_path):
    io = pytest.importorskip("scipy.io")
    read = io.loadmat(impact_shot.to_mat(tmp_path / "shot.mat"), simplify_cells=True)
    assert np.array_equal(read["track"]["vn_m_s"], impact_shot.track["vn_m_s"], equal_nan=True)
    assert read["track"]["status"][0] == "ok"
    assert read["impact"]["restitution"]["value"] == impact_shot.figures["restitution"]["value"]
    assert read["fields"]["u_px"].shape == impact_shot.fields["u_px"].shape


def test_frames_come_as_they_are_measured(film):
    seen, told, steps = [], [], []
    shot = idic.track(film[0], on_frame=lambda *frame: seen.append(frame),
                      on_message=lambda kind, text: told.append((kind, text)),
                      progress=lambda phase, done, total: steps.append((phase, done, total)))
    rows = [row for row, _, _ in seen]
    assert [row["frame"] for row in rows] == list(range(12))
    assert [row["dx_px"] for row in rows[:-1]] == shot.track["dx_px"][:-1].tolist()
    _, picture, field = seen[3]
    assert np.array_equal(picture, film[0][3])
    stored = shot.fields.isel(time=3)
    assert np.array_equal(field["u_px"], stored["u_px"], equal_nan=True)
    assert steps[-1] == ("track", 12, 12)
    assert any(kind == "warning" and "no scale" in text for kind, text in told)


@pytest.mark.parametrize("name", ["on_frame", "on_message", "progress"])
def test_what_a_callback_raises_comes_out(film, name):
    def refuse(*_):
        raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        idic.track(film[0], **{name: refuse})


def long_clip(film, count=100000):
    """Many frames in little memory."""
    return np.lib.stride_tricks.as_strided(
        film, (count, *film.shape[1:]), (0, *film.strides[1:]), writeable=False)


@pytest.fixture(scope="module")
def large_picture():
    return idic.synth(frames=1, radius_px=300, size=(1024, 1024), velocity_px=(0.7, -0.4))[0]


def stopped(run):
    """What run(see) returns, whose Ctrl-C is pressed a third of a second after see was called: then
    work is under way. And the processor time until it came: a busy machine spends no more of it."""
    seen, pressed = threading.Event(), []

    def press():
        seen.wait(60)
        time.sleep(0.3)
        pressed.append(time.process_time())
        os.kill(os.getpid(), signal.SIGINT)

    before = signal.signal(signal.SIGINT, signal.default_int_handler)  # ignored in the background
    try:
        threading.Thread(target=press).start()
        with pytest.warns(idic.ResultWarning, match="stopped"):
            result = run(lambda *_: seen.set())
    finally:
        signal.signal(signal.SIGINT, before)
    return result, time.process_time() - pressed[0]


@pytest.mark.parametrize("size", [128, 1024])
def test_ctrl_c_returns_what_was_measured(film, large_picture, size):
    pictures = film[0] if size == 128 else large_picture
    clip = long_clip(pictures)
    shot, spent = stopped(lambda see: idic.track(clip, on_frame=see))
    assert shot.cancelled and 0 < len(shot.track) < 100000
    assert shot.track["status"].iloc[0] == "ok"
    assert spent < 1, spent  # s


def test_ctrl_c_stops_correlate(large_picture):
    clip = long_clip(large_picture)
    field, spent = stopped(lambda see: idic.correlate(clip, progress=see, spacing=5))
    assert 0 < field.sizes["time"] < 100000
    assert spent < 1, spent  # s


def test_a_handler_that_raises_is_heard(film):
    class Alarm(Exception):
        pass

    def ring(*_):
        raise Alarm

    before = signal.signal(signal.SIGALRM, ring)
    try:
        signal.setitimer(signal.ITIMER_REAL, 0.3)
        with pytest.raises(Alarm):
            idic.track(long_clip(film[0]))
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)


def test_other_threads_go_on(film):
    """Python counts while the engine measures in another thread; with the GIL held it could not."""
    done, counted = threading.Event(), 0

    def measure():
        idic.track(film[0])
        done.set()

    threading.Thread(target=measure).start()
    while not done.wait(0.001):
        counted += 1
    assert counted > 5


def test_threads_may_measure_at_once(film):
    results = [None] * 3

    def measure(k):
        results[k] = idic.track(film[0]).track

    threads = [threading.Thread(target=measure, args=(k,)) for k in range(3)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert all(result.equals(results[0]) for result in results)


def test_blocks_of_a_clip_without_end(film):
    whole = idic.track(film[0], fps=1000).track
    shots = list(idic.track_blocks(iter(film[0]), block=5, fps=1000))
    frames = np.concatenate([shot.track["frame"] for shot in shots])
    assert frames.tolist() == whole["frame"].tolist()
    times = np.concatenate([shot.track["time_s"] for shot in shots])
    assert np.allclose(times, whole["time_s"], rtol=0, atol=1e-12)
    # A block's first circles come from its own frames, and windows lie about them.
    dx = np.concatenate([shot.track["dx_px"] for shot in shots])
    assert (np.abs(dx - whole["dx_px"]) < 2 * whole["dx_sd_px"])[:-1].all() and np.isnan(dx[-1])


def test_a_clip_that_never_ends(film):
    taken = []

    def camera():
        while True:
            taken.append(len(taken))
            yield film[0][len(taken) % 12]

    shots = idic.track_blocks(camera(), block=5, no_field=True)
    last = [next(shots) for _ in range(3)][-1]
    assert last.track["frame"].tolist() == [8, 9, 10, 11]
    assert len(taken) <= 3 * 5 + 4  # pictures are asked for as they are needed
    shots.close()


@pytest.mark.parametrize("options, words", [
    ({"windows": 15}, "windows"),
    ({"window": 4}, "window"),
    ({"window": "wide"}, "window"),
    ({"window": 15.5}, "whole number"),
    ({"window": float("nan")}, "whole number"),
    ({"surface_deg": float("nan")}, "surface-angle"),
    ({"surface_deg": "steep"}, "number"),
    ({"mm_per_px": -1}, "mm-per-px"),
    ({"fps": -5}, "frame rate"),
    ({"roi": (0, 0, 10)}, "roi"),
    ({"roi": (0, 0, 1000, 1000)}, "roi"),
    ({"radius_px": (50, 40)}, "radius"),
    ({"ball_at": {3: (1, 2)}}, "ball_at"),
    ({"ball_at": {3: (1, 2, 0)}}, "None"),
    ({"ball_at": [3]}, "ball_at"),
    ({"ball_at": {30: None}}, "frame 30"),
    ({"polygon": [(0, 0), (9, 9)]}, "three corners"),
    ({"frames": (20, 30)}, "frames"),
    ({"frames": 3}, "frames"),
    ({"estimator": "guess"}, "guess"),
    ({"body": 1}, "body"),
    ({"no_field": 1}, "True or False"),
    ({"device": "no such device"}, "no such device"),
    ({"threads": -1}, "threads"),
    ({"progress": 3}, "progress"),
    ({"resume": True}, "resume"),
])
def test_a_wrong_request_is_one_clear_line(film, options, words):
    with pytest.raises(idic.InvalidArgument, match=words) as caught:
        idic.track(film[0], **options)
    assert "\n" not in str(caught.value)


def test_errors_have_the_program_s_words(film, tmp_path):
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "mine").write_text("x")
    program("synth", "-q", "-o", tmp_path / "clip", "--frames", 3, "--size", "64x64", "--radius-px", 20)
    told = program("track", tmp_path / "clip" / "video.tif", "-o", tmp_path / "out", status=2).stderr
    with pytest.raises(idic.InvalidArgument) as caught:
        idic.track(tmp_path / "clip" / "video.tif", out=tmp_path / "out")
    assert str(caught.value).split(":")[0] in told
    assert caught.value.where and caught.value.what in told


def test_a_run_goes_on(film, tmp_path):
    def stop(row, *_):
        if row["frame"] == 5:
            raise RuntimeError

    with pytest.raises(RuntimeError):
        idic.track(film[0], out=tmp_path / "shot", on_frame=stop)
    shot = idic.track(film[0], out=tmp_path / "shot", resume=True)
    assert shot.track.equals(idic.track(film[0]).track)


def test_results_go_with_the_shot(film):
    shot = idic.track(film[0], no_field=True)
    folder = shot.folder
    assert folder.exists()
    del shot
    assert not folder.exists()


def test_a_batch(film, tmp_path):
    for name in ("a", "b"):
        program("synth", "-q", "-o", tmp_path / name, "--frames", 3, "--size", "96x96", "--radius-px", 30)
        (tmp_path / "clips").mkdir(exist_ok=True)
        (tmp_path / name / "video.tif").rename(tmp_path / "clips" / f"{name}.tif")
    done = idic.batch(tmp_path / "clips", tmp_path / "out", BALL, fps=FPS)
    assert len(done) == 2 and [shot.name for shot in done] == ["a", "b"]
    again = idic.load(tmp_path / "out")
    assert isinstance(again, idic.Batch) and again.overview["status"].tolist() == ["ok", "ok"]
    assert repr(again).startswith("Batch 'out': 2 of 2 clips measured\n  ")
    assert "job.toml" in repr(idic.load(tmp_path / "a"))
    assert again[0].track.equals(idic.track(tmp_path / "clips" / "a.tif", BALL, fps=FPS).track)
