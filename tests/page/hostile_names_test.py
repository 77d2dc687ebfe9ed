#!/usr/bin/env python3
"""Names, notes and messages that try to be more than text: in the report, in shots.csv, in folders
of results. IMPACTDIC_PROGRAM names the program."""

import csv
import html
import html.parser
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support/page"))
from page_browser import PageBrowser, find_chromium  # noqa: E402
from view_page import Page  # noqa: E402

PROGRAM = os.environ["IMPACTDIC_PROGRAM"]
CHECK_PAGE = Path(__file__).resolve().parents[1] / "support" / "check_page.py"
NAMES = [
    "=HYPERLINK(\"http:evil\")", "+cmd|' C calc'!A0", "-2+3", "@SUM(1)", "=1+1",
    "<img src=x onerror=alert(1)>", "\"><svg onload=alert(2)>", "<!--<script>alert(3)",
    "x' onmouseover='alert(4)", "javascript:alert(5)", "$\\badmath{$", "%s%n%x", "a;b&c|d`e`$(touch pwned)",
    "  spaces  ", "ünïcødé ✓ 球", "b" * 240, "a\\..\\b", "{{7*7}}", "%2e%2e%2fetc",
    "<iframe srcdoc='<script>alert(8)'>", "<style>@import'http:evil'", "&lt;script&gt;alert(9)",
    "data:text;html", "\x1b[31mred", "\u202etxt.exe", "--help", "tab\there", "<title><base href=http:evil>",
]
NOTES = ["=1+1", "-1", "<b>bold</b>", "@x", "<script>alert(6)</script>", "+1", "</td></table><form>", "\t=1"]
CAMERA = "<img src=http:evil onerror=alert(10)>"
MAY_HAVE_SOURCE = ("data:", "blob:")


def run(*arguments, status=0):
    done = subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True)
    if done.returncode != status:
        raise AssertionError(f"{arguments}: {done.returncode}, {done.stderr}")
    return done


class ParsedPage(html.parser.HTMLParser):
    """What a browser would make of the page."""

    def __init__(self, text):
        super().__init__()
        self.scripts, self.wrong, self.text = 0, [], ""
        self.inside = ""
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        self.inside = tag
        self.scripts += tag == "script"
        if tag in ("img", "svg", "iframe", "object", "embed", "link", "b", "form"):
            self.wrong.append(f"<{tag}>")
        for name, value in attrs:
            if name.startswith("on"):
                self.wrong.append(f"{tag} {name}")
            if name in ("src", "href") and not (value or "").startswith(("#", *MAY_HAVE_SOURCE)):
                self.wrong.append(f"{tag} {name}={value}")

    def handle_data(self, data):
        if self.inside not in ("script", "style"):
            self.text += data


