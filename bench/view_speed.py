#!/usr/bin/env python3
"""view_speed.py PROGRAM FOLDER [--gigabytes G]: how quickly impactdic view shows large clips.

Makes a .mraw and a .cine of 512 x 512 px and G gigabytes (5) in FOLDER unless they are there, and
prints for each, as JSON: seconds from the start of the program to the first picture, pictures a second
one after the other and at random places (four connections), the page's own pictures a second in
Chromium where there is one, and the program's largest memory. With a third clip that has texture: how
long a frame takes to be measured again after a setting has changed, warm."""

import argparse
import http.client
import json
import os
import random
import shutil
import statistics
import struct
import subprocess
import sys
import time
import urllib.parse
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests" / "support" / "page"))

SIZE = 512
BYTES = SIZE * SIZE


def synth(program, folder, *options):
    if not folder.exists():
        subprocess.run([program, "synth", "--pattern", "f1", "--noise", "2", "--size", f"{SIZE}x{SIZE}",
                        "-q", "-o", folder, *options], check=True)
    return folder


def long_mraw(program, folder, frames):
    """Frames of a short clip, over and over."""
    made = synth(program, folder / "mraw", "--frames", "20", "--format", "mraw")
    pixels, header = next(made.glob("*.mraw")), next(made.glob("*.cihx"))
    if pixels.stat().st_size < frames * BYTES:
        some = pixels.read_bytes()
        with open(pixels, "r+b") as file:
            for _ in range(frames // 20):
                file.write(some)
        text = header.read_bytes().replace(b"<totalFrame>20<", f"<totalFrame>{frames}<".encode())
        header.write_bytes(text)
    return header


def long_cine(program, folder, frames):
    made = synth(program, folder / "cine", "--frames", "20", "--format", "cine")
    path = made / "long.cine"
    if not path.exists():
        some = (made / "video.cine").read_bytes()
        (table,) = struct.unpack_from("<I", some, 32)
        first = struct.unpack_from("<q", some, table)[0]
        annotation = struct.unpack_from("<I", some, first)[0]
        each = annotation + BYTES
        head = bytearray(some[:table])
        struct.pack_into("<I", head, 12, frames)
        struct.pack_into("<I", head, 20, frames)
        head = without_times(head)
        struct.pack_into("<I", head, 32, len(head))
        start = len(head) + 8 * frames
        one = some[first:first + each]
        with open(path, "wb") as file:
            file.write(head)
            file.write(b"".join(struct.pack("<q", start + k * each) for k in range(frames)))
            for k in range(frames):
                at = struct.unpack_from("<q", some, table + 8 * (k % 20))[0]
                file.write(some[at:at + each] if one else b"")
    return path


def without_times(head):
    """The header without its tagged blocks, which hold a time for each of the few frames."""
    setup = struct.unpack_from("<I", head, 28)[0]
    length = struct.unpack_from("<H", head, setup + 142)[0]
    return head[:setup + length]


class Page:
    def __init__(self, program, clip):
        self.begun = time.monotonic()
        self.process = subprocess.Popen([program, "view", clip, "--no-browser"], stdout=subprocess.PIPE, text=True)
        self.address = self.process.stdout.readline().strip()
        parts = urllib.parse.urlsplit(self.address)
        self.port, self.path = parts.port, parts.path

    def connect(self):
        return http.client.HTTPConnection("127.0.0.1", self.port, timeout=60)

    def get(self, link, name, body=None):
        link.request("GET" if body is None else "POST", f"{self.path}api/{name}", body)
        answer = link.getresponse()
        data = answer.read()
        if answer.status != 200:
            raise RuntimeError(data[:300])
        return data

    def processor_s(self):
        fields = Path(f"/proc/{self.process.pid}/stat").read_text().rpartition(")")[2].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")

    def memory_mb(self):
        with open(f"/proc/{self.process.pid}/status", encoding="ascii") as file:
            return int(next(line for line in file if line.startswith("VmHWM")).split()[1]) / 1024

    def stop(self):
        self.process.send_signal(2)
        self.process.wait(30)


def rate(page, frames):
    links = [page.connect() for _ in range(4)]

    def fetch(k):
        for frame in frames[k::4]:
            page.get(links[k], f"frame?frame={frame}")
    begun = time.monotonic()
    with ThreadPoolExecutor(4) as pool:
        list(pool.map(fetch, range(4)))
    return len(frames) / (time.monotonic() - begun)


def in_browser(page):
    from page_browser import PageBrowser, find_chromium
    if find_chromium() is None:
        return None
    browser = PageBrowser()
    try:
        browser.open(page.address, 1280, 900)
        browser.wait("document.documentElement?.dataset?.ready === 'yes'")
        browser.value("document.getElementById('speed').value = '60'; document.getElementById('speed').onchange()")
        browser.value("document.getElementById('play').click()")
        time.sleep(1)
        frame = "Number(document.getElementById('frame').value)"
        first, begun = browser.value(frame), time.monotonic()
        time.sleep(4)
        return (browser.value(frame) - first) / (time.monotonic() - begun)
    finally:
        browser.close()


def look_at(program, clip, frames):
    page = Page(program, clip)
    try:
        page.get(page.connect(), "frame?frame=0")
        first = time.monotonic() - page.begun
        draw = random.Random(1)
        row = {"clip": clip.name, "gigabytes": frames * BYTES / 1e9, "first_picture_s": first,
               "in_order_per_s": rate(page, list(range(300))),
               "at_random_per_s": rate(page, [draw.randrange(frames) for _ in range(300)]),
               "page_per_s": in_browser(page)}
        return {**row, "memory_mb": page.memory_mb()}
    finally:
        page.stop()


def measure_again(program, folder):
    clip = next(synth(program, folder / "ball", "--frames", "20", "--format", "cine").glob("video.cine"))
    page = Page(program, clip)
    try:
        link, row = page.connect(), {}
        times = {"outline": [], "all": [], "processor": []}
        for k in range(20):  # the first ones compile kernels
            asked = {"frame": 3, "settings": {"window": 15 + 2 * (k % 3)}}
            begun, worked = time.monotonic(), page.processor_s()
            for name in ("outline", "all"):  # as the page does
                page.get(link, "measure", json.dumps({**asked, "outline": name == "outline"}))
                times[name].append(1e3 * (time.monotonic() - begun))
            times["processor"].append(1e3 * (page.processor_s() - worked))
        for name, values in times.items():
            row[name] = {"median": statistics.median(values[6:]), "least": min(values[6:]), "largest": max(values[6:])}
        return {"measured_again_ms": row}
    finally:
        page.stop()


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("program")
    parser.add_argument("folder", type=Path)
    parser.add_argument("--gigabytes", type=float, default=5)
    asked = parser.parse_args()
    program = shutil.which(asked.program) or asked.program
    asked.folder.mkdir(parents=True, exist_ok=True)
    frames = int(asked.gigabytes * 1e9 / BYTES) // 20 * 20
    for make in (long_mraw, long_cine):
        print(json.dumps(look_at(program, make(program, asked.folder, frames), frames)), flush=True)
    print(json.dumps(measure_again(program, asked.folder)))


if __name__ == "__main__":
    main()
