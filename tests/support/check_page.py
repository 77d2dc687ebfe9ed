#!/usr/bin/env python3
"""check_page.py PAGE.html [FOLDER]: opens the page in a headless Chromium at desktop and phone width
and prints as JSON what is wrong with it: script errors and console messages, requests that leave
the page, things wider than the screen, figures that were not drawn or say nothing under the mouse.
Screenshots go to FOLDER. Exit status 0: nothing is wrong; 1: something is; 77: no Chromium."""

import base64
import json
import os
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

WIDTHS = {"desktop": (1280, 900, False), "phone": (390, 844, True)}
LONGEST_S = 60

STATE = """({
  width: innerWidth,
  scroll: document.documentElement.scrollWidth,
  panels: document.querySelectorAll('.panel').length,
  meant: Object.keys(panels).length,
  drawn: [...document.querySelectorAll('.panel')].filter(p => p.querySelector('.main-svg') &&
      p._fullLayout && p._fullLayout._size.w > 100).length,
  wide: [...document.querySelectorAll('body *')].filter(e => !e.closest('.scroll, pre, .panel') &&
      e.getBoundingClientRect().right > WIDTH + 1).map(e => e.tagName + '#' + e.id),
  films: [...document.querySelectorAll('video')].filter(v => v.error || v.readyState < 1 ||
      !v.videoWidth).map(v => v.error ? v.error.message : 'not loaded'),
  hidden: WIDTH < 600 ? [...document.querySelectorAll('.scroll')].filter(e =>
      e.scrollWidth > e.clientWidth + 1).map(e => e.textContent.slice(0, 60)) : [],
  nameless: [...document.querySelectorAll('.panel')].filter(p =>
      !p._fullLayout.xaxis.title.text || !p._fullLayout.yaxis.title.text).map(p => p.id),
})"""

# Hovers the middle point of every panel's last trace that answers to the mouse.
SILENT = """[...document.querySelectorAll('.panel')].filter(p => {
  const curves = p.data.map((t, i) => [t, i]).filter(([t]) => t.hoverinfo !== 'skip');
  if (!curves.length) return false;
  const [trace, curve] = curves[curves.length - 1];
  const point = trace.type === 'heatmap' ? [0, 0] : Math.floor(trace.x.length / 2);
  Plotly.Fx.hover(p, [{curveNumber: curve, pointNumber: point}]);
  return !p.querySelector('.hoverlayer').textContent;
}).map(p => p.id)"""


class Browser:
    """A headless Chromium, spoken to over its debugging pipe (Chrome DevTools Protocol)."""

    def __init__(self, program, profile):
        to_browser, self._write = os.pipe()
        self._read, from_browser = os.pipe()

        def pipes():  # the browser reads from descriptor 3 and writes to 4
            for old, new in ((to_browser, 13), (from_browser, 14)):
                os.dup2(old, new)
            os.dup2(13, 3)
            os.dup2(14, 4)

        self._process = subprocess.Popen(
            [program, "--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage",
             "--no-first-run", "--disable-background-networking", f"--user-data-dir={profile}",
             "--remote-debugging-pipe", "about:blank"],
            preexec_fn=pipes, close_fds=False, stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        os.close(to_browser)
        os.close(from_browser)
        self._buffer, self._number, self.events = b"", 0, []
        target = self.call("Target.createTarget", url="about:blank")["targetId"]
        self._session = None
        self._session = self.call("Target.attachToTarget", targetId=target, flatten=True)[
            "sessionId"
        ]

    def close(self):
        self._process.kill()
        self._process.wait()

    def call(self, method, **parameters):
        self._number += 1
        message = {"id": self._number, "method": method, "params": parameters}
        if getattr(self, "_session", None):
            message["sessionId"] = self._session
        os.write(self._write, json.dumps(message).encode() + b"\0")
        while True:
            answer = self._next()
            if answer.get("id") == self._number:
                if "error" in answer:
                    raise RuntimeError(f"{method}: {answer['error']}")
                return answer["result"]
            self.events.append(answer)

    def value(self, expression):
        result = self.call("Runtime.evaluate", expression=expression, returnByValue=True)
        if "exceptionDetails" in result:
            raise RuntimeError(result["exceptionDetails"])
        return result["result"].get("value")

    def _next(self):
        while b"\0" not in self._buffer:
            part = os.read(self._read, 1 << 20)
            if not part:
                raise RuntimeError("the browser has ended")
            self._buffer += part
        message, _, self._buffer = self._buffer.partition(b"\0")
        return json.loads(message)


def noise_of(events, allowed):
    """Errors of scripts, console messages, requests to addresses that begin otherwise."""
    found = []
    for event in events:
        method, parameters = event.get("method"), event.get("params", {})
        if method in ("Runtime.exceptionThrown", "Runtime.consoleAPICalled", "Log.entryAdded"):
            found.append(f"{method}: {json.dumps(parameters)[:400]}")
        if method == "Network.requestWillBeSent":
            url = parameters["request"]["url"]
            if not url.startswith(allowed):
                found.append(f"request: {url[:200]}")
    return found


def problems(browser, page, name, folder):
    width, height, mobile = WIDTHS[name]
    browser.events.clear()
    for domain in ("Page", "Runtime", "Network", "Log"):
        browser.call(f"{domain}.enable")
    browser.call("Emulation.setDeviceMetricsOverride", width=width, height=height,
                 deviceScaleFactor=1, mobile=mobile)
    browser.call("Page.navigate", url=page.resolve().as_uri())
    end = time.monotonic() + LONGEST_S
    while browser.value("document.readyState") != "complete" and time.monotonic() < end:
        time.sleep(0.1)
    time.sleep(0.5)
    state = browser.value(STATE.replace("WIDTH", str(width)))
    found = []
    if state["scroll"] > state["width"] or state["width"] != width:
        found.append(f"{state['scroll']} px wide on a screen of {width} ({state['width']})")
    found += [f"wider than the screen: {e}" for e in state["wide"]]
    if not state["meant"] == state["panels"] == state["drawn"]:
        found.append(f"{state['drawn']} of {state['meant']} panels are drawn")
    found += [f"a film that does not play: {e}" for e in state["films"]]
    found += [f"columns beyond the screen: {e}" for e in state["hidden"]]
    found += [f"an axis without name: {p}" for p in state["nameless"]]
    if folder:
        full = browser.value("document.documentElement.scrollHeight")
        browser.call("Emulation.setDeviceMetricsOverride", width=width, height=min(full, 16000),
                     deviceScaleFactor=1, mobile=mobile)
        time.sleep(0.5)
        picture = browser.call("Page.captureScreenshot", format="png")["data"]
        (folder / f"{name}.png").write_bytes(base64.b64decode(picture))
    found += [f"silent under the mouse: {p}" for p in browser.value(SILENT)]
    found += noise_of(browser.events, ("data:", "blob:", page.resolve().as_uri()))
    return found


def main():
    page = Path(sys.argv[1])
    folder = Path(sys.argv[2]) if len(sys.argv) > 2 else None
    program = shutil.which("chromium") or shutil.which("google-chrome")
    if program is None:
        print("no Chromium on this machine", file=sys.stderr)
        return 77
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile:
        browser = Browser(program, profile)
        try:
            found = {name: problems(browser, page, name, folder) for name in WIDTHS}
        finally:
            browser.close()
    print(json.dumps(found, indent=2))
    return 1 if any(found.values()) else 0


if __name__ == "__main__":
    sys.exit(main())
