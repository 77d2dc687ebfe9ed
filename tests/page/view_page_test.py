#!/usr/bin/env python3
"""The page of impactdic view in a headless Chromium: what it shows, and what it measures.
IMPACTDIC_PROGRAM names the program. Exit status 77: the program has no page, or there is no Chromium."""

import base64
import csv
import json
import math
import re
import shutil
import sys
import zlib
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support" / "page"))
import view_screens  # noqa: E402
from page_browser import find_chromium  # noqa: E402
from view_page import CONTACT_MS, JOB, NO_PAGE, RESTITUTION, main, make_batch, run  # noqa: E402

HOSTILE = "<img src=x onerror=alert(1)> <script>alert(2)<!--"


def content_of(test, pdf):
    """What the page of a PDF draws, whose table of objects leads to each of them."""
    test.assertTrue(pdf.startswith(b"%PDF-1.4") and pdf.endswith(b"%%EOF\n"))
    table = int(pdf.rpartition(b"startxref\n")[2].split()[0])
    test.assertTrue(pdf[table:].startswith(b"xref"))
    for k, place in enumerate(re.findall(rb"(\d{10}) 00000 n", pdf[table:]), 1):
        test.assertTrue(pdf[int(place):].startswith(b"%d 0 obj" % k))
    begin = pdf.index(b"stream\n", pdf.index(b"5 0 obj")) + 7
    return zlib.decompressobj().decompress(pdf[begin:]).decode("latin-1")


