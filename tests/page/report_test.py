#!/usr/bin/env python3
"""Python side of impactdic: results are loaded, figures say what the motion was, the page opens in
a browser. IMPACTDIC_PROGRAM names the program."""

import json
import os
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import numpy as np

SOURCE = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(SOURCE / "scripts"))
sys.dont_write_bytecode = True

import impactdic  # noqa: E402
from impactdic.report import figure, first, mass, models, shot, tables  # noqa: E402

PROGRAM = os.environ["IMPACTDIC_PROGRAM"]
JOB = SOURCE / "sim" / "jobs" / "racket_30.toml"
FRAMES, PX_M, FPS = 1000, 2.5e-4, 10000.0


def run(*arguments, status=0):
    done = subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True)
    if done.returncode != status:
        raise AssertionError(f"{arguments}: {done.returncode}, {done.stderr}")
    return done


def write_closed_form(folder):
    """A result of 1000 frames whose motion is known: a linear spring, half a sine of 5 ms."""
    time = np.arange(FRAMES) / FPS
    start, length, vn, vt, spin = 0.0473, 5e-3, -2.0, -0.8, 20.0
    phase = np.clip((time - start) / length, 0, 1) * np.pi
    y = np.where(time < start, vn * (time - start), vn * length / np.pi * np.sin(phase))
    y = np.where(time > start + length, -vn * (time - start - length), y)
    angle = np.where(time < start, 0, spin * (time - start))
    x = vt * time
    columns = {name: np.full(FRAMES, np.nan) for name in (
        "frame time_s status cx_px cy_px r_px cx_sd_px cy_sd_px r_sd_px dx_px dy_px rot_deg "
        "dx_sd_px dy_sd_px rot_sd_deg windows x_m y_m vx_m_s vy_m_s vt_m_s vn_m_s omega_rad_s "
        "vx_sd_m_s vy_sd_m_s omega_sd_rad_s").split()}
    columns |= {"frame": np.arange(FRAMES), "time_s": time, "cx_px": 400 + x / PX_M,
                "cy_px": 300 - y / PX_M, "r_px": np.full(FRAMES, 134.0), "x_m": x, "y_m": y}
    for name in ("cx_sd_px", "cy_sd_px", "r_sd_px", "dx_sd_px", "dy_sd_px", "rot_sd_deg"):
        columns[name] = np.full(FRAMES, 0.003)
    columns["dx_px"][:-1] = np.diff(x) / PX_M
    columns["dy_px"][:-1] = -np.diff(y) / PX_M
    columns["rot_deg"][:-1] = np.rad2deg(np.diff(angle))
    columns["windows"][:] = 300
    rows = [",".join(columns)]
    for i in range(FRAMES):
        cells = ("" if v != v else repr(float(v)) for v in (c[i] for c in columns.values()))
        rows.append(",".join("ok" if name == "status" else cell
                             for name, cell in zip(columns, cells)))
    folder.mkdir(parents=True)
    (folder / "track.csv").write_text("\n".join(rows) + "\n")
    instant = lambda t: {"frame": t * FPS, "sd_frames": 0.01, "time_s": t, "sd_s": 1e-6}  # noqa
    known = {"value": 1.0, "sd": 0.01}
    motion = {key: known for key in ("vx_m_s", "vy_m_s", "vt_m_s", "vn_m_s", "omega_rad_s")}
    (folder / "summary.json").write_text(json.dumps({
        "frames_analysed": FRAMES, "frames_by_status": {"ok": FRAMES}, "analysed_fps": FPS,
        "scale_m_per_px": PX_M, "surface_angle_deg": 0.0, "gravity_angle_deg": -90.0,
        "warnings": ["5 % of the frames are <saturated>"],
        "impact": {
            "found": True, "status": "found", "explanation": "impact found", "units": "si",
            "t0": instant(start), "t_max_compression": instant(start + length / 2),
            "t_end": instant(start + length), "before": motion, "after": motion,
            "restitution": known, "contact_s": known, "max_deflection_m": known,
            "friction": {key: known for key in ("eq_3_12", "gravity_corrected", "rolling_cap")},
            "impulse_closure": {"verdict": "signs", "explanation": "an axis is flipped"},
            "gravity": {"measured_m_s2": known, "agrees_with_9_81": True},
        }}))
    return vn, length


class Loader(unittest.TestCase):
    def test_unmeasured_is_nan_and_text_stays_text(self):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "table.csv"
            path.write_text("a,b\n1,ok\n,no_ball\n")
            table = impactdic.read_table(path)
        np.testing.assert_array_equal(table["a"], [1, np.nan])
        self.assertEqual(list(table["b"]), ["ok", "no_ball"])

    def test_what_is_wrong_is_said_in_a_line(self):
        with self.assertRaisesRegex(impactdic.ResultError, "no such folder"):
            impactdic.load("/nowhere")
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / "track.csv").write_text("a,b\n1\n")
            with self.assertRaisesRegex(impactdic.ResultError, "as many cells"):
                impactdic.load(folder).track
            with self.assertRaisesRegex(impactdic.ResultError, "cannot read the summary"):
                impactdic.load(folder).summary


