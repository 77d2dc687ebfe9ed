#!/usr/bin/env python3
"""The page of impactdic view in a headless Chromium: what it shows, and what it measures.
IMPACTDIC_PROGRAM names the program. Exit status 77: the program has no page, or there is no Chromium."""

import csv
import json
import math
import shutil
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support" / "page"))
from page_browser import PageBrowser, find_chromium  # noqa: E402
from view_page import NO_PAGE, RESTITUTION, Case, main, make_batch, run  # noqa: E402

HOSTILE = "<img src=x onerror=alert(1)> <script>alert(2)<!--"


class Look(Case):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.browser = PageBrowser()

    @classmethod
    def tearDownClass(cls):
        cls.browser.close()

    def open(self, page, width=1280, height=900):
        self.browser.open(page.address, width, height)
        self.browser.wait("document.documentElement?.dataset?.ready === 'yes'")

    def tearDown(self):
        self.assertEqual(self.browser.problems(), [])

    def truth(self):
        with open(self.root / "clip" / "truth.csv", newline="", encoding="utf-8") as file:
            return list(csv.DictReader(file))

    def go_to(self, frame, panel="look"):
        self.browser.value(f"""(() => {{ const box = document.getElementById('frame');
            box.value = {frame}; box.onchange(); }})()""")
        where = {"look": f"document.getElementById('values').dataset.frame === '{frame}'",
                 "setup": f"document.getElementById('correct-frame').textContent === 'Frame {frame}:'"}
        self.browser.wait(where[panel])

    def outline(self):
        """Centre and radius of the outline on the screen, in the picture's pixels, worked out from
        where the picture lies on the screen."""
        return self.browser.value("""(() => {
            const box = document.querySelector('#world .outline').getBoundingClientRect();
            const stroke = 4, at = document.getElementById('picture').getBoundingClientRect();
            const zoom = Math.min(at.width / 160, at.height / 170);
            const left = at.left + (at.width - 160 * zoom) / 2, top = at.top + (at.height - 170 * zoom) / 2;
            return [((box.left + box.right) / 2 - left) / zoom - 0.5, ((box.top + box.bottom) / 2 - top) / zoom - 0.5,
                    box.width / 2 / zoom]; })()""")

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

    def point(self, x, y):
        """Where a point of the picture lies on the screen, while all of the picture is shown."""
        return self.browser.value(f"""(() => {{
            const at = document.getElementById('picture').getBoundingClientRect();
            const zoom = Math.min(at.width / 160, at.height / 170);
            return [at.left + (at.width - 160 * zoom) / 2 + ({x} + 0.5) * zoom,
                    at.top + (at.height - 170 * zoom) / 2 + ({y} + 0.5) * zoom]; }})()""")

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
        run("track", "--job", work / "video_results" / "job.toml", "-q", "-o", work / "again")
        for name in ("track.csv", "pose.csv"):
            self.assertEqual((work / "again" / name).read_bytes(), (work / "video_results" / name).read_bytes())
        with open(work / "video_results" / "track.csv", newline="", encoding="utf-8") as file:
            track = list(csv.DictReader(file))
        self.assertEqual({row["frame"]: row["by_hand"] for row in track if row["by_hand"] != "0"},
                         {"5": "1", "60": "3"})
        self.assertAlmostEqual(float(track[5]["cx_px"]), float(self.truth()[5]["cx_px"]), delta=0.05)
        self.assertEqual((track[60]["status"], track[60]["cx_px"]), ("no_ball", ""))
        self.look_at_what_is_lost()

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
        b.wait("document.getElementById('means').textContent.includes('(1)')")
        b.value("document.querySelectorAll('#shots-table button.link')[1].click()")
        b.wait("document.getElementById('title').textContent === 'one' && !document.getElementById('panel-look').hidden")
        b.wait("document.querySelector('#world .outline')")

    def test_saved_drawing(self):
        self.open(self.page(self.shot))
        self.go_to(20)
        b = self.browser
        b.value("""(() => { window.saved = [];
            const make = URL.createObjectURL;
            let last;
            URL.createObjectURL = blob => { last = blob; return make.call(URL, blob); };
            HTMLAnchorElement.prototype.click = function () {
                const [name, blob] = [this.download, last];
                blob.text().then(text => saved.push([name, blob.type, blob.size, text.slice(0, 100)]));
            }; })()""")
        for key in ("svg", "png", "csv"):
            b.value(f"document.getElementById('save-{key}').click()")
        b.wait("saved.length === 3")
        saved = {name.rpartition(".")[2]: rest for name, *rest in b.value("saved")}
        self.assertIn("<svg", saved["svg"][2])
        self.assertGreater(saved["png"][1], 20000)
        self.assertEqual(saved["csv"][1], (self.shot / "track.csv").stat().st_size)

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
        page = self.page(self.shot)
        for width, height in ((390, 844), (1280, 900), (2560, 1440)):
            self.open(page, width, height)
            for tab in self.browser.value("[...document.querySelectorAll('#tabs button')].map(b => b.id)"):
                self.browser.value(f"document.getElementById('{tab}').click()")
                time.sleep(0.3)
                self.assertEqual(self.browser.value("[innerWidth, document.documentElement.scrollWidth]"),
                                 [width, width], f"{tab} at {width} px")
                wide = self.browser.value("""[...document.querySelectorAll('body *')].filter(e =>
                    !e.closest('.scroll, svg, .plot') && e.getBoundingClientRect().right > innerWidth + 1)
                    .map(e => e.tagName + '#' + e.id)""")
                self.assertEqual(wide, [], f"{tab} at {width} px")

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