class Look(view_screens.Screens):
    def test_circle_and_values(self):
        self.open(self.page(self.shot))
        truth = self.truth()
        with open(self.shot / "track.csv", newline="", encoding="utf-8") as file:
            track = list(csv.DictReader(file))
        for frame in (0, 9, 30, 63):
            self.go_to(frame)
            x, y, r = self.outline()
            # As far as the outline shows the truth: half a pixel.
            self.assertAlmostEqual(x, float(truth[frame]["cx_px"]), delta=0.5)
            self.assertAlmostEqual(y, float(truth[frame]["cy_px"]), delta=0.5)
            if frame != 30:  # the free ball
                self.assertAlmostEqual(r, float(truth[frame]["r_px"]), delta=0.5 + 0.7)
            shown = self.browser.value("""Object.fromEntries([...document.querySelectorAll('#values dd')]
                .map(d => [d.dataset.column, [d.dataset.cell, d.textContent]]))""")
            for column in ("cx_px", "cy_px", "r_px", "dx_px", "rot_deg", "vx_m_s", "vn_m_s", "omega_rad_s"):
                cell, text = shown[column]
                self.assertEqual(cell, track[frame][column])
                if cell:  # what is read is the cell, rounded
                    digits = len(text.split(" ")[0].partition(".")[2])
                    self.assertAlmostEqual(float(text.split(" ")[0]), float(cell), delta=0.51 * 10**-digits)
                else:
                    self.assertEqual(text, "—")
            self.assertEqual(shown["status"][1], track[frame]["status"])
        self.assertIn("→", self.browser.value("document.getElementById('sentence').textContent"))

    def test_layers_map_history_and_curves(self):
        self.open(self.page(self.shot))
        self.go_to(20)
        b = self.browser
        b.value("document.getElementById('layer-arrows').click()")
        b.value("""(() => { const map = document.getElementById('layer-map');
            map.value = 'speed'; map.onchange(); })()""")
        b.wait("document.querySelector('#world .arrows') && !document.getElementById('legend').hidden")
        self.assertIn("px/frame", b.value("document.getElementById('screen').textContent"))
        self.assertIn("mm", b.value("document.getElementById('screen').textContent"))
        self.assertEqual(b.value("document.querySelectorAll('#world .axis').length"), 4)  # two, each twice
        b.wait("document.getElementById('curves')._fullLayout?.shapes?.length === 2")
        left = "parseFloat(document.querySelector('#curves .cursor').style.left)"
        before = b.value(left)
        self.go_to(40)
        b.wait(f"{left} > {before} + 20")
        x, y = b.value("""(() => { const c = document.querySelector('#world .outline').getBoundingClientRect();
            return [(c.left + c.right) / 2, (c.top + c.bottom) / 2]; })()""")
        b.click(x + 20, y + 20)
        b.wait("document.getElementById('history')._fullLayout && !document.getElementById('history').hidden")

    def setting(self, key, value):
        self.browser.value(f"""(() => {{ const box = document.getElementById('setting-{key}');
            box.value = '{value}'; box.onchange(); }})()""")

    def read_setting(self, key):
        return self.browser.value(f"document.getElementById('setting-{key}').value")

    def test_surface_by_mouse_then_run_then_restitution(self):
        work = self.root / "by mouse"
        work.mkdir()
        self.open(self.page(self.clip, cwd=work))
        b = self.browser
        b.wait("!document.getElementById('panel-setup').hidden")
        self.setting("ball-diameter-mm", "67")
        self.setting("inertia-factor", "0.667")
        b.wait("document.getElementById('found').textContent.includes('radius')")
        # Drawn from right to left: the ball tells which side of the surface is up.
        b.value("document.getElementById('draw-surface').click()")
        slope = math.tan(math.radians(30))
        b.drag(*self.point(150, 160 - 140 * slope), *self.point(10, 160))
        self.assertAlmostEqual(float(self.read_setting("surface-angle-deg")), 30, delta=0.05)
        b.value("document.getElementById('draw-gravity').click()")
        b.drag(*self.point(80, 40), *self.point(90, 140))
        tilt = math.degrees(math.atan2(-100, 10))  # y down
        self.assertAlmostEqual(float(self.read_setting("gravity-angle-deg")), tilt, delta=0.3)
        self.assertEqual(b.value("document.querySelectorAll('#hand .gravity').length"), 2)
        self.setting("gravity-angle-deg", "")  # the camera was level
        b.value("document.getElementById('draw-ball').click()")
        truth = self.truth()[0]
        x, y = float(truth["cx_px"]), float(truth["cy_px"])
        b.drag(*self.point(x, y), *self.point(x + 48, y))
        low, high = map(float, self.read_setting("radius-px").split(":"))
        self.assertTrue(38 <= low < 44 and 52 < high <= 58, (low, high))
        b.value("document.getElementById('draw-roi').click()")
        b.drag(*self.point(0, 0), *self.point(159, 169))
        self.assertEqual(self.read_setting("roi"), "0,0,160,170")
        b.wait("document.getElementById('command').textContent.includes('--roi 0,0,160,170')")
        b.wait("document.querySelector('#world .outline')")
        self.assertAlmostEqual(self.outline()[0], x, delta=0.5)
        self.setting("window", "4")
        b.wait("document.getElementById('setting-window').getAttribute('aria-invalid') === 'true'")
        self.setting("window", "")
        b.wait("document.getElementById('found').textContent.includes('radius')")
        b.wait("document.getElementById('setting-window').getAttribute('aria-invalid') === 'false'")
        b.forget("400 (Bad Request)")
        self.correct_by_hand()
        b.value("document.getElementById('tab-run').click()")
        b.value("document.getElementById('run').click()")
        b.wait("document.getElementById('sentence').textContent.includes('e 0.8')")
        with open(work / "video_results" / "summary.json", encoding="utf-8") as file:
            e = json.load(file)["impact"]["restitution"]
        # Three deviations; the drawn angle errs by a hundredth of a degree at most.
        self.assertAlmostEqual(e["value"], RESTITUTION, delta=3 * e["sd"])
        track = self.rows_of(work / "video_results")
        self.assertEqual({row["frame"]: row["by_hand"] for row in track if row["by_hand"] != "0"},
                         {"5": "1", "60": "3"})
        self.assertAlmostEqual(float(track[5]["cx_px"]), float(self.truth()[5]["cx_px"]), delta=0.05)
        self.assertEqual((track[60]["status"], track[60]["cx_px"]), ("no_ball", ""))
        b.value("document.getElementById('tab-run').click()")
        self.check_that_no_column_is_cut("#panel-run .scroll")
        b.value("document.getElementById('tab-look').click()")
        self.look_at_what_is_lost()
        self.go_on_with_frame_60_found(work / "video_results")
        run("track", "--job", work / "video_results" / "job.toml", "-q", "-o", work / "again")
        for name in ("track.csv", "pose.csv"):
            self.assertEqual((work / "again" / name).read_bytes(), (work / "video_results" / name).read_bytes())

    @staticmethod
    def rows_of(folder):
        with open(folder / "track.csv", newline="", encoding="utf-8") as file:
            return list(csv.DictReader(file))

    def go_on_with_frame_60_found(self, folder):
        """The run goes on in its folder with one correction less, from the page."""
        b = self.browser
        self.assertTrue(b.value("document.getElementById('go-on').hidden"))
        b.value("document.getElementById('tab-setup').click()")
        self.go_to(60, "setup")
        b.wait("!document.getElementById('correct-undo').disabled")
        b.value("document.getElementById('correct-undo').click()")
        b.wait("!document.getElementById('go-on').hidden")
        b.value("document.getElementById('go-on').click()")
        b.wait("document.getElementById('run-state').dataset.state === 'done' && !document.getElementById('panel-look').hidden"
               "")
        self.assertEqual(b.value("document.getElementById('frame').value"), "60")
        track = self.rows_of(folder)
        self.assertEqual({row["frame"]: row["by_hand"] for row in track if row["by_hand"] != "0"}, {"5": "1"})
        self.assertEqual((track[60]["status"], len(track)), ("ok", 64))
        self.assertRegex((folder / "job.toml").read_text(), r"ball-at = '5:[^/]*'")

    def check_that_no_column_is_cut(self, table):
        for width, height in view_screens.SIZES:
            self.browser.resize(width, height)
            self.browser.settle()
            self.assertEqual(self.browser.value(f"""(() => {{ const t = document.querySelector('{table}');
                return t.scrollWidth - t.clientWidth; }})()"""), 0, f"{table} at {width} px")
        self.browser.resize(1280, 900)

    def correct_by_hand(self):
        """Frame 5: the ball, two pixels off; frame 60: said to show none; frame 61 taken back."""
        b, truth = self.browser, self.truth()
        self.go_to(5, "setup")
        b.value("document.getElementById('draw-correct').click()")
        x, y = float(truth[5]["cx_px"]) + 2, float(truth[5]["cy_px"]) - 1
        b.drag(*self.point(x, y), *self.point(x, y + 47))
        frame, circle = self.read_setting("ball-at").split(":")
        self.assertEqual(frame, "5")
        for found, meant in zip(map(float, circle.split(",")), (x, y, 47)):
            self.assertAlmostEqual(found, meant, delta=0.6)  # a pixel of the screen is half of one here
        b.wait("document.querySelectorAll('#hand .correction').length === 2")
        b.wait("document.getElementById('found').textContent.includes('frame 5: ok')")
        for frame, button in ((60, "none"), (61, "none"), (61, "undo")):
            self.go_to(frame, "setup")
            b.wait(f"!document.getElementById('correct-{button}').disabled")
            b.value(f"document.getElementById('correct-{button}').click()")
        self.assertEqual(self.read_setting("ball-at"), f"5:{circle}/60:none")
        b.wait("document.querySelectorAll('#corrected button').length === 2")
        b.wait("document.getElementById('command').textContent.includes('/60:none')")

    def look_at_what_is_lost(self):
        b = self.browser
        self.go_to(5)
        shown = "document.querySelector('#values [data-column=by_hand]').textContent"
        self.assertEqual(b.value(shown), "measured from the circle given")
        self.assertIn("2 of 64 frames", b.value("document.getElementById('lost-look').textContent"))
        for frame in ("59", "60"):  # 59 has no next frame to move to
            b.value("document.getElementById('lost-forth-look').click()")
            b.wait(f"document.getElementById('values').dataset.frame === '{frame}'")
        self.assertTrue(b.value("document.getElementById('lost-forth-look').disabled"))

    def test_polygon_by_mouse(self):
        self.open(self.page(self.clip))
        b = self.browser
        b.value("document.getElementById('draw-polygon').click()")
        for x, y in ((20, 20), (140, 20), (140, 150)):
            b.click(*self.point(x, y))
        b.key("Enter")
        corners = list(map(float, self.read_setting("polygon").split(",")))
        for found, meant in zip(corners, (20, 20, 140, 20, 140, 150)):
            self.assertAlmostEqual(found, meant, delta=0.6)
        self.assertEqual(len(corners), 6)
        b.wait("document.querySelectorAll('#hand .polygon').length === 2")
        b.wait("document.getElementById('found').textContent.includes('radius')")
        self.setting("polygon", "1,1,9,1,9,9")  # where the ball is not
        b.wait("document.getElementById('found').textContent.includes('no_ball') || document.getElementById('found').textContent.includes('out_of_view')")

    def test_compare_sorts_leaves_out_and_leads_to_a_shot(self):
        self.open(self.page(make_batch(self)))
        b = self.browser
        names = "[...document.querySelectorAll('#shots-table tbody tr td:first-child')].map(c => c.textContent).join()"
        b.wait(f"{names} === 'one,two'")
        b.wait("document.getElementById('means').textContent.includes('(2)')")
        for order in ("one,two", "two,one"):
            b.value("document.querySelector('#shots-table th button').click()")
            b.wait(f"{names} === '{order}'")
        b.value("""(() => { const box = document.getElementById('group');
            box.value = 'surface'; box.onchange(); })()""")
        self.assertEqual(b.value("[...document.querySelectorAll('#shots-table tr.group')].map(r => r.textContent).join()"), "30°")
        b.value("""(() => { const box = document.getElementById('group');
            box.value = ''; box.onchange(); })()""")
        b.value("""(() => { const box = document.querySelector('#shots-table tbody tr input');
            box.value = '<b>hit the frame</b>'; box.onchange(); })()""")
        b.wait("document.querySelectorAll('#shots-table tr.out').length === 1")
        b.wait("/e 0.8\\d+ ± 0.0\\d+ \\(one shot/.test(document.getElementById('means').textContent)")
        shown = b.value("document.querySelector('#shots-table tbody tr:last-child').textContent")
        contact_ms, sd = map(float, re.search(r"(6\.\d\d) ± (0\.\d\d)", shown).groups())
        self.assertLess(abs(contact_ms - CONTACT_MS), 3 * sd)
        self.assertLess(sd, 0.15)
        self.check_that_no_column_is_cut("#shots-table")
        b.value("document.querySelectorAll('#shots-table button.link')[1].click()")
        b.wait("document.getElementById('title').textContent === 'one' && !document.getElementById('panel-look').hidden")
        b.wait("document.querySelector('#world .outline')")
        # Curves drawn behind another panel are as wide as their place.
        b.wait("document.getElementById('curves')._fullLayout?.width <= document.getElementById('panel-look').clientWidth + 1")

    def test_saved_drawing(self):
        self.open(self.page(self.shot))
        self.go_to(5)
        b = self.browser
        b.value("""(() => { window.saved = [];
            const make = URL.createObjectURL;
            let last;
            URL.createObjectURL = blob => { last = blob; return make.call(URL, blob); };
            HTMLAnchorElement.prototype.click = function () {
                const [name, blob] = [this.download, last];
                blob.arrayBuffer().then(bytes => saved.push([name, blob.type, blob.size,
                    btoa([...new Uint8Array(bytes)].map(c => String.fromCharCode(c)).join(""))]));
            }; })()""")
        b.value("document.getElementById('film-last').value = 9")
        films = b.value("document.getElementById('save-mp4').offsetParent !== null")  # there are codecs
        b.wait("document.getElementById('curves')._fullLayout?.shapes?.length === 2")
        keys = ("svg", "png", "pdf", "curves", "csv") + ("mp4",) * films
        for count, key in enumerate(keys):
            b.value(f"document.getElementById('save-{key}').click()")
            b.wait(f"saved.length > {count}")  # one after the other: the blob is told by when it was made
        saved = {key: (kind, base64.b64decode(data)) for key, (_, kind, _, data) in zip(keys, b.value("saved"))}
        self.assertIn(b"<svg", saved["svg"][1])
        self.assertGreater(len(saved["png"][1]), 20000)
        # 300 pixels an inch are 11811 a metre.
        self.assertIn(b"pHYs" + 2 * b"\x00\x00\x2e\x23" + b"\x01", saved["png"][1])
        self.check_pages(saved["pdf"][1], saved["curves"][1])
        if films:
            self.assertEqual((saved["mp4"][0], saved["mp4"][1][4:8]), ("video/mp4", b"ftyp"))
        self.assertEqual(saved["csv"][1], (self.shot / "track.csv").read_bytes())

    def check_pages(self, picture, curves):
        """The outline is a curve where the ball is, words are words, one picture has pixels."""
        drawn = content_of(self, picture)
        self.assertEqual((picture.count(b"/Subtype /Image"), drawn.count("Do")), (1, 1))
        self.assertRegex(drawn, r"\(\d+ mm\) Tj")
        # Four cubics from the circle's right: its rim is where it is on the screen.
        start, rim = re.search(r"([-\d. ]+) m\n((?:[-\d. ]+ c\n){4})h", drawn).groups()
        x, y = map(float, start.split())
        left = float(rim.splitlines()[1].split()[4])
        at = self.browser.value("(() => { const p = document.getElementById('picture').getBoundingClientRect(); return [p.left, p.top]; })()")
        cx, cy, r = self.outline()
        self.assertAlmostEqual((x + left) / 2, self.point(cx, cy)[0] - at[0], delta=0.6)
        self.assertAlmostEqual(y, self.point(cx, cy)[1] - at[1], delta=0.6)
        self.assertAlmostEqual(x - left, 2 * (self.point(r, 0)[0] - self.point(0, 0)[0]), delta=0.6)
        drawn = content_of(self, curves)
        self.assertEqual(drawn.count("Do"), 0)
        for words in ("velocity, m/s", "time, ms", "along the surface"):
            self.assertIn(f"({words}) Tj", drawn)
        self.assertGreater(len(re.findall(r" l\n", drawn)), 100)  # of the curves

    def test_a_fit_shows_its_model_over_the_measurement(self):
        (self.root / "fit.toml").write_text(JOB.partition("[surface]")[0]
            + f'[surface]\nangle_deg = 30.0\n[fit]\nmethod = "trajectory"\nrivals = false\n'
              'parameters = ["stiffness_n_per_m", "damping_n_s_per_m", "friction_kinetic"]\n', encoding="utf-8")
        job = (self.root / "fit.toml").read_text()
        (self.root / "fit.toml").write_text(f'tracks = ["{self.shot}/track.csv"]\n' + job)
        run("fit", self.root / "fit.toml", "-q", "-o", self.root / "fit")
        self.open(self.page(self.root / "fit"))
        b = self.browser
        b.wait("document.getElementById('title').textContent === 'shot'")
        b.value("document.getElementById('tab-look').click()")
        b.wait("document.getElementById('model-curves')._fullLayout")
        with open(self.root / "fit" / "residuals_0.csv", newline="", encoding="utf-8") as file:
            left = [1e6 * float(row["residual"]) for row in csv.DictReader(file) if row["series"] == "x_m"]
        with open(self.shot / "track.csv", newline="", encoding="utf-8") as file:
            x = [1e3 * float(row["x_m"]) for row in csv.DictReader(file)]
        curves = {(c["name"], c.get("yaxis", "y")): c["y"] for c in b.value(
            "document.getElementById('model-curves').data.map(({name, yaxis, y}) => ({name, yaxis, y: [...y]}))")}
        for k in (0, 20, 63):
            self.assertAlmostEqual(curves["x", "y2"][k], left[k], places=6)
            self.assertAlmostEqual(curves["x, right, measured", "y"][k], x[k] - x[0], places=6)
            self.assertAlmostEqual(curves["x, right, model", "y"][k], x[k] - x[0] + left[k] / 1e3, places=6)
        shown = re.search(r"stiffness_n_per_m (\d+) ± (\d+)", b.value("document.getElementById('parameters').textContent"))
        self.assertIsNotNone(shown)
        self.assertLess(abs(float(shown[1]) - 12526), 4 * float(shown[2]))  # the shot's own, JOB
        self.assertLess(float(shown[2]), 60)

    def test_keyboard_alone(self):
        self.open(self.page(self.shot))
        b = self.browser
        b.value("document.getElementById('picture').focus()")
        b.key("ArrowRight")
        b.wait("document.getElementById('frame').value === '1'")
        b.key("End")
        b.wait("document.getElementById('frame').value === '63'")
        b.key("Home")
        b.key(" ")
        b.wait("Number(document.getElementById('frame').value) > 3")
        b.key(" ")
        # Every control can be reached with the tabulator key.
        hidden = b.value("""[...document.querySelectorAll('button, input, select, a')]
            .filter(e => e.tabIndex < 0 && !e.closest('.plot')).map(e => e.id)""")
        self.assertEqual(hidden, [])

    def test_widths(self):
        self.open(self.page(self.shot), *view_screens.SIZES[0])
        for width, height in view_screens.SIZES:
            self.browser.resize(width, height)
            for tab in self.browser.value("[...document.querySelectorAll('#tabs button')].map(b => b.id)"):
                self.browser.value(f"document.getElementById('{tab}').click()")
                self.browser.settle()
                self.assertEqual(self.browser.value("[innerWidth, document.documentElement.scrollWidth]"),
                                 [width, width], f"{tab} at {width} px")
                wide = self.browser.value("""[...document.querySelectorAll('body *')].filter(e =>
                    !e.closest('.scroll, svg, .plot') && e.getBoundingClientRect().right > innerWidth + 1)
                    .map(e => e.tagName + '#' + e.id)""")
                self.assertEqual(wide, [], f"{tab} at {width} px")

    def test_doubt_stands_above_the_figures(self):
        """A surface whose angle was forgotten: restitution is in doubt, and the page says so at once."""
        folder = self.root / "doubted"
        run("track", self.clip, "--ball-diameter-mm", 67, "--inertia-factor", 0.667, "-q", "-o", folder)
        self.open(self.page(folder))
        b = self.browser
        self.assertIn("(doubtful)", b.value("document.getElementById('sentence').textContent"))
        self.assertIn("--surface-angle-deg forgotten", b.value("document.getElementById('warnings').textContent"))
        self.assertIn("closure: spin", b.value("document.getElementById('lights').textContent"))
        top = [b.value(f"document.getElementById('{name}').getBoundingClientRect().top") for name in ("warnings", "values")]
        self.assertLess(top[0], top[1])
        self.assertLess(top[0], 400)

    def test_names_are_text(self):
        folder = self.root / HOSTILE.replace("/", "")
        shutil.copytree(self.shot, folder)
        summary = json.loads((folder / "summary.json").read_text())
        summary["warnings"] = [HOSTILE]
        (folder / "summary.json").write_text(json.dumps(summary))
        clip = self.root / f"{HOSTILE}.cine"
        shutil.copy(self.clip, clip)
        job = (folder / "job.toml").read_text().replace(str(self.clip), str(clip))
        (folder / "job.toml").write_text(job)
        self.open(self.page(folder))
        self.browser.wait("document.querySelector('#warnings li')")
        self.assertEqual(self.browser.value("document.getElementById('title').textContent"), folder.name)
        self.assertEqual(self.browser.value("document.getElementById('warnings').textContent"), HOSTILE)
        self.assertEqual(self.browser.value("document.querySelectorAll('img').length"), 0)
        self.assertEqual(self.browser.value("document.querySelectorAll('script').length"), 2)


if __name__ == "__main__":
    if find_chromium() is None:
        print("no Chromium on this machine", file=sys.stderr)
        sys.exit(NO_PAGE)
    main()
