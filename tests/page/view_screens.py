"""What the tests of view's page share, and those of what is to be seen: screens against clip and truth,
colours, a run by keyboard alone."""

import csv
import itertools
import re
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support" / "page"))
from page_browser import PageBrowser  # noqa: E402
from view_page import Case  # noqa: E402

SIZES = (390, 844), (1280, 900), (2560, 1440)  # of screens: a phone, a laptop, a desk
# What is left of linear red, green and blue without the cones for long, middle and short waves.
CONES = {
    "long": [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]],
    "middle": [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]],
    "short": [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602], [0.004733, 0.691367, 0.303900]],
}


def linear(srgb):
    return np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4)


def lab(rgb):
    """CIE L*a*b* of linear sRGB."""
    xyz = np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]]) @ np.clip(rgb, 0, 1)
    f = np.cbrt(np.maximum(xyz / [0.9505, 1, 1.089], 0.008856))
    return np.array([116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])])


class Screens(Case):
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
        self.browser.forget("409 (Conflict)")  # a measurement that the next one has overtaken
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

    def point(self, x, y):
        """Where a point of the picture lies on the screen, while all of the picture is shown."""
        return self.browser.value(f"""(() => {{
            const at = document.getElementById('picture').getBoundingClientRect();
            const zoom = Math.min(at.width / 160, at.height / 170);
            return [at.left + (at.width - 160 * zoom) / 2 + ({x} + 0.5) * zoom,
                    at.top + (at.height - 170 * zoom) / 2 + ({y} + 0.5) * zoom]; }})()""")

    def test_a_run_by_keyboard_alone(self):
        work = self.root / "by keyboard"
        work.mkdir()
        self.open(self.page(self.clip, cwd=work))
        b = self.browser
        b.tab_to("setting-ball-diameter-mm")
        for key in "67":
            b.key(key)
        b.tab_to("setting-no-field")
        b.key(" ")
        b.wait("document.getElementById('command').textContent.includes('--ball-diameter-mm 67 --no-field')")
        b.tab_to("tab-run")
        b.key("Enter")
        b.tab_to("run")
        b.key("Enter")
        b.wait("!document.getElementById('panel-look').hidden && document.getElementById('values').dataset.frame === '0'")
        self.assertTrue((work / "video_results" / "track.csv").exists())

    def shown_picture(self, frame, width):
        """What is on the screen against what the clip and its truth say: the grey of the picture, and
        the outline's colour on the true circle."""
        screen = self.browser.picture()[..., :3]
        truth = self.truth()[frame]
        cx, cy, r = (float(truth[name]) for name in ("cx_px", "cy_px", "r_px"))
        turn = np.linspace(0, 2 * np.pi, 72, endpoint=False)
        corner, unit = self.point(0, 0), self.point(1, 0)
        zoom = unit[0] - corner[0]
        self.assertGreater(zoom * 160, 0.5 * min(width, 640), "the picture fills its place")
        orange = np.array([0xE6, 0x9F, 0x00]) / 255
        seen = 0
        for c, s in zip(np.cos(turn), np.sin(turn)):
            reach = np.arange(-2, 2.01, 0.25) / min(zoom, 1) + r * zoom  # px of the screen
            xs = np.rint(corner[0] + cx * zoom + reach * c).astype(int)
            ys = np.rint(corner[1] + cy * zoom + reach * s).astype(int)
            inside = (xs >= 0) & (ys >= 0) & (xs < screen.shape[1]) & (ys < screen.shape[0])
            seen += bool(np.any(np.abs(screen[ys[inside], xs[inside]] - orange).max(axis=1) < 0.15)) if inside.any() else 0
        self.assertGreater(seen, 60, f"the outline lies on the true circle at {width} px")
        return screen, zoom, corner

    def test_screens_show_what_was_filmed_and_measured(self):
        page = self.page(self.shot)
        grey = np.frombuffer(page.ask("frame", frame=5), np.uint8).reshape(170, 160) / 255
        self.open(page, *SIZES[0])
        self.go_to(5)
        for layer in ("path", "axes", "bar"):
            self.browser.value(f"document.getElementById('layer-{layer}').click()")
        self.browser.wait("document.querySelectorAll('#world .axis').length === 0")
        for width, height in SIZES:
            self.browser.resize(width, height)
            self.browser.settle()
            screen, zoom, corner = self.shown_picture(5, width)
            ys, xs = np.mgrid[10:160, 10:150]
            shown = screen[np.rint(corner[1] + ys * zoom).astype(int).clip(0, screen.shape[0] - 1),
                           np.rint(corner[0] + xs * zoom).astype(int).clip(0, screen.shape[1] - 1)].mean(axis=2)
            self.assertGreater(np.corrcoef(shown.ravel(), grey[10:160, 10:150].ravel())[0, 1], 0.95, width)

    def test_colours_are_told_apart_by_the_colour_blind(self):
        """Lines over one picture, as people without one kind of cone see them (Machado, Oliveira &
        Fernandes 2009): ten units of CIE L*a*b* apart, and the map of a field ever brighter."""
        source = (Path(__file__).resolve().parents[2] / "host" / "view" / "page" / "colours.js").read_text()
        named = {name: [int(code[k:k + 2], 16) / 255 for k in (0, 2, 4)]
                 for name, code in re.findall(r'([A-Z]+) = "#([0-9A-F]{6})"', source)}
        self.assertEqual(sorted(named), ["BLUE", "ORANGE", "RED", "SKY", "YELLOW"])
        for seen in CONES.values():
            points = {name: lab(np.array(seen) @ linear(np.array(colour))) for name, colour in named.items()}
            for one, other in itertools.combinations(points, 2):
                self.assertGreater(np.linalg.norm(points[one] - points[other]), 10, (one, other))
            for anchors in re.findall(r'(?:viridis|cividis): \[(.*?)\]', source):
                steps = [[int(code[k:k + 2], 16) / 255 for k in (0, 2, 4)] for code in re.findall(r'"(\w{6})"', anchors)]
                light = [lab(np.array(seen) @ linear(np.array(step)))[0] for step in steps]
                self.assertTrue((np.diff(light) > 4).all(), light)