class HostileNames(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.root = Path(tempfile.mkdtemp(prefix="impactdic_names_"))
        cls.clips, cls.out = cls.root / "clips", cls.root / "<i>results & 'more'"
        cls.clips.mkdir()
        run("synth", "--pattern", "e1", "--size", "96x96", "--radius-px", "28", "--frames", "4",
            "-q", "-o", cls.root / "made")
        for name in NAMES:
            shutil.copy(cls.root / "made/video.tif", cls.clips / f"{name}.tif")
        run("synth", "--pattern", "e1", "--size", "96x96", "--radius-px", "28", "--frames", "4",
            "--format", "mraw", "-q", "-o", cls.root / "made_mraw")
        shutil.copy(cls.root / "made_mraw/video.mraw", cls.clips / "header.mraw")
        header = (cls.root / "made_mraw/video.cihx").read_bytes()
        named = re.sub(b"<deviceName>[^<]*<", b"<deviceName>%s<" % html.escape(CAMERA).encode(), header)
        (cls.clips / "header.cihx").write_bytes(named)
        (cls.clips / "<u>no clip.tif").write_text("this is none")
        table = ["file,notes"]
        # The table is plain: names with commas or quotes cannot stand in it.
        table += [f"{name}.tif,{note}" for name, note in zip(NAMES[4:], NOTES) if '"' not in name]
        (cls.root / "table.csv").write_text("\n".join(table) + "\n", encoding="utf-8")
        run("batch", cls.clips, "-q", "--fps", "1000", "--no-field", "--table",
            cls.root / "table.csv", "-o", cls.out)

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.root)

    def test_no_cell_is_a_formula(self):
        with open(self.out / "shots.csv", newline="", encoding="utf-8") as file:
            rows = list(csv.reader(file))
        self.assertEqual(len(rows), len(NAMES) + 3)
        self.assertEqual({len(row) for row in rows}, {len(rows[0])})
        for row in rows[1:]:
            for cell in row:
                if cell.strip()[:1] in tuple("=+-@") and cell.strip():
                    float(cell)  # a number may

    def test_nothing_left_its_folder(self):
        self.assertEqual(sorted(p.name for p in self.root.iterdir()),
                         sorted(["clips", "made", "made_mraw", "table.csv", self.out.name]))
        self.assertEqual(len(list((self.out / "shots").iterdir())), len(NAMES) + 1)
        self.assertFalse(Path("pwned").exists())

    def test_the_page_shows_them_as_text(self):
        run("report", self.out, "-q")
        text = (self.out / "report.html").read_text(encoding="utf-8")
        page = ParsedPage(text)
        self.assertEqual(page.wrong, [])
        self.assertEqual(page.scripts, 2)
        for name in ("<img src=x onerror=alert(1)>", "=1+1", "球"):
            self.assertIn(name, page.text)
        panels = text[text.rindex("const panels = "):]
        self.assertNotIn("<", panels[:panels.index(";")])
        done = subprocess.run([sys.executable, CHECK_PAGE, self.out / "report.html"],
                              capture_output=True, text=True)
        if done.returncode != 77:  # no browser here
            self.assertEqual(done.returncode, 0, done.stdout)

    @unittest.skipIf(find_chromium() is None, "no Chromium on this machine")
    def test_view_shows_them_as_text(self):
        summary = json.loads((self.out / "shots/header/summary.json").read_text())
        self.assertEqual(summary["input"]["camera"], CAMERA)
        browser = PageBrowser()
        self.addCleanup(browser.close)
        names = [name.replace('"', "'") for name in NAMES]  # as shots.csv has them
        for folder, shown in ((self.out, names + NOTES[:2]), (self.out / "shots/header", [])):
            try:
                page = Page(folder)
            except AssertionError as error:
                self.assertIn("without its page", str(error))
                self.skipTest("this program was built without its page")
            self.addCleanup(page.stop)
            browser.open(page.address, 1280, 900)
            browser.wait("document.documentElement?.dataset?.ready === 'yes'")
            if shown:
                browser.wait(f"document.querySelectorAll('#shots-table tbody tr').length >= {len(NAMES)}")
            text = browser.value("document.body.textContent")
            for name in shown:
                self.assertIn(name, text)
            for alien in ("img", "iframe", "object", "embed", "base", "form", "[onclick]", "[onerror]",
                          "[onload]", "[onmouseover]"):
                found = browser.value(f"document.querySelectorAll(\"{alien}\").length")
                self.assertEqual(found, 0, alien)
            self.assertEqual(browser.value("document.querySelectorAll('script').length"), 2)
            self.assertEqual(browser.problems(), [])

    def test_a_table_that_leads_elsewhere_is_refused(self):
        other = self.root / "forged"
        shutil.copytree(self.out, other)
        try:
            path = other / "shots.csv"
            path.write_text(path.read_text(encoding="utf-8").replace("{{7*7}},ok", "../../secret,ok"),
                            encoding="utf-8")
            done = run("report", other, "-q", status=1)
            self.assertIn("no name of a shot", done.stderr)
        finally:
            shutil.rmtree(other)

    def test_every_shot_can_be_verified(self):
        self.assertIn("as impactdic", run("verify", self.out).stdout)


if __name__ == "__main__":
    unittest.main()
