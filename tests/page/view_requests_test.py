#!/usr/bin/env python3
"""The page of impactdic view without a browser: who may ask, what is refused, what data it gets.
IMPACTDIC_PROGRAM names the program. Exit status 77: the program has no page."""

import csv
import json
import random
import re
import shlex
import shutil
import sys
import urllib.parse
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support" / "page"))
from view_page import SYNTH, TRACK, Case, Page, main, make_batch, run  # noqa: E402

FUZZED = 3000


class Requests(Case):
    def test_one_line_with_an_address_and_ctrl_c_ends_it(self):
        page = Page(self.shot)
        self.assertRegex(page.address, r"^http://127\.0\.0\.1:\d+/[0-9a-f]{32}/$")
        self.assertEqual(page.get(page.path)[0], 200)
        self.assertEqual(page.stop(), (0, ""))

    def test_each_start_has_another_token(self):
        one, other = self.page(self.shot), self.page(self.shot)
        self.assertNotEqual(one.path, other.path)
        self.assertEqual(one.get(other.path)[0], 403)

    def test_nothing_to_show_is_one_line(self):
        done = run("view", self.root / "none.cine", "--no-browser", status=1)
        self.assertRegex(done.stderr, r"^impactdic: error: .*none\.cine.*\n$")
        run("view", self.clip, "--port", "70000", status=2)

    def test_a_taken_port_is_one_line(self):
        page = self.page(self.shot)
        done = run("view", self.shot, "--no-browser", "--port", page.port, status=1)
        self.assertIn("--port", done.stderr)

    def test_it_listens_on_this_machine_alone(self):
        page = self.page(self.shot)
        want = f":{page.port:04X}"
        with open("/proc/net/tcp", encoding="ascii") as table:
            bound = [line.split()[1] for line in table if line.split()[3] == "0A"]
        self.assertEqual([a for a in bound if a.endswith(want)], ["0100007F" + want])

    def test_strangers_are_refused(self):
        page = self.page(self.shot)
        token = page.path.strip("/")
        wrong = token[:-1] + ("0" if token[-1] != "0" else "1")
        for path in ("/", "/index.html", f"/{wrong}/", f"/{token}", f"/{token[:16]}/", "/%2e%2e/",
                     f"/{wrong}/api/state", f"//{token}/", f"/x/../{token}/"):
            self.assertEqual(page.get(path)[0], 403, path)
        for host in ("evil.example", "127.0.0.1.evil.example", f"evil.example:{page.port}", "",
                     "localhost.evil.example", "127.0.0.1:80x", "[::1]", "127.0.0.2"):
            self.assertEqual(page.get(page.path, {"Host": host})[0], 403, host)
        for origin in ("http://evil.example", "null", "https://127.0.0.1", "file://"):
            self.assertEqual(page.get(page.path, {"Origin": origin})[0], 403, origin)
        for host in (f"localhost:{page.port}", "127.0.0.1:9000"):  # as ssh forwards it
            self.assertEqual(page.get(page.path, {"Host": host})[0], 200, host)
        for hosts in ("", "Host: 127.0.0.1\r\nHost: evil.example\r\n"):
            request = f"GET {page.path} HTTP/1.1\r\n{hosts}Connection: close\r\n\r\n"
            self.assertIn(b"403", page.send(request.encode(), ends=False)[:20], hosts)

    def test_paths_lead_nowhere_else(self):
        page = self.page(self.shot)
        for name in ("../../etc/passwd", "..%2f..%2fetc%2fpasswd", "%2e%2e/job.toml", "/etc/passwd",
                     "api/../../x", "job.toml", "x" * 500, "api/frame/..", "index.html%00.js"):
            self.assertEqual(page.get(page.path + name)[0], 404, name)
        for name in ("../clip/truth.csv", "/etc/passwd", "fields.h5", "SHA256SUMS", ".", "",
                     "track.csv/../../clip/truth.csv", "track.csv\0"):
            quoted = urllib.parse.quote(name, safe="")
            self.assertEqual(page.get(f"{page.path}api/file?name={quoted}")[0], 404, name)
        for shot in ("..", "/", "../shot", "x"):
            quoted = urllib.parse.quote(shot, safe="")
            self.assertEqual(page.get(f"{page.path}api/state?shot={quoted}")[0], 404, shot)

    def test_wrong_values_are_one_line(self):
        page = self.page(self.shot)
        for name in ("frame?frame=64", "frame?frame=-1", "frame?frame=1e9", "frame?frame=", "frame",
                     "frame?frame=0&shrink=0", "frame?frame=0&shrink=100000", "field?row=64",
                     "frame?frame=0&black=nan&white=x", "history?window=1000000", "field?row=-1"):
            status, headers, body = page.get(f"{page.path}api/{name}")
            self.assertIn(status, (400, 404), name)
            self.assertEqual(headers["Content-Type"], "application/json")
            self.assertNotIn("\n", json.loads(body)["error"])

    def test_oversized_and_other_methods_are_refused(self):
        page = self.page(self.shot)
        status = page.get(page.path + "api/measure", method="POST", body=b" " * (1 << 20 | 1))[0]
        self.assertEqual(status, 413)
        for method in ("PUT", "DELETE", "PATCH", "OPTIONS", "TRACE"):
            self.assertNotEqual(page.get(page.path, method=method)[0], 200, method)
        self.assertEqual(page.get(page.path, {"Range": "bytes=0-3,0-3"})[0], 400)
        back = page.send(f"GET {page.path}{'x' * 20000} HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n".encode())
        self.assertNotIn(b"200 OK", back)
        self.assertEqual(page.get(page.path)[0], 200)

    def test_what_the_page_may_load(self):
        page = self.page(self.shot)
        headers = page.get(page.path)[1]
        policy = dict(p.split(" ", 1) for p in headers["Content-Security-Policy"].split("; "))
        self.assertEqual(policy["default-src"], "'none'")
        self.assertEqual(policy["script-src"], "'self'")
        self.assertEqual(policy["connect-src"], "'self'")
        self.assertEqual(headers["X-Content-Type-Options"], "nosniff")
        self.assertEqual(headers["Referrer-Policy"], "no-referrer")
        html = page.get(page.path)[2].decode()
        self.assertNotRegex(html, r"\son\w+=|<script>|https?:")
        for name in re.findall(r'(?:src|href)="([^"]+)"', html):
            self.assertEqual(page.get(page.path + name)[0], 200, name)

    def test_random_requests_do_no_harm(self):
        work = self.root / "fuzzed" / "in"  # where a run of a mangled name may write
        work.mkdir(parents=True)
        page = self.page(self.shot, cwd=work)
        draw = random.Random(20261122)

        def get(what):
            return f"GET {page.path}{what} HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n"

        def post(what, body):
            text = json.dumps(body)
            return (f"POST {page.path}api/{what} HTTP/1.1\r\nHost: 127.0.0.1\r\n"
                    f"Content-Length: {len(text)}\r\n\r\n{text}")
        # Every address that there is, and two requests in other forms.
        good = [get(what) for what in ("", "main.js", "api/state?shot=", "api/field?row=3", "api/history?window=30",
                                       "api/file?name=track.csv", "api/run?from=0",
                                       "api/film?first=0&end=2&step=1&rate=25&black=0&white=255")]
        good += [post("measure", {"frame": 3, "settings": {"no-field": True}, "outline": True}),
                 post("job", {"settings": {"window": 17}, "folder": "x"}), post("stop", {}),
                 post("run", {"settings": {"no-field": True, "frames": "0:3"}, "folder": "out", "force": True}),
                 post("exclude", {"shot": "one", "reason": "x"}),
                 f"GET {page.path}api/frame?frame=3&black=0&white=255&shrink=2 HTTP/1.1\r\n"
                 "Host: localhost\r\nConnection: close\r\n\r\n",
                 f"POST {page.path}api/job HTTP/1.1\r\nHost: 127.0.0.1\r\n"
                 "Transfer-Encoding: chunked\r\n\r\n2\r\n{}\r\n0\r\n\r\n",
                 "GET / HTTP/1.1\r\nHost: evil\r\n\r\n"]
        for request in good[:-1]:  # as they stand they are answered
            request = request.replace("\r\n\r\n", "\r\nConnection: close\r\n\r\n", 1)
            self.assertIn(page.send(request.encode(), ends=False)[9:12], (b"200", b"404" if "exclude" in request else b"200"), request)
        pieces = ["\0", "\r\n", "%00", "%", "../", "-1", "9" * 30, "\xff\xfe", ":", "nan", "{" * 50,
                  "Content-Length: -5\r\n", "Range: bytes=5-1\r\n", "shrink=0", "&", "=", "[" * 300]
        for _ in range(FUZZED):
            data = bytearray(draw.choice(good).encode("latin-1"))
            # Mostly behind the token, without which nothing is looked at.
            least = data.find(page.path.encode()) + len(page.path) if draw.random() < 0.8 else 0
            for _ in range(draw.randint(1, 4)):
                at, kind = draw.randrange(min(least, len(data)), len(data) + 1), draw.randrange(4)
                if kind == 0 and data:
                    data[at % len(data)] = draw.randrange(256)
                elif kind == 1:
                    data[at:at] = draw.choice(pieces).encode("latin-1")
                elif kind == 2:
                    del data[at:at + draw.randint(1, 40)]
                else:
                    data[at:at] = bytes(draw.randrange(256) for _ in range(draw.randint(1, 30)))
            page.send(bytes(data))
        self.assertIsNone(page.process.poll())
        self.assertEqual(json.loads(page.ask("state"))["title"], "shot")
        self.assertEqual(page.stop()[0], 0)


