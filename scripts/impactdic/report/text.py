"""Figures with their deviation, as people read them."""

import math


def with_sd(figure, factor=1.0, unit=""):
    """A figure {"value", "sd"} as text, rounded to two digits of its deviation."""
    if not figure or figure.get("value") is None:
        return "not measured"
    value, sd = factor * figure["value"], figure.get("sd")
    text = (rounded(value, None if sd is None else factor * sd) + " " + unit).strip()
    return text + (" (doubtful)" if figure.get("status") == "doubtful" else "")


def rounded(value, sd=None):
    if not math.isfinite(value):
        return "not measured"
    if not sd or not math.isfinite(sd):
        return f"{value:.6g}"
    sd = float(f"{sd:.1e}")  # two digits, which 0.0999 has as 0.10
    digits = 1 - math.floor(math.log10(sd))
    if digits > 12:
        return f"{value:.6g}"
    shown = max(0, digits)
    return f"{round(value, digits) + 0.0:.{shown}f} ± {sd:.{shown}f}"
