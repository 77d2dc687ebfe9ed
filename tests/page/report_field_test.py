#!/usr/bin/env python3
"""The report of `correlate`, `study` and many shots: fields whose strain is known, tables whose errors are."""

import json
import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import h5py
import numpy as np

SOURCE = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(SOURCE / "scripts"))
sys.dont_write_bytecode = True

import impactdic  # noqa: E402
from impactdic.report import correlate, first, shots, study  # noqa: E402
from impactdic.report.__main__ import Report  # noqa: E402

PROGRAM = os.environ["IMPACTDIC_PROGRAM"]
SIDE, PITCH = 12, 20.0
STRETCH, SHEAR, TURN = 0.02, 0.01, np.deg2rad(30)  # of the last frame


def run(*arguments):
    return subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, check=True)


def gradient(share):
    """F - 1 of a stretch along x and a shear, then a turn, of which `share` is done."""
    c, s = np.cos(share * TURN), np.sin(share * TURN)
    return np.array([[c, -s], [s, c]]) @ np.array(
        [[1 + share * STRETCH, share * SHEAR], [0, 1]]) - np.eye(2)


def write_field(folder, frames=4):
    """As `correlate` writes it: the reference and frames of growing strain; one window masked, one
    not found."""
    y, x = (PITCH * a.ravel() for a in np.indices((SIDE, SIDE)))
    centre = np.array([x.mean(), y.mean()])
    names = "u_px v_px u_sd_px v_sd_px correlation ux uy vx vy".split()
    data = {name: np.zeros((frames, SIDE * SIDE), np.float32) for name in names}
    status = np.zeros((frames, SIDE * SIDE), np.uint8)
    status[0] = 1
    status[:, 0], status[1:, 1] = 1, 3
    for k in range(1, frames):
        f = gradient(k / (frames - 1))
        u, v = f @ np.array([x - centre[0], y - centre[1]])
        values = {"u_px": u, "v_px": v, "ux": f[0, 0], "uy": f[0, 1], "vx": f[1, 0], "vy": f[1, 1],
                  "correlation": 0.99, "u_sd_px": 0.01, "v_sd_px": 0.01}
        for name, value in values.items():
            data[name][k] = value
        data["u_px"][k, 1] = 1e6  # of a window that was not found: must show nowhere
    with h5py.File(folder / "fields.h5", "w") as file:
        file["frame"] = np.arange(frames)
        file["status"] = status
        for name, value in (("x_px", x), ("y_px", y)):
            file[name] = np.tile(value.astype(np.float32), (frames, 1))
        for name, value in data.items():
            file[name] = value
    rows = ["frame,time_s,status,dx_px,dy_px,rot_deg,dx_sd_px,dy_sd_px,rot_sd_deg,windows"]
    rows += [f"{k},{1e-3 * k},ok,{2.0 * k},0,{-10 * k},0.01,0.01,0.002,142" for k in range(frames)]
    (folder / "motion.csv").write_text("\n".join(rows) + "\n")
    (folder / "job.toml").write_text('command = "correlate"\nreference = "first"\n')
    (folder / "summary.json").write_text(json.dumps({
        "frames_analysed": frames, "frames_measured": frames - 1, "windows": SIDE * SIDE,
        "input": {"path": "a.tif"}, "warnings": ["one thing"],
        "advice": {"windows": {"windows": 144, "usable": 72}}}))


