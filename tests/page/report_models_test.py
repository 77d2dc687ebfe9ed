#!/usr/bin/env python3
"""Reports of models: an impact that was simulated, and sweeps of them. IMPACTDIC_PROGRAM names the
program."""

import json
import tempfile
import unittest
from pathlib import Path

import numpy as np
from report_test import JOB, check_html, run

import impactdic
from impactdic.report import draw, models, page, tables
from impactdic.report.__main__ import Report
from impactdic.report.figure import Figure, Panel, Series


class Simulated(unittest.TestCase):
    """Impacts that were integrated, one alone and many."""

    @classmethod
    def setUpClass(cls):
        cls.scratch = tempfile.TemporaryDirectory()
        cls.folder = Path(cls.scratch.name)

    @classmethod
    def tearDownClass(cls):
        cls.scratch.cleanup()

    def simulate(self, job, name, text=""):
        path = self.folder / f"{name}.toml"
        path.write_text((JOB.parent / job).read_text() + text)
        run("simulate", "-q", path, "-o", self.folder / name)
        return impactdic.load(self.folder / name)

    def test_one_impact_shows_path_force_and_energy(self):
        result = self.simulate("racket_drop_15.toml", "drop")
        motion, force, energy = models.figures(result.folder, None, [])
        qn = motion.panels[0].series[1]  # Fig. 3.3
        self.assertAlmostEqual(np.min(qn.y), -3.476, 3)
        self.assertAlmostEqual(qn.x[np.argmin(qn.y)], 3.07, 2)
        vn = motion.panels[1].series[1]  # Fig. 3.4
        self.assertAlmostEqual(vn.y[0], -1.93, 2)
        self.assertAlmostEqual(vn.y[-1], 1.67, 2)
        loading, unloading = force.panels[1].series  # Fig. 3.5
        self.assertAlmostEqual(loading.y[-1], 46.53, 1)
        self.assertAlmostEqual(unloading.y[-1], 0, delta=0.5)
        parts = energy.panels[0].series
        total = sum(series.y for series in parts[:-1])
        np.testing.assert_allclose(total, parts[-1].y, rtol=1e-6)
        report = Report(result.folder, None)
        report.gather()
        self.assertRegex(report.first.sentence, r"^in 2\.00 m/s → out 1\.7\d m/s, spin 0 → \d+ rpm, "
                                                r"e 0\.8\d+, contact 6\.\d\d ms$")

    def test_phases_of_the_friction_are_shaded(self):
        result = self.simulate("wood_20_three_phase.toml", "wood")
        spans = models.figures(result.folder, None, [])[1].panels[0].spans  # Fig. 4.2
        self.assertEqual([span.name for span in spans], ["sliding", "sticking", "post sliding"])
        self.assertAlmostEqual(spans[1].start, 2.161, 3)

    def test_a_sweep_over_few_angles_is_curves(self):
        result = self.simulate("sweep_rod_rigid.toml", "rods")
        figure, = models.figures(result.folder, None, [])
        self.assertEqual(len(figure.panels[0].series), 3)
        curve = figure.panels[0].series[1]  # Fig. 5.8
        self.assertEqual((curve.name, len(curve.x)), ("angle of the rod 45 °", 15))
        table = result.columns("sweep")
        np.testing.assert_array_equal(curve.y, table["restitution"][15:30])

    def test_a_sweep_over_two_ranges_is_maps_with_contours(self):
        text = (JOB.parent / "sweep_wood.toml").read_text()
        head = text[:text.index("[sweep]")]
        path = self.folder / "map.toml"
        path.write_text(head + "[sweep]\nspeed_m_s = [1.0, 0.0, 0.0]\n"
                        "incidence_deg = {from = 5.0, to = 85.0, count = 9}\n"
                        "spin_ratio = {from = -1.0, to = 1.0, count = 11}\n")
        run("simulate", "-q", path, "-o", self.folder / "map")
        warnings = []
        slow, rebound = models.figures(self.folder / "map", None, warnings)
        surface = slow.panels[0].surface
        self.assertEqual(surface.z.shape, (11, 9))
        self.assertTrue(surface.contours and np.all(np.isfinite(surface.z)))
        # Maw, Barber and Fawcett: a contact point at rest stays at rest.
        points = rebound.panels[0].series[0]
        self.assertAlmostEqual(np.interp(0, points.x, points.y), 0, 2)
        slow.panels = slow.panels[:1]
        self.assertGreater(len(draw.drawn(slow).axes[0].texts), 3)  # values on the lines
        made = Report(self.folder / "map", None)
        made.gather()
        path = self.folder / "map.html"
        page.write(path, "Sweep", made.first, made.subtitle, made.warnings, made.figures, made.tables, made.texts)
        self.assertIn("198 failed", path.read_text())
        self.assertIn('"showlabels":true', path.read_text())
        check_html(self, path)

    def test_what_a_fit_leaves_is_drawn_over_the_time(self):
        folder = self.folder / "fit"
        folder.mkdir()
        rows = [f"{name},{i * 1e-4!r},{factor * (-1) ** i!r},{factor!r}"
                for name, factor in (("x_m", 2e-5), ("y_m", 1e-5), ("turn_rad", 1e-3))
                for i in range(50)]
        (folder / "residuals_0.csv").write_text("\n".join(["series,time_s,residual,sd", *rows]))
        track = folder / "shot" / "track.csv"
        track.parent.mkdir()
        track.write_text("\n".join(["time_s,x_m,y_m", "0,0.5,0.5"]
                                   + [f"{i * 1e-4!r},{1 + i * 1e-3!r},{2 - i * 1e-3!r}" for i in range(1, 60)]))
        (folder / "parameters.csv").write_text("track\na/track.csv\n")
        known = {"value": 2e-3, "sd": 1e-6}
        (folder / "summary.json").write_text(json.dumps({"version": "9.8.7", "parameters": {
            "stiffness_n_per_m": {"value": 12530.02, "sd": 5.43, "ci95": [1, 2], "determined": True},
            "friction_kinetic": {"value": 0.1, "sd": None, "ci95": [1, 2], "determined": False}},
            "shots": [{
                "shot": {"track": str(track), "contact_start_s": known, "contact_s": known},
                "reduced_chi_square": 1.0, "adequacy": "adequate"}]}))
        made = Report(folder, None)
        made.gather()
        self.assertEqual(made.first.sentence, "stiffness_n_per_m 12530.0 ± 5.4; not determined: "
                                              "friction_kinetic; the law is adequate")
        self.assertIn("impactdic 9.8.7", made.texts[-1][1])
        over, figure = models.figures(folder, None, [])
        seen, law = over.panels[0].series[2:]  # y
        np.testing.assert_allclose(seen.y[1:], 1500 - np.arange(1, 50))  # mm from the first frame on
        np.testing.assert_allclose(law.y - seen.y, 0.01 * (-1.0) ** np.arange(50), atol=1e-9)
        track.write_text("time_s,x_m,y_m\n0.5,1,1\n")  # another clip by now
        self.assertEqual(len(models.figures(folder, None, [])), 1)
        centre, turn, spread = figure.panels
        self.assertEqual([series.name for series in centre.series], ["x", "y"])
        np.testing.assert_allclose(np.abs(centre.series[0].y), 20)
        np.testing.assert_allclose(np.abs(turn.series[0].y), 1)
        self.assertEqual((centre.spans[0].start, centre.spans[0].end), (2.0, 4.0))
        # One deviation off everywhere: all in the bins of -1 and 1.
        found = spread.series[0]
        self.assertEqual(np.sum(found.y), 150)
        self.assertTrue(np.all(np.abs(np.abs(found.x[found.y > 0]) - 1) < 0.25))
        self.assertIn("adequate", figure.caption)

    def test_names_of_many_curves_have_room_below_their_axis(self):
        curves = [Series(f"law {k}", np.arange(2), np.arange(2)) for k in range(6)]
        shapes = [page._figure(Figure("f", "", "", [Panel("", "x", "y", curves[:count])]), {}) for count in (4, 5)]
        self.assertEqual(['"panel tall"' in shape for shape in shapes], [False, True])

    def test_a_formula_has_a_table_but_no_path(self):
        path = self.folder / "walton.toml"
        path.write_text('model = "walton"\n[body]\nmass_kg = 0.1\ndiameter_m = 0.06\n[contact]\n'
                        "restitution = 0.8\ntangential_restitution = 0.0\nfriction_kinetic = 0.2\n"
                        "[initial]\nvt_m_s = 1.0\nvn_m_s = -1.0\n")
        run("simulate", "-q", path, "-o", self.folder / "walton")
        self.assertEqual(models.figures(self.folder / "walton", None, []), [])
        rows = dict(tables.model_tables(impactdic.load(self.folder / "walton"))[0].rows)
        self.assertEqual(rows["restitution"], "0.8")


if __name__ == "__main__":
    unittest.main(verbosity=2)
