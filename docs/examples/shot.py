"""A shot from film to finding: measured, looked at, calibrated, kept.

    python3 docs/examples/shot.py FOLDER
"""

import sys
from pathlib import Path

import impactdic as idic

BALL = idic.Ball(diameter_mm=67, mass_g=56.7, inertia_factor=2 / 3)
# A tennis ball that hits a level surface; in place of a camera's file.
IMPACT = {
    "normal": "linear_spring_damper",
    "friction": "coulomb",
    "body": BALL.body(),
    "contact": {"stiffness_n_per_m": 13385.0, "damping_n_s_per_m": 5.36, "friction_kinetic": 0.1},
    "initial": {"vt_m_s": -1.2, "vn_m_s": -3.0},
}


def main(folder: Path) -> None:
    film, _ = idic.synth(simulate=IMPACT, radius_px=45, size=(160, 160), fps=10000)
    shot = idic.track(film, BALL, fps=10000, surface_deg=0)
    print(shot)
    law = idic.simulate(IMPACT)
    print(f"restitution of the law that moved it: {law['restitution']:.4f}")
    fit = idic.fit([shot], friction="coulomb", contact={"friction_kinetic": 0.1})
    print(fit)
    shot.save(folder / "shot")
    shot.plot.velocity().savefig(folder / "velocity.png")
    shot.to_vtk(folder / "vtk")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
