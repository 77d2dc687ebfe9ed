"""Frames at a camera's pace into `track --live`: how long a row takes after its frame.

Usage: live_pace.py PROGRAM [--rate 2000] [--seconds 10] [--size 128] [--radius 36] [--options="..."]

Synthesises a short clip, sends it over and over at the rate, and prints quantiles of the delay from
a frame's arrival to its row, how many frames were dropped, and how much memory the program took at
a quarter of the time and at the end.
"""

import argparse
import json
import pathlib
import subprocess
import tempfile
import threading
import time


def send(pipe, pixels, frame_bytes, rate, count):
    frames = len(pixels) // frame_bytes
    # There and back, so that the ball never jumps.
    order = list(range(frames)) + list(range(frames - 2, 0, -1))
    begin = time.monotonic()
    for i in range(count):
        wait = begin + i / rate - time.monotonic()
        if wait > 0.0005:
            time.sleep(wait)
        k = order[i % len(order)]
        pipe.write(pixels[k * frame_bytes:(k + 1) * frame_bytes])
        pipe.flush()
    pipe.close()


def resident_kib(pid):
    for line in pathlib.Path(f"/proc/{pid}/status").read_text().splitlines():
        if line.startswith("VmRSS"):
            return int(line.split()[1])
    return 0


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("--rate", type=float, default=2000)
    parser.add_argument("--seconds", type=float, default=10)
    parser.add_argument("--size", type=int, default=128)
    parser.add_argument("--radius", type=float, default=36)
    parser.add_argument("--options", default="", help="of track, as --options=--no-field")
    a = parser.parse_args()
    count = int(a.rate * a.seconds)
    with tempfile.TemporaryDirectory() as scratch:
        subprocess.run([a.program, "synth", "--pattern", "e1", "--size", f"{a.size}x{a.size}",
                        "--radius-px", str(a.radius), "--noise", "1", "--format", "mraw",
                        "--frames", "200", "--velocity-px", "0.05,0.03", "--rotation-deg", "0.4",
                        "-q", "-o", scratch + "/clip"], check=True)
        pixels = pathlib.Path(scratch, "clip/video.mraw").read_bytes()
        program = subprocess.Popen(
            [a.program, "track", "-", "--live", "--raw", f"{a.size}x{a.size}x8", "--fps",
             str(a.rate), *a.options.split()],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        sender = threading.Thread(
            target=send, args=(program.stdin, pixels, a.size * a.size, a.rate, count))
        sender.start()
        delays, dropped, ok, memory = [], 0, 0, []
        for number, line in enumerate(program.stdout):
            if number in (count // 4, count - count // 20):
                memory.append(resident_kib(program.pid))
            row = json.loads(line)
            ok += row["status"] in ("ok", "last_frame")
            if row["status"] == "dropped":
                dropped += 1
            else:
                delays.append(row["delay_s"])
        sender.join()
        status = program.wait()
    delays.sort()
    quantile = {f"p{q}": 1e3 * delays[min(len(delays) - 1, int(q / 100 * len(delays)))]
                for q in (50, 90, 99, 99.9)}
    print(json.dumps({"status": status, "frames": count, "rows": len(delays) + dropped, "ok": ok,
                      "dropped": dropped, "delay_ms": {k: round(v, 2) for k, v in quantile.items()},
                      "longest_ms": round(1e3 * delays[-1], 1), "memory_kib": memory}))


if __name__ == "__main__":
    main()