class OfCorrelate(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scratch = tempfile.TemporaryDirectory()
        cls.folder = Path(cls.scratch.name)
        write_field(cls.folder)
        cls.field = correlate.Field(impactdic.load(cls.folder))
        cls.made = {f.name: f for f in correlate.figures(cls.field)}

    @classmethod
    def tearDownClass(cls):
        cls.scratch.cleanup()

    def test_strain_is_that_of_the_stretch_whatever_the_turn(self):
        f = np.eye(2) + gradient(1)
        strain = (f.T @ f - np.eye(2)) / 2
        self.assertAlmostEqual(strain[0, 0], STRETCH + STRETCH**2 / 2, 12)
        maps = [panel.surface.z for panel in self.made["strain_field"].panels]
        for seen, meant in zip(maps, (strain[0, 0], strain[1, 1], strain[0, 1])):
            np.testing.assert_allclose(seen[np.isfinite(seen)], meant, atol=1e-6)
        over_time = self.made["field_over_time"].panels[0].series
        self.assertAlmostEqual(over_time[0].y[-1], strain[0, 0], 6)

    def test_maps_lie_on_the_grid_and_leave_out_what_was_not_found(self):
        u = self.made["displacement_field"].panels[0].surface
        self.assertEqual(u.z.shape, (SIDE, SIDE))
        self.assertTrue(np.isnan(u.z[0, 0]) and np.isnan(u.z[0, 1]))
        self.assertEqual(np.isnan(u.z).sum(), 2)
        f = gradient(1)
        x, y = u.x[5] - u.x.mean(), u.y[7] - u.y.mean()
        self.assertAlmostEqual(u.z[7, 5], f[0, 0] * x + f[0, 1] * y, 3)
        arrows = self.made["displacement_field"].panels[2]
        shown = arrows.reference.length / float(arrows.reference.text.split()[0])
        lengths = np.hypot(np.diff(arrows.series[0].x)[::3], np.diff(arrows.series[0].y)[::3])
        self.assertAlmostEqual(np.max(lengths) / shown, np.nanmax(arrows.surface.z), delta=0.1)

    def test_page_says_what_happened(self):
        report = Report(self.folder, None)
        report.gather()
        self.assertRegex(report.first.sentence, r"3 of 4 frames measured, windows moved by up to "
                                                r"\d+\.\d px \(frame 3\), turned by -30.0000 ± 0.0020°, "
                                                r"median strain up to 0.020")
        self.assertEqual([(light.name, light.state) for light in report.first.lights],
                         [("texture", "bad"), ("windows", "good")])
        self.assertEqual(report.warnings, ["one thing"])

    def test_noise_floor_and_metres_stand_on_the_page(self):
        with tempfile.TemporaryDirectory() as folder:
            folder = Path(folder)
            write_field(folder)
            names = ",dx_m,dy_m,plane_rot_deg,dx_sd_m,dy_sd_m,plane_rot_sd_deg"
            header, *rows = (folder / "motion.csv").read_text().split()
            rows = [f"{row},{3e-4 * k},{4e-4 * k},0,2e-7,2e-7,0" for k, row in enumerate(rows)]
            (folder / "motion.csv").write_text("\n".join([header + names, *rows]) + "\n")
            summary = json.loads((folder / "summary.json").read_text())
            floor = {"frames": [0, 9], "spatial_sd_px": [0.004, 0.003],
                     "temporal_sd_px": [0.003, 0.003], "stated_sd_px": [0.0035, 0.0035]}
            for factor, state in ((1, "good"), (2, "bad")):
                floor["spatial_sd_px"] = [0.004 * factor, 0.003 * factor]
                (folder / "summary.json").write_text(json.dumps(summary | {"noise_floor": floor}))
                report = Report(folder, None)
                report.gather()
                light = report.first.lights[-1]
                self.assertEqual((light.name, light.state), ("noise floor", state))
            self.assertIn("still frames 0 to 9", light.why)
            self.assertIn("the region by 1.50000 ± 0.00020 mm in the plane", report.first.sentence)

    def test_damaged_field_is_said_in_a_line(self):
        with tempfile.TemporaryDirectory() as folder:
            write_field(Path(folder))
            (Path(folder) / "fields.h5").write_bytes(b"no HDF5")
            with self.assertRaisesRegex(impactdic.ResultError, "cannot read the displacement"):
                Report(Path(folder), None).gather()


class OfShots(unittest.TestCase):
    def test_means_never_mix_balls_or_surfaces(self):
        rows = [("ok", "red", 30, 0.80, ""), ("ok", "red", 30, 0.84, ""), ("ok", "blue", 30, 0.5, ""),
                ("ok", "red", 0, 0.9, ""), ("failed", "red", 30, np.nan, ""),
                ("ok", "red", 30, 0.1, "restitution")]
        names = ("status", "ball", "surface_angle_deg", "restitution", "doubtful")
        table = {name: np.array(column) for name, column in zip(names, zip(*rows))}
        self.assertEqual(first.sentence_of_shots(table),
                         "e 0.5 blue at 30° (1 shot), e 0.9 red at 0° (1 shot), "
                         "e 0.820 ± 0.020 red at 30° (2 shots), 1 in doubt and left out")
        table["restitution"] = np.full(len(rows), np.nan)
        self.assertEqual(first.sentence_of_shots(table), "")

    @staticmethod
    def table(rows):
        """shots.csv of (shot, ball, diameter in mm, angle, restitution, drop height in mm)."""
        names = "shot ball ball_diameter_mm surface_angle_deg restitution drop_height_mm".split()
        table = {name: np.array(column) for name, column in zip(names, zip(*rows))}
        for name in ("restitution_sd friction friction_sd friction_eq_3_12 rolling_cap contact_s "
                     "contact_sd_s max_deflection_m max_deflection_sd_m omega_after_rad_s "
                     "omega_after_sd_rad_s vt_before_m_s").split():
            table[name] = np.zeros(len(rows))
        table["vn_before_m_s"] = np.full(len(rows), -2.0)
        table["status"], table["doubtful"] = np.full(len(rows), "ok"), np.full(len(rows), "")
        return table

    def test_figures_never_mix_balls_nor_count_what_was_left_out(self):
        table = self.table([("a", "red", 67, 0, 0.80, 204.0), ("b", "red", 67, 0, 0.84, np.nan),
                            ("c", "blue", 40, 0, 0.5, 204.0), ("d", "red", 67, 0, 0.1, 204.0),
                            ("e", "red", 67, 15, 0.7, np.nan)])
        made = {f.name: f for f in shots.figures(table, [], {"d": "hit the frame"})}
        against_speed, against_angle = made["restitution"].panels
        self.assertEqual([s.name for s in against_speed.series], ["blue: 0°", "red: 0°", "red: 15°"])
        self.assertEqual([s.labels for s in against_speed.series], [["c"], ["a", "b"], ["e"]])
        blue, red = against_angle.series
        self.assertEqual((blue.name, red.name), ("blue: mean", "red: mean"))
        np.testing.assert_allclose(blue.y, [0.5, np.nan])
        np.testing.assert_allclose(red.y, [0.82, 0.7])
        np.testing.assert_allclose(red.sd, [0.02, np.nan])  # the scatter over the root of two
        table["restitution_sd"][:3] = 0.03, 0.04, 0.01  # their own say more than so few shots' scatter
        made = {f.name: f for f in shots.figures(table, [], {"d": "hit the frame"})}
        blue, red = made["restitution"].panels[1].series
        self.assertAlmostEqual(red.sd[0], 0.025)  # the root of 0.03² + 0.04², over two
        self.assertAlmostEqual(blue.sd[0], 0.01)
        self.assertIn("e 0.500 ± 0.010 blue at 0° (1 shot), e 0.820 ± 0.025 red at 0° (2 shots)",
                      first.sentence_of_shots(table, {"d": "hit the frame"}))
        table["restitution_sd"][:] = 0
        drop = made["drop"].panels[0].series
        self.assertEqual([s.labels for s in drop[:2]], [["c"], ["a"]])
        np.testing.assert_allclose(drop[0].x, np.sqrt(2 * 9.81 * 0.204))
        np.testing.assert_allclose(drop[0].y, 2)
        self.assertEqual(first.sentence_of_shots(table, {"d": "hit the frame"}),
                         "e 0.5 blue at 0° (1 shot), e 0.820 ± 0.020 red at 0° (2 shots), "
                         "e 0.7 red at 15° (1 shot), 1 left out by hand")

    def test_balls_without_a_name_are_told_apart_by_what_is_known_of_them(self):
        table = self.table([("a", "", 67, 0, 0.80, np.nan), ("b", "", 40, 0, 0.5, np.nan)])
        self.assertEqual([s.name for s in shots.figures(table, [])[0].panels[0].series],
                         ["40 mm: 0°", "67 mm: 0°"])
        self.assertEqual(first.sentence_of_shots(table),
                         "e 0.5 40 mm at 0° (1 shot), e 0.8 67 mm at 0° (1 shot)")


class OfClip(unittest.TestCase):
    def test_what_info_says_stands_on_the_page(self):
        with tempfile.TemporaryDirectory() as name:
            root, folder = Path(name), Path(name) / "said"
            run("synth", "-q", "-o", root / "clip", "--frames", 8, "--size", "160x150", "--radius-px", 36,
                "--pattern", "f1", "--velocity-px", "2,1", "--fps", 5000, "--format", "cine")
            said = run("info", root / "clip" / "video.cine", "--candidates", "-o", folder).stdout
            again = subprocess.run([PROGRAM, "info", root / "clip" / "video.cine", "-o", folder],
                                   capture_output=True, text=True)
            self.assertEqual((again.returncode, again.stderr.count("\n")), (2, 1))
            self.assertIn("--force", again.stderr)
            report = Report(folder, None)
            report.gather()
            rows = report.tables[0].rows
            self.assertEqual([" ".join(row).split() for row in rows],
                             [line.split() for line in said.splitlines() if not line.startswith("warning")])
            for row in (["size", "160 x 150 px, 8 bit"], ["post_trigger_frames", "0"], ["recorded_frames", "8"]):
                self.assertIn(row, rows)
            self.assertRegex(report.first.sentence, r"160 × 150 px, 8 bits, 8 frames at 5000 1/s; a ball of "
                                                    r"radius \d\d\.\d px; windows of 15 px are expected to err by 0")
            self.assertEqual([(light.name, light.state) for light in report.first.lights],
                             [("ball", "good"), ("texture", "good")])
            [seen] = json.loads((folder / "summary.json").read_text())["candidates"]
            self.assertEqual([key.title for key in report.first.pictures],
                             ["first, frame 0", "middle, frame 3", "last, frame 7",
                              f"candidate 1, frame {seen['frame']}"])
            outline = report.first.pictures[-1].outline
            truth = np.genfromtxt(root / "clip" / "truth.csv", delimiter=",", names=True,
                                  dtype=None, encoding=None)[seen["frame"]]
            self.assertAlmostEqual(outline.x, truth["cx_px"], delta=1)
            self.assertAlmostEqual(outline.long, 36, delta=1)
            self.assertIn("candidate 1      radius 36.", said)
            error = report.figures[0].panels[0].series[0]
            self.assertTrue((np.diff(error.x) > 0).all() and (error.y > 0).all())
            report.write_page()
            page = (folder / "report.html").read_text()
            self.assertIn("Phantom cine", page)
            self.assertIn("middle, frame 3</figcaption>", page)


class OfTables(unittest.TestCase):
    def test_any_table_over_time_is_drawn_by_units(self):
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            (folder / "truth.csv").write_text("frame,time_s,status,cx_px,cy_px,rot_deg\n"
                                              "0,0,ok,10,20,1.5\n1,0.001,ok,11,,1.5\n")
            (folder / "job.toml").write_text('command = "synth"\n')
            report = Report(folder, None)
            report.gather()
        panels = report.figures[0].panels
        self.assertEqual([(p.x_label, p.y_label) for p in panels], [("time, ms", "px"), ("time, ms", "deg")])
        self.assertEqual([s.name for s in panels[0].series], ["cx_px", "cy_px"])
        np.testing.assert_allclose(panels[0].series[0].y, [10, 11])
        np.testing.assert_allclose(panels[0].series[0].x, [0, 1])
        self.assertEqual(report.first.sentence, "impactdic synth: 2 rows in truth.csv")

    def test_nothing_to_report_is_said(self):
        with tempfile.TemporaryDirectory() as name:
            with self.assertRaisesRegex(impactdic.ResultError, "nothing to report"):
                Report(Path(name), None).gather()


class OfStudy(unittest.TestCase):
    def test_figures_hold_the_errors_of_the_table(self):
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            (folder / "patterns.csv").write_text(
                "pattern,motion,dx_px,dy_px,rot_deg,estimator,dx_abs_px,dy_abs_px,rot_abs_deg\n"
                "a1,x,1,0,0,ball,0.01,0.02,0.03\na1,x,1,0,0,icgn5,0.04,0,0.06\n"
                "e1,x,1,0,0,ball,0.001,0.002,0.003\n")
            (folder / "density.csv").write_text("points,method,us_per_window,rms_px\n"
                                                "0,icgn,5,0.01\n1,icgn,5,0.01\n")
            (folder / "summary.json").write_text(json.dumps({
                "finding": "Paint e1.",
                "estimators": {"ball": {"all": {"motion_rms_px": 0.0123, "pairs_failed": 1}}}}))
            report = Report(folder, None)
            report.gather()
        made = {f.name: f for f in report.figures}
        self.assertEqual(sorted(made), ["study_density", "study_x"])
        ball, icgn = made["study_x"].panels[0].series
        np.testing.assert_allclose(ball.y, [0.01, 0.001])
        np.testing.assert_allclose(np.round(ball.x), [0, 1])
        self.assertEqual(made["study_x"].panels[1].series[1].y[0], study.FLOOR)
        self.assertEqual(made["study_x"].panels[0].x_names, ["a1", "e1"])
        self.assertEqual(report.first.sentence, "Paint e1.")
        self.assertEqual(report.tables[0].rows, [["ball", "0.012", "", "", "1"]])


if __name__ == "__main__":
    unittest.main(verbosity=2)
