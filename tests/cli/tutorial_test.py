#!/usr/bin/env python3
"""Runs every command of docs/tutorial.md, as it stands, in a folder that looks like a checkout that
was built. IMPACTDIC_PROGRAM names the program."""

import json
import os
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

SOURCE = Path(__file__).resolve().parents[2]


def blocks(language):
    text = (SOURCE / "docs" / "tutorial.md").read_text()
    return re.findall(rf"^```{language}\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)


class Tutorial(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scratch = tempfile.TemporaryDirectory()
        cls.folder = Path(cls.scratch.name)
        (cls.folder / "build" / "release").mkdir(parents=True)
        (cls.folder / "build/release/impactdic").symlink_to(os.environ["IMPACTDIC_PROGRAM"])
        for name in ("scripts", "sim"):
            (cls.folder / name).symlink_to(SOURCE / name)
        cls.said = ""
        for block in blocks("sh"):
            done = subprocess.run(["bash", "-euo", "pipefail", "-c", block], cwd=cls.folder,
                                  env=os.environ | {"PYTHONDONTWRITEBYTECODE": "1"},
                                  stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
            cls.said += done.stdout
            if done.returncode != 0:
                raise AssertionError(f"{block}\nended with {done.returncode}:\n{done.stdout}")

    @classmethod
    def tearDownClass(cls):
        cls.scratch.cleanup()

    def summary(self, of):
        return json.loads((self.folder / "tutorial" / of / "summary.json").read_text())

    def test_the_shot_is_what_the_truth_says(self):
        found, truth = self.summary("shot")["impact"], self.summary("truth")
        self.assertAlmostEqual(found["restitution"]["value"], truth["restitution"], delta=0.005)

    def test_the_broken_clip_is_put_aside(self):
        self.assertEqual(len(list((self.folder / "tutorial/results/shots").iterdir())), 7)
        self.assertEqual(len(list((self.folder / "tutorial/results/quarantine").iterdir())), 1)

    def test_the_fit_finds_what_was_filmed(self):
        parameters = self.summary("results/fit")["parameters"]
        for key, truth in (("stiffness_n_per_m", 13385.0), ("damping_n_s_per_m", 5.36)):
            self.assertTrue(parameters[key]["determined"], parameters[key])
            self.assertAlmostEqual(parameters[key]["value"] / truth, 1, delta=0.02)

    def test_the_page_shows_the_models(self):
        page = (self.folder / "tutorial/results/report.html").read_text()
        self.assertIn('id="models-compare-1"', page)
        self.assertNotIn("no curves of", page)

    def test_python_of_the_text(self):
        for block in blocks("python"):
            done = subprocess.run([sys.executable, "-c", block], cwd=self.folder, text=True,
                                  env=os.environ | {"PYTHONPATH": str(SOURCE / "scripts")},
                                  capture_output=True)
            self.assertEqual(done.returncode, 0, done.stderr)


if __name__ == "__main__":
    unittest.main(verbosity=2)
