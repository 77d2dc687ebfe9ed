"""synth, simulate, fit: the program's numbers."""

import json

import numpy as np
import pytest

import impactdic as idic
from conftest import BALL, IMPACT, SOURCE, program


def test_a_film_is_the_program_s(tmp_path):
    program("synth", "-q", "-o", tmp_path, "--force", "--frames", 6, "--radius-px", 25, "--size",
            "80x72", "--velocity-px", "0.5,0.25", "--rotation-deg", 3, "--noise", 2, "--bits", 12,
            "--seed", 5, "--blur", 0.8)
    film, truth = idic.synth(frames=6, radius_px=25, size=(80, 72), velocity_px=(0.5, 0.25),
                             spin_deg=(0, 0, 3), noise=2, bits=12, seed=5, blur=0.8)
    assert film.shape == (6, 72, 80) and film.dtype == np.uint16
    assert np.array_equal(film, np.asarray(idic.open(tmp_path / "video.tif")))
    stored = idic.read_table(tmp_path / "truth.csv")
    for name, values in stored.items():
        assert np.array_equal(truth[name], values, equal_nan=True), name


def test_a_sphere_s_truth(tmp_path):
    program("synth", "-q", "-o", tmp_path, "--force", "--body", "sphere", "--frames", 5,
            "--radius-px", 25, "--size", "80x80", "--spin-deg", "3,-2,1", "--distance", 40,
            "--velocity-px", "1,0,0.5")
    film, truth = idic.synth(frames=5, radius_px=25, size=(80, 80), spin_deg=(3, -2, 1),
                             distance=40, velocity_px=(1, 0, 0.5))
    assert np.array_equal(film, np.asarray(idic.open(tmp_path / "video.tif")))
    for name, values in idic.read_table(tmp_path / "truth.csv").items():
        # Turns are worked out of the same quaternions by other sums.
        assert np.allclose(truth[name], values, rtol=1e-12, atol=1e-12, equal_nan=True), name


def test_a_shell_swings_on():
    job = {"normal": "linear_spring_damper", "friction": "none",
           "body": {"mass_kg": 0.0567, "diameter_m": 0.067, "shape": "hollow_sphere"},
           "contact": {"stiffness_n_per_m": 35000.0},
           "shell": {"stiffness_n_per_m": 25000.0, "flat_fraction": 0.2},
           "initial": {"vn_m_s": -10.0}, "environment": {"gravity_m_s2": 0.0}}
    shell = idic.simulate(job)
    del job["shell"]
    # Two normal modes (as the verification's): what swings on is lost to the rebound.
    assert abs(shell["restitution"] - 0.926505041) < 1e-8
    assert abs(idic.simulate(job)["restitution"] - 1) < 1e-9
    assert shell["max_flattening_m"] > 0


def test_a_film_follows_poses_or_a_model(film):
    again, _ = idic.synth(poses={"cx_px": film[1]["cx_px"], "cy_px": film[1]["cy_px"],
                                 "angle_deg": 2.0 * np.arange(12)}, radius_px=40, size=(128, 128))
    assert np.array_equal(again, film[0])
    pushed, truth = idic.synth(simulate=IMPACT, radius_px=30, size=(96, 96), frames=60)
    assert len(pushed) == 60 and truth["compression"].max() > 0.01


@pytest.mark.parametrize("options, words", [
    ({"pattern": "z9"}, "pattern"),
    ({"speed": 3}, "speed"),
    ({"size": (0, 10)}, "size"),
    ({"size": "big"}, "size"),
    ({"velocity_px": 3}, "velocity_px"),
    ({"velocity_px": (np.nan, 1)}, "finite"),
    ({"spin_deg": (1, 2)}, "spin_deg"),
    ({"spin_deg": 1, "rotation_deg": 2}, "twice"),
    ({"spin_deg": 1, "simulate": IMPACT}, "twice"),
    ({"poses": {"cx_px": [1.0]}}, "cy_px"),
    ({"noise": -1}, "noise"),
    ({"bits": 20}, "bits"),
    ({"body": "cube"}, "body"),
])
def test_an_impossible_film_is_refused(options, words):
    with pytest.raises(idic.InvalidArgument, match=words):
        idic.synth(frames=2, **options)