class Figures(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scratch = tempfile.TemporaryDirectory()
        cls.folder = Path(cls.scratch.name) / "closed form"
        cls.vn, cls.length = write_closed_form(cls.folder)
        cls.made = {f.name: f for f in shot.figures(impactdic.load(cls.folder))}

    @classmethod
    def tearDownClass(cls):
        cls.scratch.cleanup()

    def test_velocity_and_spin_are_those_of_the_motion(self):
        vt, vn = self.made["velocity"].panels[1].series
        self.assertAlmostEqual(vn.y[100], self.vn, 9)
        self.assertAlmostEqual(vn.y[900], -self.vn, 9)
        self.assertAlmostEqual(vt.y[500], -0.8, 9)
        self.assertAlmostEqual(self.made["angular_velocity"].panels[0].series[0].y[900], 20, 9)

    def test_force_and_deflection_are_those_of_the_spring(self):
        loop = self.made["force_deflection"].panels[0].series[0]
        stiffness = (np.pi / self.length) ** 2  # over the mass
        self.assertAlmostEqual(np.max(loop.x), 1e3 * 2.0 * self.length / np.pi, 2)
        # The force of the spring and gravity's, which this motion does not show, both up.
        np.testing.assert_allclose(loop.y[5:-5], stiffness * 1e-3 * loop.x[5:-5] + 9.81, rtol=0.015)
        # One and the same way down and up: no energy is lost.
        area = np.sum(np.diff(loop.x) * (loop.y[1:] + loop.y[:-1]) / 2)
        self.assertLess(abs(area), 0.02 * np.max(loop.x) * np.max(loop.y))

    def test_phases_stand_where_the_impact_is(self):
        spans = self.made["position"].panels[0].spans
        self.assertAlmostEqual(spans[0].start, 47.3, 6)
        self.assertAlmostEqual(spans[1].end, 52.3, 6)

    def test_every_axis_has_a_unit(self):
        numbers = ("windows used", )  # have none
        for made in self.made.values():
            for panel in made.panels:
                x_label = set() if panel.x_names else {panel.x_label}
                for label in (x_label | {panel.y_label}).difference(numbers):
                    self.assertRegex(label, r", \S+$")

    def test_force_in_newtons_where_the_mass_is_known(self):
        result = impactdic.load(self.folder)
        over_mass = self.made["force_deflection"].panels[0]
        made = {f.name: f for f in shot.figures(result, mass_kg=0.05)}["force_deflection"].panels[0]
        self.assertTrue(over_mass.y_label.endswith("m/s²"))
        self.assertTrue(made.y_label.endswith(", N"))
        np.testing.assert_allclose(made.series[0].y, 0.05 * over_mass.series[0].y)
        self.assertIsNone(mass.of_shot(result, None))
        with tempfile.TemporaryDirectory() as batch:
            (Path(batch) / "shots" / "a").mkdir(parents=True)
            (Path(batch) / "shots.csv").write_text("shot,status,mass_g\nb,ok,1\na,ok,56.7\n")
            of_table = mass.of_shot(impactdic.Result(Path(batch) / "shots" / "a"), None)
        self.assertAlmostEqual(of_table, 0.0567)

    def test_ball_touches_the_surface_where_the_contact_starts(self):
        drawn = {s.name: s for s in self.made["trajectory"].panels[1].series}
        ball, surface = drawn["ball, contact starts"], drawn["surface"]
        self.assertAlmostEqual(np.min(ball.y), surface.y[0], 6)
        self.assertEqual(surface.y[0], surface.y[1])
        self.assertLess(surface.x[0], np.min(ball.x))

    def test_arrows_have_heads_at_their_ends(self):
        pairs = figure.arrow_pairs(np.array([1.0]), np.array([2.0]), np.array([3.0]), np.array([0.0]))
        x, y = figure.with_heads(*pairs)
        np.testing.assert_allclose(x, [1, 4, 3, 4, 3, np.nan])
        np.testing.assert_allclose(y, [2, 2, 1.5, 2, 2.5, np.nan])
        self.assertEqual([figure.round_below(v) for v in (0.3, 1, 7, 49)], [0.2, 1, 5, 20])
        self.assertEqual([figure.one_digit_below(v) for v in (1, 3.96, 49)], [1, 3, 40])

    def test_first_screen_says_what_happened(self):
        summary = impactdic.load(self.folder).summary
        self.assertEqual(first.sentence(summary), "in 1.41 m/s → out 1.41 m/s, spin 10 → 10 rpm, "
                                                  "e 1.000 ± 0.010, contact 1000 ms")
        self.assertEqual([(light.name, light.state) for light in first.lights(summary)],
                         [("closure", "bad"), ("gravity", "good"), ("scale", "good")])
        none = {"impact": {"found": False, "explanation": "nothing is hit"},
                "advice": {"windows": {"windows": 10, "usable": 5}}}
        self.assertEqual(first.sentence(none), "nothing is hit")
        self.assertEqual([(light.name, light.state) for light in first.lights(none)],
                         [("texture", "bad"), ("scale", "open")])

    def test_slope_has_the_deviation_of_least_squares(self):
        x = np.arange(9.0)
        value, sd = shot.slope(x, 3 * x + 1, np.full(9, 0.2), half=2)
        self.assertAlmostEqual(value[4], 3)
        self.assertAlmostEqual(sd[4], 0.2 / np.sqrt(10))
        self.assertTrue(np.isnan(value[1]))

    def test_rounding_follows_the_deviation(self):
        self.assertEqual(tables.rounded(0.863693, 0.00087367), "0.86369 ± 0.00087")
        self.assertEqual(tables.rounded(13384.97, 31.98), "13385 ± 32")
        self.assertEqual(tables.rounded(13384.97, 312.4), "13380 ± 310")
        self.assertEqual(tables.rounded(2.34567, 0.0999), "2.35 ± 0.10")
        self.assertEqual(tables.rounded(float("nan"), 1.0), "not measured")

    def test_spins_about_three_axes_are_shown(self):
        known = {"value": 12.34, "sd": 0.02}
        spin = {f"omega_{axis}_rad_s": known for axis in "tnb"}
        rows = dict(tables.space_rows(
            {"spin_before": spin, "spin_after": spin, "slip_t_m_s": known, "slip_b_m_s": known,
             "friction": None, "friction_off_slip_deg": known}, True))
        self.assertEqual(len(rows), 10)
        self.assertIn("12.34", rows["spin after about n"])
        self.assertNotIn("12", rows["friction as a vector, size"])
        self.assertEqual(tables.space_rows(None, True), [])

    def test_warnings_are_gathered(self):
        said = tables.warnings_of(impactdic.load(self.folder).summary)
        self.assertEqual(len(said), 2)
        self.assertIn("axis is flipped", said[1])

    def test_page_of_a_thousand_frames(self):
        run("report", "-q", self.folder)
        page = (self.folder / "report.html").read_text()
        self.assertLess(len(page.encode()), 8e6)
        self.assertIn("&lt;saturated&gt;", page)
        for name in self.made:
            for kind in ("png", "svg", "pdf"):
                path = self.folder / "figures" / f"{name}.{kind}"
                self.assertGreater(path.stat().st_size, 5000, path)
        check_html(self, self.folder / "report.html")


def check_html(test, page):
    if shutil.which("tidy") is None:
        test.skipTest("no tidy on this machine")
    said = subprocess.run(["tidy", "-e", "-q", page], capture_output=True, text=True).stderr
    test.assertEqual(said, "")


class Shot(unittest.TestCase):
    """A filmed impact, tracked, calibrated and compared with models."""

    @classmethod
    def setUpClass(cls):
        cls.scratch = tempfile.TemporaryDirectory()
        cls.folder = folder = Path(cls.scratch.name)
        run("synth", "-q", "--simulate", JOB, "--size", "200x200", "--radius-px", 55, "--frames",
            115, "--pattern", "e1", "-o", folder / "clip")
        run("track", "-q", folder / "clip" / "video.tif", "--fps", FPS, "--ball-diameter-mm", 67,
            "--surface-angle-deg", 30, "--inertia-factor", 0.667, "--overlay", "--slow-motion", 100,
            "--roi", "0,0,199,200", "-o", folder / "shot")
        (folder / "compare.toml").write_text("""
normal = "linear_spring_damper"
friction = "three_phase"
tracks = ["shot/track.csv"]
calibrate_on = ["shot/track.csv"]
models = ["coulomb", "three_phase"]
[body]
shape = "hollow_sphere"
mass_kg = 0.0567
diameter_m = 0.067
[contact]
friction_kinetic = 0.106767
friction_static = 0.2
[surface]
angle_deg = 30.0
[fit]
method = "trajectory"
parameters = ["stiffness_n_per_m", "damping_n_s_per_m"]
""")
        run("compare", "-q", folder / "compare.toml", "-o", folder / "shot" / "compare")
        cls.said = run("report", folder / "shot").stdout

    @classmethod
    def tearDownClass(cls):
        cls.scratch.cleanup()

    def test_folder_in_three_lines(self):
        result = impactdic.load(self.folder / "shot")
        self.assertEqual(len(result.track["vn_m_s"]), 115)
        self.assertAlmostEqual(result.impact["restitution"]["value"], 0.863, delta=0.01)
        field = result.field(frame=10)
        self.assertAlmostEqual(np.mean(field["u_px"]), result.track["dx_px"][10], delta=0.02)

    def test_frames_before_during_and_after(self):
        frames = impactdic.load(self.folder / "shot").summary["key_frames"]
        self.assertEqual([f["moment"] for f in frames], ["before", "during", "after"])
        made = {f.name: f for f in shot.figures(impactdic.load(self.folder / "shot"))}["frames"]
        self.assertEqual(len(made.panels), 6)
        self.assertEqual(made.panels[3].reference.text, "3 m/s")  # below 4 m/s
        squeezed = made.panels[4]  # its white surface reaches as far as its outline
        y, x = np.nonzero(squeezed.picture.grey == 255)
        outline = squeezed.series[0]
        self.assertEqual(outline.name, "ellipse")
        for angle in np.radians([0, 45, 90, 135, 180, 225, 270, 315]):
            white, drawn = (np.max(np.cos(angle) * px + np.sin(angle) * py) for px, py in (
                (x + squeezed.picture.x_px, y + squeezed.picture.y_px), (outline.x, outline.y)))
            self.assertAlmostEqual(white, drawn, delta=1.2)  # px; pixels are whole
        arrows = next(s for s in made.panels[3].series if s.kind == "arrows")
        down = np.nanmedian(arrows.y[1::3] - arrows.y[0::3])
        self.assertGreater(down, 3)  # towards the racket, y down, drawn longer than it is

    def test_overlay_says_phase_and_plays_slowly(self):
        import matplotlib.image

        ground = np.array([20, 20, 20]) / 255
        for frame in (5, 60):
            name = f"frame_{frame:06}.png"
            picture = matplotlib.image.imread(self.folder / "shot" / "overlay" / name)
            self.assertEqual(picture.shape[:2], (200, 198))
            np.testing.assert_allclose(picture[-1, 1, :3], ground, atol=1e-6)
        if shutil.which("ffprobe") is None:
            self.skipTest("no ffprobe on this machine")
        video = self.folder / "shot" / "overlay.mp4"
        said = subprocess.run(
            ["ffprobe", "-v", "error", "-count_frames", "-show_entries",
             "stream=width,height,r_frame_rate,nb_read_frames", "-of", "csv=p=0", video],
            capture_output=True, text=True, check=True).stdout
        # 10 000 frames/s played 100 times slower are 100 a second: every second one at 50.
        self.assertEqual(said.strip(), "198,200,50/1,58")

    def test_models_are_those_that_compare_ran(self):
        compared = impactdic.load(self.folder / "shot" / "compare")
        measured = compared.summary["shots"][0]
        for model in measured["models"]:
            path = models.integrate(compared, measured, model, PROGRAM)
            for key in ("vt_m_s", "vn_m_s"):
                self.assertAlmostEqual(path[key][-1], model["final"][key], 9)

    def test_shots_out_of_a_table_are_drawn_too(self):
        run("compare", "-q", JOB.parent / "compare_wood.toml", "-o", self.folder / "wood")
        warnings = []
        made = models.figures(self.folder / "wood", PROGRAM, warnings)
        self.assertEqual((len(made), warnings), (3, []))
        vt = made[0].panels[2].series  # Fig. 4.9
        self.assertEqual([s.name for s in vt], ["measured", "three_phase", "full_sliding", "brody"])
        self.assertAlmostEqual(vt[0].y[-1], 0.31, 2)
        self.assertLess(abs(vt[1].y[-1] - 0.26), 0.03)  # as printed for the three phases

    def test_page_in_a_browser(self):
        self.assertIn("figures", self.said)
        page = self.folder / "shot" / "report.html"
        text = page.read_text()
        for name in ("velocity", "trajectory", "frames", "models-compare", "force-deflection"):
            self.assertIn(f'id="{name}-1"', text)
        self.assertRegex(text, r'class="sentence">in 3\.9\d m/s → out 3\.\d\d m/s, spin 0 → 30\d rpm')
        self.assertEqual(text.count("<svg viewBox"), 3)
        self.assertEqual(text.count("<video"), 1)
        check_html(self, page)
        checker = SOURCE / "tests" / "support" / "check_page.py"
        done = subprocess.run([sys.executable, checker, page], capture_output=True, text=True)
        if done.returncode == 77:
            self.skipTest(done.stderr.strip())
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def test_wrong_requests(self):
        self.assertIn("no such folder", run("report", self.folder / "no", status=2).stderr)
        empty = self.folder / "empty"
        empty.mkdir()
        self.assertIn("nothing to report", run("report", empty, status=1).stderr)


if __name__ == "__main__":
    unittest.main(verbosity=2)
