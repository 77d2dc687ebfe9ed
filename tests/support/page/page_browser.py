"""A headless Chromium for tests of pages: opens, waits, clicks, types, and says what went wrong."""

import base64
import io
import json
import shutil
import sys
import tempfile
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from check_page import Browser, noise_of  # noqa: E402

LONGEST_S = 90  # on a machine whose cores are all busy


def find_chromium():
    return shutil.which("chromium") or shutil.which("google-chrome")


class PageBrowser(Browser):
    def __init__(self):
        self._profile = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
        super().__init__(find_chromium(), self._profile.name)
        for domain in ("Page", "Runtime", "Network", "Log"):
            self.call(f"{domain}.enable")
        self._origin = ""

    def close(self):
        super().close()
        self._profile.cleanup()

    def open(self, address, width, height):
        self.call("Page.navigate", url="about:blank")  # ends what the page before still asks for
        self.wait("location.href === 'about:blank'")
        self._origin = address
        self.events.clear()
        self.resize(width, height)
        self.call("Page.navigate", url=address)

    def resize(self, width, height):
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1,
                  mobile=width < 500)

    def wait(self, expression, longest_s=LONGEST_S):
        """Until the expression is true. What it throws meanwhile counts as false."""
        end = time.monotonic() + longest_s
        while time.monotonic() < end:
            if self.value(f"(() => {{ try {{ return Boolean({expression}); }} catch {{ return false; }} }})()"):
                return
            time.sleep(0.05)
        raise AssertionError(f"not within {longest_s} s: {expression}; "
                             f"{self.value('document.body.innerText.slice(0, 600)')}; {self.problems()}")

    def settle(self):
        """Until two pictures of the screen have been drawn: what has changed is laid out."""
        self.value("document.documentElement.dataset.drawn = ''; requestAnimationFrame(() => requestAnimationFrame("
                   "() => { document.documentElement.dataset.drawn = 'yes'; }))")
        self.wait("document.documentElement.dataset.drawn === 'yes'")

    def mouse(self, kind, x, y, **more):
        self.call("Input.dispatchMouseEvent", type=kind, x=x, y=y, button="left", **more)

    def click(self, x, y):
        self.mouse("mousePressed", x, y, clickCount=1, buttons=1)
        self.mouse("mouseReleased", x, y, clickCount=1)

    def drag(self, x0, y0, x1, y1):
        self.mouse("mousePressed", x0, y0, clickCount=1, buttons=1)
        for share in (0.25, 0.5, 0.75, 1):
            self.mouse("mouseMoved", x0 + share * (x1 - x0), y0 + share * (y1 - y0), buttons=1)
        self.mouse("mouseReleased", x1, y1, clickCount=1)

    def key(self, key):
        text = {"text": key} if len(key) == 1 else {}
        code = {" ": "Space"}.get(key, key)
        number = {"Tab": 9, "Enter": 13, " ": 32}.get(key)  # what the browser itself acts on
        numbers = {"windowsVirtualKeyCode": number} if number else {}
        if key == "Enter":
            text = {"text": "\r"}
        self.call("Input.dispatchKeyEvent", type="keyDown", key=key, code=code, **text, **numbers)
        self.call("Input.dispatchKeyEvent", type="keyUp", key=key, code=code, **numbers)

    def tab_to(self, name, most=200):
        """Presses the tabulator key until the element of that id has the focus."""
        for _ in range(most):
            if self.value("document.activeElement?.id ?? ''") == name:
                return
            self.key("Tab")
        raise AssertionError(f"{name} cannot be reached with the tabulator key")

    def picture(self):
        """What is on the screen: (height, width, 3 or 4) of 0 to 1."""
        import matplotlib.image

        shot = self.call("Page.captureScreenshot", format="png")["data"]
        return matplotlib.image.imread(io.BytesIO(base64.b64decode(shot)))

    def forget(self, message):
        """Leaves out the errors that a test has made on purpose."""
        self.events = [e for e in self.events if message not in json.dumps(e)]

    def problems(self):
        """Errors of scripts, console messages, requests that leave the page's address."""
        return noise_of(self.events, ("data:", "blob:", self._origin))
