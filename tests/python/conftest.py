"""The package as a user has it. IMPACTDIC_PROGRAM names the program, IMPACTDIC_MODULE the folder of
the compiled part."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

SOURCE = Path(__file__).resolve().parents[2]
sys.dont_write_bytecode = True
sys.path[:0] = [str(SOURCE / "scripts"), os.environ["IMPACTDIC_MODULE"]]

import impactdic as idic  # noqa: E402

BALL = idic.Ball(diameter_mm=67, mass_g=56.7, inertia_factor=2 / 3)
FPS = 10000.0
# A tennis ball on a level surface.
IMPACT = {
    "normal": "linear_spring_damper", "friction": "coulomb", "preset": "sound",
    "body": {"shape": "hollow_sphere", "mass_kg": 0.0567, "diameter_m": 0.067},
    "contact": {"stiffness_n_per_m": 13385.0, "damping_n_s_per_m": 5.36, "friction_kinetic": 0.1},
    "initial": {"vt_m_s": -1.2, "vn_m_s": -3.0},
}


def program(*arguments, status=0):
    words = [os.environ["IMPACTDIC_PROGRAM"], *map(str, arguments)]
    done = subprocess.run(words, capture_output=True, text=True)
    assert done.returncode == status, done.stderr
    return done


@pytest.fixture(scope="session")
def film():
    """A small ball that flies and turns: (12, 128, 128), 8 bits, and its truth."""
    return idic.synth(frames=12, radius_px=40, size=(128, 128), velocity_px=(0.7, -0.4), spin_deg=2)


@pytest.fixture(scope="session")
def impact_film():
    """The impact above in 110 pictures."""
    return idic.synth(simulate=IMPACT, radius_px=30, size=(112, 112), fps=FPS)


@pytest.fixture(scope="session")
def impact_shot(impact_film):
    return idic.track(impact_film[0], BALL, fps=FPS)
