"""A running impactdic view, and the clip and results that the tests of its page share.
IMPACTDIC_PROGRAM names the program."""

import http.client
import json
import os
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time
import unittest
import urllib.parse
from pathlib import Path

PROGRAM = os.environ["IMPACTDIC_PROGRAM"]
JOB = """normal = "linear_spring_damper"
friction = "coulomb"
[body]
shape = "hollow_sphere"
mass_kg = 0.0567
diameter_m = 0.067
[contact]
stiffness_n_per_m = 12526.0
damping_n_s_per_m = 6.85
friction_kinetic = 0.0941
[surface]
angle_deg = 30.0
[initial]
vt_m_s = -1.81
vn_m_s = -3.52
"""
RESTITUTION = 0.8284582418143385  # of this job, by impactdic simulate
CONTACT_MS = 6.459564
TRACK = ["--ball-diameter-mm", "67", "--surface-angle-deg", "30", "--inertia-factor", "0.667"]
SYNTH = ["--pattern", "f1", "--noise", "2", "--size", "160x170", "--radius-px", "48", "--fps", "5000",
         "--frames", "64", "--touch-frame", "14.37"]
NO_PAGE = 77  # exit status: this program was built without its page


def run(*arguments, status=0):
    done = subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True)
    if done.returncode != status:
        raise AssertionError(f"{arguments}: {done.returncode}, {done.stderr}")
    return done


class Page:
    """A running impactdic view."""

    def __init__(self, target, *options, cwd=None):
        self.process = subprocess.Popen(
            [PROGRAM, "view", str(target), "--no-browser", *options], stdout=subprocess.PIPE,
            stderr=subprocess.PIPE, text=True, cwd=cwd)
        self.address = self.process.stdout.readline().strip()
        if not self.address:
            raise AssertionError(self.process.stderr.read())
        parts = urllib.parse.urlsplit(self.address)
        self.port, self.path = parts.port, parts.path

    def get(self, path, headers=None, method="GET", body=None):
        """(status, headers, body) of a request by its full path."""
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=20)
        try:
            connection.request(method, path, body=body, headers=headers or {})
            answer = connection.getresponse()
            return answer.status, answer.headers, answer.read()
        finally:
            connection.close()

    def ask(self, what, /, **query):
        status, _, body = self.get(f"{self.path}api/{what}?{urllib.parse.urlencode(query)}")
        if status != 200:
            raise AssertionError(f"{what}: {status} {body[:300]}")
        return body

    def post(self, what, body, status=200):
        """What a request that may change something is answered."""
        text = body if isinstance(body, (str, bytes)) else json.dumps(body)
        got, _, answer = self.get(f"{self.path}api/{what}", method="POST", body=text)
        if got != status:
            raise AssertionError(f"{what}: {got} {answer[:300]}")
        return json.loads(answer)

    def wait_for_run(self, longest_s=120):
        end = time.monotonic() + longest_s
        while (status := json.loads(self.ask("run", **{"from": 0})))["state"] == "running":
            if time.monotonic() > end:
                raise AssertionError(f"still at work: {status['done']} of {status['total']}")
            time.sleep(0.1)
        return status

    def send(self, data, ends=True):
        """Whatever comes back of raw bytes; `ends`: nothing follows them."""
        with socket.create_connection(("127.0.0.1", self.port), timeout=20) as link:
            try:
                link.sendall(data)
                if ends:
                    link.shutdown(socket.SHUT_WR)
                back = b""
                while part := link.recv(1 << 16):
                    back += part
                return back
            except (ConnectionResetError, BrokenPipeError):
                return b""

    def stop(self):
        self.process.send_signal(signal.SIGINT)
        status = self.process.wait(30)
        errors = self.process.stderr.read()
        self.process.stdout.close()
        self.process.stderr.close()
        return status, errors


class Case(unittest.TestCase):
    """Clip and results that all cases share."""

    root = None  # a folder; set by main

    @classmethod
    def setUpClass(cls):
        cls.clip, cls.shot = cls.root / "clip" / "video.cine", cls.root / "shot"

    def page(self, target, *options, cwd=None):
        page = Page(target, *options, cwd=cwd)

        def stop():
            if page.process.poll() is None:
                page.stop()
        self.addCleanup(stop)
        return page


def set_up(root):
    """Clip and results; False where the program has no page."""
    (root / "impact.toml").write_text(JOB)
    run("synth", "--simulate", root / "impact.toml", *SYNTH, "--format", "cine", "-q", "-o", root / "clip")
    done = subprocess.run([PROGRAM, "view", root / "none", "--no-browser"], capture_output=True, text=True)
    if "without its page" in done.stderr:
        return False
    run("track", root / "clip" / "video.cine", *TRACK, "-q", "-o", root / "shot")
    return True


def make_batch(case):
    """The results of two clips, once for all cases of a program."""
    folder = case.root / "batch"
    if not folder.exists():
        clips = case.root / "clips"
        clips.mkdir()
        for name in ("one", "two"):
            shutil.copy(case.clip, clips / f"{name}.cine")
        run("batch", clips, *TRACK, "--no-field", "-q", "-o", folder)
    return folder


def main():
    with tempfile.TemporaryDirectory(prefix="impactdic_view_") as made:
        Case.root = Path(made)
        if not set_up(Case.root):
            print("this program was built without its page", file=sys.stderr)
            sys.exit(NO_PAGE)
        unittest.main(module="__main__")