class Data(Case):
    """What the page gets, without a browser."""

    def test_pictures_are_those_of_the_clip(self):
        page = self.page(self.clip)
        state = json.loads(page.ask("state"))["clip"]
        self.assertEqual((state["width"], state["height"], state["frames"]), (160, 170, 64))
        run("synth", "--simulate", self.root / "impact.toml", *SYNTH, "--format", "raw", "-q", "-o",
            self.root / "raw")
        with open(next((self.root / "raw").glob("video.*")), "rb") as file:
            file.seek(10 * 160 * 170)
            want = file.read(160 * 170)
        self.assertEqual(page.ask("frame", frame=10, black=0, white=255), want)
        small = page.ask("frame", frame=10, black=0, white=255, shrink=2)
        self.assertEqual(len(small), 80 * 85)
        block = [want[0], want[1], want[160], want[161]]
        self.assertEqual(small[0], sum(block) // 4)

    def test_files_come_as_they_are(self):
        page = self.page(self.shot)
        for name in ("track.csv", "pose.csv", "summary.json", "job.toml"):
            self.assertEqual(page.ask("file", name=name), (self.shot / name).read_bytes())

    def test_fields_are_those_of_the_file(self):
        try:
            import h5py
            import numpy as np
        except ImportError:
            self.skipTest("no h5py")
        page = self.page(self.shot)
        fields = json.loads(page.ask("state"))["fields"]
        with h5py.File(self.shot / "fields.h5") as file:
            want = np.array([file[name][20].astype(np.float32) for name in fields["columns"]])
            history = np.array([file[name][:, 30].astype(np.float32) for name in fields["columns"]])
        got = np.frombuffer(page.ask("field", row=20), np.float32).reshape(want.shape)
        np.testing.assert_array_equal(got, want)
        got = np.frombuffer(page.ask("history", window=30), np.float32).reshape(history.shape)
        np.testing.assert_array_equal(got, history)

    def test_results_without_their_clip(self):
        lone = self.root / "lone"
        shutil.copytree(self.shot, lone)
        job = (lone / "job.toml").read_text()
        (lone / "job.toml").write_text(job.replace("video.cine", "gone.cine"))
        state = json.loads(self.page(lone).ask("state"))
        self.assertIsNone(state["clip"])
        self.assertIn("gone.cine", state["clip_error"])
        self.assertIn("track.csv", state["files"])


class Batch(Case):
    """The results of many shots."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.batch = make_batch(cls)

    def test_shots_of_a_batch(self):
        page = self.page(self.batch)
        state = json.loads(page.ask("state"))
        self.assertEqual(state["shots"], ["one", "two"])
        self.assertEqual(state["shots_table"], (self.batch / "shots.csv").read_text())
        shot = json.loads(page.ask("state", shot="two"))
        self.assertEqual(shot["clip"]["frames"], 64)
        self.assertEqual(page.ask("file", shot="two", name="track.csv"),
                         (self.batch / "shots" / "two" / "track.csv").read_bytes())

    def test_a_shot_is_left_out_for_a_reason(self):
        page = self.page(self.batch)
        kept = page.post("exclude", {"shot": "one", "reason": "=1+1, \"hit\nthe frame"})["excluded"]
        self.assertEqual(kept, {"one": "'=1+1; 'hit the frame"})
        self.assertEqual(json.loads(self.page(self.batch).ask("state"))["excluded"], kept)
        self.assertEqual(page.post("exclude", {"shot": "one", "reason": ""})["excluded"], {})
        for shot in ("", "none", "../one", "one/.."):
            page.post("exclude", {"shot": shot, "reason": "x"}, status=404)
        self.page(self.shot).post("exclude", {"shot": "one", "reason": "x"}, status=404)

    def test_a_corrected_shot_stays_in_its_batch(self):
        folder = self.root / "corrected"
        shutil.copytree(self.batch, folder)
        shot = folder / "shots" / "one"
        page = self.page(folder)
        given = json.loads(page.ask("state", shot="one"))["given"]
        page.post("run", {"shot": "one", "settings": {**given, "ball-at": "60:none"}, "folder": str(shot), "resume": True})
        status = page.wait_for_run()
        self.assertEqual(status["state"], "done", status)
        self.assertTrue(any(line.startswith("corrected by hand:") for line in status["messages"]), status["messages"])
        run("batch", self.root / "clips", *TRACK, "--no-field", "--resume", "-q", "-o", folder)
        with open(folder / "shots.csv", newline="", encoding="utf-8") as file:
            listed = {row["shot"]: row for row in csv.DictReader(file)}
        self.assertEqual((listed["one"]["frames_ok"], listed["two"]["frames_ok"]), ("63", "64"))
        with open(shot / "track.csv", newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual((rows[60]["status"], rows[60]["by_hand"], rows[61]["by_hand"]), ("no_ball", "3", "0"))
        self.assertIn("60:none", (shot / "job.toml").read_text())

    def test_a_table_that_leads_elsewhere(self):
        forged = self.root / "forged"
        shutil.copytree(self.batch, forged)
        text = (forged / "shots.csv").read_text()
        (forged / "shots.csv").write_text(text.replace(",one,", ",../../shot,", 1))
        page = self.page(forged)
        self.assertEqual(json.loads(page.ask("state"))["shots"], ["two"])
        self.assertEqual(page.get(f"{page.path}api/state?shot=..%2F..%2Fshot")[0], 404)


class Measuring(Case):
    """Set up and run, without a browser."""

    settings = {"ball-diameter-mm": "67", "surface-angle-deg": 30, "inertia-factor": "0.667"}

    def test_wrong_settings_are_one_line(self):
        page = self.page(self.clip)
        for settings in ({"no-such-thing": 1}, {"window": "wide"}, {"window": [1]}, {"window": {}}, [], 3,
                         {"roi": "1,2"}, {"ball-diameter-mm": -1}, {"estimator": "guess"}, {"frames": "9:2"},
                         {"ball-diameter-mm": 67, "mm-per-px": 1}, {"video": "/etc/passwd"}):
            error = page.post("measure", {"frame": 3, "settings": settings}, status=400)["error"]
            self.assertNotIn("\n", error)
        for body in ("", "no JSON", "[]", "[" * 100000, '{"frame": "3"}', '{"frame": 1e99}', '{"frame": 64}', b"\xff{}"):
            page.post("measure", body, status=400)
        for body in ({}, {"folder": ""}, {"folder": 7}, {"folder": "x", "force": "yes"}):
            page.post("run", body, status=400)
        page.post("nothing", {}, status=404)
        self.assertEqual(json.loads(page.ask("run", **{"from": 0}))["state"], "idle")

    def test_a_frame_is_measured_at_once(self):
        page = self.page(self.clip)
        found = page.post("measure", {"frame": 5, "settings": self.settings})
        with open(self.shot / "track.csv", newline="", encoding="utf-8") as file:
            want = list(csv.DictReader(file))[5]
        self.assertEqual(found["row"]["status"], "ok")
        for column in ("cx_px", "cy_px", "r_px", "dx_px", "dy_px"):
            # The run of the whole clip knows its rim and noise better.
            self.assertAlmostEqual(float(found["row"][column]), float(want[column]), delta=0.1)
        self.assertEqual(len(found["windows"]), len(found["columns"]))
        self.assertGreater(len(found["windows"][0]), 30)
        self.assertGreater(found["advice"]["windows"]["usable"], 30)

    def test_a_film_holds_the_frames_asked_for(self):
        page = self.page(self.shot)
        if not json.loads(page.ask("state"))["films"]:
            self.skipTest("this program was built without codecs")
        film = page.ask("film", first=0, end=30, step=3, rate=25)
        self.assertTrue(any(code in film for code in (b"avc1", b"vp09", b"av01")))  # what browsers play
        (self.root / "film.mp4").write_bytes(film)
        said = run("info", self.root / "film.mp4").stdout
        self.assertRegex(said, r"size +160 x 170 px")
        self.assertRegex(said, r"frames +10,")
        self.assertRegex(said, r"frame rate +25 ")
        for wrong in ({"end": 65}, {"end": 0}, {"step": 0}, {"rate": 0}, {"rate": "nan"}):
            query = urllib.parse.urlencode({"first": 0, "end": 30, "step": 3, "rate": 25} | wrong)
            self.assertEqual(page.get(f"{page.path}api/film?{query}")[0], 400, wrong)

    def test_command_and_job_are_those_of_a_run(self):
        page = self.page(self.clip, cwd=self.root)
        asked = {"settings": {**self.settings, "no-checksum": True}, "folder": "it's here"}
        job = page.post("job", asked)
        page.post("run", asked)
        status = page.wait_for_run()
        self.assertEqual((status["state"], len(status["rows"])), ("done", 64), status)
        mine = self.root / "it's here"
        self.assertEqual(job["toml"], (mine / "job.toml").read_text())
        again = self.root / "by command"
        words = shlex.split(job["command"])
        self.assertEqual(words[:4], ["impactdic", "track", str(self.clip), "-o"])
        run("track", self.clip, "-o", again, *words[5:])
        run("track", "--job", mine / "job.toml", "-o", self.root / "by job")
        for folder in (again, self.root / "by job"):
            for name in ("track.csv", "pose.csv"):
                self.assertEqual((folder / name).read_bytes(), (mine / name).read_bytes())
        state = json.loads(page.ask("state"))
        self.assertEqual(state["given"]["ball-diameter-mm"], "67")
        self.assertIn("track.csv", state["files"])

    def test_settings_take_units(self):
        page = self.page(self.clip)
        toml = page.post("job", {"settings": {"ball-diameter-mm": "6.7 cm", "fps": "5kfps", "radius-px": "40:58"}})["toml"]
        for line in ("ball-diameter-mm = 67.0", "fps = 5000.0", "radius-px = '40:58'"):
            self.assertIn(line, toml.splitlines())
        wrong = page.post("job", {"settings": {"ball-diameter-mm": "67kg"}}, status=400)
        self.assertIn("key ball-diameter-mm", json.dumps(wrong))

    def test_a_folder_that_holds_files_is_left_alone(self):
        page = self.page(self.clip)
        before = (self.shot / "track.csv").read_bytes()
        page.post("run", {"settings": {}, "folder": str(self.shot)})
        status = page.wait_for_run()
        self.assertEqual(status["state"], "failed")
        self.assertIn("--force", status["error"])
        self.assertEqual((self.shot / "track.csv").read_bytes(), before)

    def test_stop_and_resume_end_in_the_same_bytes(self):
        page = self.page(self.clip)
        folder = self.root / "stopped"
        asked = {"settings": {**self.settings, "frames": "0:64"}, "folder": str(folder)}
        page.post("run", asked)
        page.post("stop", {})
        status = page.wait_for_run()
        self.assertIn(status["state"], ("stopped", "done"), status)
        page.post("run", {**asked, "resume": True})
        self.assertEqual(page.wait_for_run()["state"], "done")
        # The run of the test's own results has no --frames; its rows are the same.
        self.assertEqual((folder / "track.csv").read_bytes(), (self.shot / "track.csv").read_bytes())

    def test_ctrl_c_keeps_what_a_run_has_measured(self):
        page = self.page(self.clip)
        folder = self.root / "ended"
        page.post("run", {"settings": self.settings, "folder": str(folder)})
        self.assertEqual(page.stop()[0], 0)
        self.assertTrue((folder / "job.toml").exists())
        self.assertFalse((folder / ".impactdic.lock").exists())


if __name__ == "__main__":
    main()
