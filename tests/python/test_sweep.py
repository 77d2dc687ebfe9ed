"""sweep: the program's numbers as arrays over the axes."""

import numpy as np
import pytest

import impactdic as idic
from conftest import IMPACT, program

JOB = """
normal = "linear_spring_damper"
friction = "coulomb"
preset = "sound"
[body]
shape = "hollow_sphere"
mass_kg = 0.0567
diameter_m = 0.067
[contact]
stiffness_n_per_m = 13385.0
damping_n_s_per_m = 5.36
[sweep]
speed_m_s = [2.0, 3.0]
incidence_deg = {from = 0.0, to = 60.0, count = 4}
friction_kinetic = [0.1, 0.3, 0.6]
"""


def test_a_sweep_is_the_program_s(tmp_path):
    (tmp_path / "job.toml").write_text(JOB)
    program("simulate", "-q", tmp_path / "job.toml", "-o", tmp_path / "out")
    stored = idic.load(tmp_path / "out").columns("sweep")
    made = idic.sweep(tmp_path / "job.toml", threads=1)
    assert made.sizes == {"speed_m_s": 2, "incidence_deg": 4, "friction_kinetic": 3}
    assert (made["status"] == 0).all() and set(stored["status"]) == {"ok"}
    for name in ("vn_before_m_s", "vt_after_m_s", "omega_after_rad_s", "restitution", "friction",
                 "tangential_restitution", "contact_s", "max_force_n", "lost"):
        assert np.array_equal(made[name].values.ravel(), stored[name], equal_nan=True), name
    assert made["phases"].values.ravel().tolist() == stored["phases"].tolist()
    assert made["vn_after_m_s"].attrs["units"] == "m/s"


def test_axes_in_arrays_are_those_of_single_impacts():
    job = {key: value for key, value in IMPACT.items() if key != "initial"}
    speeds = np.array([1.5, 3.0])
    made = idic.sweep(job, speed_m_s=speeds, omega_rad_s=0)
    assert made["speed_m_s"].values.tolist() == [1.5, 3.0] and made.sizes["omega_rad_s"] == 1
    for speed in speeds:  # along the normal
        alone = idic.simulate({**job, "initial": {"vt_m_s": 0.0, "vn_m_s": -speed}})
        shot = made.sel(speed_m_s=speed).isel(omega_rad_s=0)
        assert abs(shot["restitution"] - alone["restitution"]) < 1e-12
        assert shot["contact_s"] == alone["contact_s"]


def test_a_shot_that_fails_says_why():
    made = idic.sweep(IMPACT, friction_kinetic=[0.1, -1.0])
    assert made["status"].values.tolist() == [0, 2]
    assert "friction_kinetic" in str(made["reason"].values[1])
    assert np.isnan(made["restitution"].values[1])


@pytest.mark.parametrize("axes, words", [
    ({}, "nothing to sweep"),
    ({"speed": [1]}, "swept"),
    ({"speed_m_s": []}, "one or more"),
    ({"speed_m_s": [[1, 2]]}, "one or more"),
    ({"speed_m_s": [1, np.nan]}, "finite"),
    ({"speed_m_s": "fast"}, "numbers"),
    ({"speed_m_s": {"from": 1, "to": 2}}, "count"),
    ({"speed_m_s": np.ones(2000), "omega_rad_s": np.arange(600)}, "million"),
    ({"yield_strength_pa": [1e6]}, "swept"),
])
def test_an_impossible_sweep_is_refused(axes, words):
    with pytest.raises(idic.InvalidArgument, match=words):
        idic.sweep(IMPACT, **axes)
