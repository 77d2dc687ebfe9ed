"""The examples, built against the installed tree alone, say what the program says."""

import csv
import os
import json
import re
import shutil
import unittest

import h5py

from installed import CACHED, CMAKE, PREFIX, compilers, empty, run

FPS, DIAMETER_MM = 10000, 67
CODECS = os.environ.get("IMPACTDIC_CODECS", "1") == "1"
DIGITS = 9  # as the examples print
# The impact that simulate_and_fit.cpp has in its source.
MODEL = """
normal = "linear_spring_damper"
friction = "coulomb"
preset = "sound"
[body]
shape = "hollow_sphere"
mass_kg = 0.0567
diameter_m = 0.067
[contact]
friction_kinetic = 0.1
"""
IMPACT = MODEL + """stiffness_n_per_m = 13385.0
damping_n_s_per_m = 5.36
[surface]
angle_deg = 0.0
[initial]
vt_m_s = -1.2
vn_m_s = -3.0
omega_rad_s = 0.0
"""
FIT = """tracks = ["track/track.csv"]
""" + MODEL + """[fit]
method = "trajectory"
parameters = ["stiffness_n_per_m", "damping_n_s_per_m"]
"""


def same_digits(number):
    return float(f"{float(number):.{DIGITS}g}")


def numbers(words):
    return [same_digits(word) for word in words]


class Examples(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        program, cls.folder = PREFIX / "bin" / "impactdic", empty("examples")
        job = cls.folder / "impact.toml"
        job.write_text(IMPACT)
        run(program, "simulate", "-q", job, "-o", cls.folder / "simulate")
        cls.clip = cls.folder / "impact" / "video.tif"
        run(program, "synth", "-q", "-o", cls.clip.parent, "--simulate", job, "--size", "160x160",
            "--radius-px", 45)
        cls.track = cls.folder / "track"
        run(program, "track", "-q", cls.clip, "-o", cls.track, "--fps", FPS, "--ball-diameter-mm",
            DIAMETER_MM)
        (cls.folder / "fit.toml").write_text(FIT)
        run(program, "fit", "-q", cls.folder / "fit.toml", "-o", cls.folder / "fit")
        cls.correlate = cls.folder / "correlate"
        if CODECS:
            cls.measure_pair(program)
        cls.built = {name: cls.build(name, path) for name, path in compilers(cls.__name__)}

    @classmethod
    def measure_pair(cls, program):
        run(program, "synth", "-q", "-o", cls.folder / "pair", "--frames", 2, "--format", "png",
            "--size", "160x160", "--radius-px", 60, "--velocity-px", "1.3,-0.7")
        cls.pair = sorted((cls.folder / "pair").rglob("*.png"))
        run(program, "correlate", "-q", *cls.pair, "-o", cls.correlate, "--window", 15, "--spacing",
            16)

    @classmethod
    def build(cls, name, compiler):
        """A copy in an empty folder, by find_package, as its first lines say."""
        source = empty(f"examples_{name}") / "examples"
        shutil.copytree(PREFIX / "share/doc/impactdic/examples", source)
        environment = {key: value for key, value in CACHED.items()
                       if key not in ("CXXFLAGS", "LDFLAGS", "CMAKE_PREFIX_PATH")}
        run(CMAKE, "-S", source, "-B", source / "build", f"-DCMAKE_PREFIX_PATH={PREFIX}",
            f"-DCMAKE_CXX_COMPILER={compiler}",
            "-DCMAKE_CXX_FLAGS=-Wall -Wextra -Wpedantic -Werror", env=environment)
        run(CMAKE, "--build", source / "build", "-j", os.cpu_count(), env=environment)
        return source / "build"

    def runs(self, example, *arguments):
        """The example's lines, which are the same whatever compiled it."""
        printed = {name: run(folder / example, *arguments) for name, folder in self.built.items()}
        self.assertEqual(len(set(printed.values())), 1, printed.keys())
        return next(iter(printed.values())).splitlines()

    def test_track_from_memory(self):
        lines = self.runs("track_from_memory", self.clip, FPS, DIAMETER_MM)
        columns = lines[0].split()
        with open(self.track / "track.csv", newline="", encoding="utf-8") as file:
            rows = [row for row in csv.DictReader(file) if row["rot_deg"]]
        self.assertGreater(len(rows), 100)
        for row, line in zip(rows, lines[1:]):
            self.assertEqual(numbers(line.split()), numbers(row[column] for column in columns))
        rest = lines[1 + len(rows):]
        restitution = self.summary("track")["impact"]["restitution"]
        self.assertEqual(rest[0], "impact: found")
        self.assertEqual(numbers(rest[1].split()[1::2]),
                         numbers([restitution["value"], restitution["sd"]]))
        self.assertEqual([line for line in rest[2:] if not line.startswith("warning: ")], [])

    @unittest.skipUnless(CODECS, "built without codecs: no PNG")
    def test_correlate_two_pictures(self):
        lines = self.runs("correlate_two_pictures", *self.pair)
        with open(self.correlate / "motion.csv", newline="", encoding="utf-8") as file:
            last = list(csv.DictReader(file))[-1]
        columns = ("dx_px", "dx_sd_px", "dy_px", "dy_sd_px", "rot_deg", "rot_sd_deg")
        self.assertEqual(numbers(re.findall(r" (-?[\d.e-]+)", lines[-1])),
                         numbers(last[column] for column in columns))
        columns = ("x_px", "y_px", "u_px", "u_sd_px", "v_px", "v_sd_px")
        self.assertEqual(lines[0].split(), list(columns))
        with h5py.File(self.correlate / "fields.h5") as file:
            ok = file["status"][-1] == 0
            cells = [file[name][-1][ok] for name in columns]
        self.assertGreater(ok.sum(), 40)
        self.assertEqual([numbers(line.split()) for line in lines[1:-1]],
                         [numbers(row) for row in zip(*cells)])

    def summary(self, job):
        return json.loads((self.folder / job / "summary.json").read_text(encoding="utf-8"))

    def test_simulate_and_fit(self):
        simulated, *fitted = self.runs("simulate_and_fit", self.track / "track.csv")
        summary = self.summary("simulate")
        self.assertEqual(numbers(simulated.split()[2::2]),
                         numbers([summary["restitution"], summary["contact_s"]]))
        self.check_fit(fitted, self.summary("fit"))

    def check_fit(self, lines, summary):
        parameters = summary["shots"][0]["parameters"]
        self.assertEqual([line.split()[1] for line in lines], list(parameters))
        for line, one in zip(lines, parameters.values()):
            self.assertEqual(numbers(line.split()[2::2]), numbers([one["value"], one["sd"]]))

    def test_fit_of_the_simulated_track(self):
        """What went in comes out again, within four of the stated deviations."""
        truth = {"stiffness_n_per_m": 13385, "damping_n_s_per_m": 5.36}
        found = {line.split()[1]: numbers(line.split()[2::2])
                 for line in self.runs("simulate_and_fit")[1:]}
        for key, value in truth.items():
            self.assertLess(abs(found[key][0] - value), 4 * found[key][1], key)
            self.assertLess(found[key][1], 0.1 * value, key)

    def test_a_request_that_is_wrong_is_one_line(self):
        for folder in self.built.values():
            run(folder / "track_from_memory", status=2)
            run(folder / "correlate_two_pictures", "no_such_file.tif", "nor_this.tif", status=1)
