# %% [markdown]
# Two figures of the source from a result of impactdic: the path of the ball's centre in global and
# local axes (Fig. 3.16) and its velocity during the impact (Figs 2.12, 4.4).
#
#     scripts/demo
#     /usr/bin/python3 scripts/example_figures.py demo_out/impact/track
#
# A notebook opens this file as it is (jupytext); the cells begin with %%.

# %%
import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import impactdic

folder = Path(sys.argv[1] if len(sys.argv) > 1 else "demo_out/impact/track")
shot = impactdic.load(folder)
track, impact = shot.track, shot.summary["impact"]

# %% [markdown]
# Local axes: t along the surface, n out of it. `time_s` of a velocity is the middle between two
# frames, since a motion leads from one frame to the next.

# %%
slope = np.deg2rad(shot.summary["surface_angle_deg"])
t = np.cos(slope) * track["x_m"] + np.sin(slope) * track["y_m"]
n = np.cos(slope) * track["y_m"] - np.sin(slope) * track["x_m"]
middle_ms = 1e3 * (track["time_s"] + 0.5 / shot.summary["analysed_fps"])
start, turn, end = (1e3 * impact[key]["time_s"] for key in ("t0", "t_max_compression", "t_end"))

# %% Fig. 3.16
figure, (left, right) = plt.subplots(1, 2, figsize=(9, 4), layout="constrained")
left.plot(1e3 * track["x_m"], 1e3 * track["y_m"])
left.set(xlabel="x, mm", ylabel="y, mm", title="global axes", aspect="equal")
right.plot(1e3 * t, 1e3 * n)
right.set(xlabel="t, mm", ylabel="n, mm", title="local axes", aspect="equal")
figure.savefig(folder / "path.png", dpi=150)

# %% Figs 2.12 and 4.4
figure, axis = plt.subplots(figsize=(6, 4), layout="constrained")
axis.axvspan(start, turn, color="tab:blue", alpha=0.12, label="compression")
axis.axvspan(turn, end, color="tab:orange", alpha=0.12, label="restitution")
axis.plot(middle_ms, track["vt_m_s"], label="tangential")
axis.plot(middle_ms, track["vn_m_s"], label="normal")
axis.set(xlabel="time, ms", ylabel="velocity of the centre, m/s")
axis.legend()
figure.savefig(folder / "velocity.png", dpi=150)

# %%
e = impact["restitution"]
print(f"restitution {e['value']:.4f} ± {e['sd']:.4f}; figures in {folder}")