def test_a_simulation_is_the_program_s(tmp_path):
    job = SOURCE / "sim" / "jobs" / "racket_30.toml"
    program("simulate", "-q", job, "-o", tmp_path / "out")
    stored = json.loads((tmp_path / "out" / "summary.json").read_text())
    impact = idic.simulate(job)
    for name in ("restitution", "contact_s", "max_deflection_m", "max_force_n"):
        assert impact[name] == stored[name], name
    assert impact["final"]["vn_m_s"] == stored["final"]["vn_m_s"]
    path = idic.read_table(tmp_path / "out" / "trajectory.csv")
    assert np.array_equal(impact.trajectory["normal_force_n"], path["normal_force_n"])
    assert "restitution" in repr(impact)
    times = idic.simulate(IMPACT, times_s=[0, 1e-3, 2e-3]).trajectory["time_s"]
    assert times.tolist() == [0, 1e-3, 2e-3]


def test_derivatives_are_those_of_the_outcome():
    impact = idic.simulate(IMPACT, derivatives=True)
    speed = IMPACT["initial"]["vn_m_s"]
    steps = [idic.simulate({**IMPACT, "initial": {**IMPACT["initial"], "vn_m_s": speed + step}})
             for step in (1e-4, -1e-4)]
    for name in ("restitution", "contact_s", "max_deflection_m"):
        expected = (steps[0][name] - steps[1][name]) / 2e-4
        assert impact.derivatives.loc[name, "initial.vn_m_s"] == pytest.approx(expected, rel=1e-5,
                                                                               abs=1e-7)
    assert idic.simulate(IMPACT).derivatives is None


@pytest.mark.parametrize("change, words", [
    ({"normal": "magic"}, "magic"),
    ({"colour": "red"}, "colour"),
    ({"body": {"mass_kg": -1, "diameter_m": 0.067}}, "mass_kg"),
    ({"body": 3}, "body"),
    ({"contact": {"stiffness": 3}}, "stiffness"),
    ({"initial": {"vn_m_s": float("nan")}}, "vn_m_s"),
])
def test_an_impossible_model_is_refused(change, words):
    with pytest.raises(idic.InvalidArgument, match=words):
        idic.simulate({**IMPACT, **change})


def test_jobs_in_files_that_are_none(tmp_path):
    with pytest.raises(idic.FileError, match="nowhere"):
        idic.simulate("/nowhere.toml")
    (tmp_path / "job.toml").write_text("normal = ")
    with pytest.raises(idic.InvalidArgument, match="TOML"):
        idic.simulate(tmp_path / "job.toml")


def test_a_fit_is_the_program_s(impact_shot, tmp_path):
    kept = impact_shot.save(tmp_path / "shot")
    (tmp_path / "fit.toml").write_text(f"""
tracks = ["{kept.folder}/track.csv"]
normal = "linear_spring_damper"
friction = "coulomb"
preset = "sound"
[body]
shape = "hollow_sphere"
mass_kg = 0.0567
diameter_m = 0.067
[contact]
friction_kinetic = 0.1
[fit]
method = "trajectory"
parameters = ["stiffness_n_per_m", "damping_n_s_per_m"]
rivals = true
""")
    program("fit", "-q", tmp_path / "fit.toml", "-o", tmp_path / "fit")
    stored = idic.load(tmp_path / "fit").summary
    fit = idic.fit([impact_shot], friction="coulomb", contact={"friction_kinetic": 0.1},
                   compare="all")
    told = {row["parameter"]: row for row in fit.shots[0]["parameters"]}
    for name, wanted in stored["shots"][0]["parameters"].items():
        assert told[name]["value"] == wanted["value"] and told[name]["sd"] == wanted["sd"], name
    assert abs(told["stiffness_n_per_m"]["value"] / 13385 - 1) < 0.05  # of a film of 30 px radius
    assert len(fit.rivals) > 3 and fit.rivals["above_best"].min() == 0
    assert fit.parameters["parameter"].tolist() == ["stiffness_n_per_m", "damping_n_s_per_m"]
    assert "stiffness" in repr(fit)
    alone = idic.load(tmp_path / "shot")
    with pytest.raises(idic.InvalidArgument, match="ball"):
        idic.fit(alone)
    assert idic.fit(alone, ball=BALL, friction="coulomb", contact={"friction_kinetic": 0.1}).shots


@pytest.mark.parametrize("options, words", [
    ({"model": "magic"}, "magic"),
    ({"compare": "some"}, "compare"),
    ({"parameters": ["luck"]}, "luck"),
    ({"speed": 1}, "speed"),
    ({"shots": []}, "no shot"),
    ({"ball": idic.Ball(diameter_mm=67)}, "mass_g"),
])
def test_an_impossible_fit_is_refused(impact_shot, options, words):
    with pytest.raises(idic.InvalidArgument, match=words):
        idic.fit(**{"shots": [impact_shot], **options})


def test_devices():
    devices = idic.devices()
    assert devices and {"index", "name", "platform", "driver", "is_gpu"} <= set(devices[0])
    assert idic.__version__ in program("--version").stdout
