"""What a figure shows, apart from how it is drawn: draw.py makes PNG and SVG of it, page.py a
figure that answers to the mouse."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

# Okabe and Ito (2008): told apart with every kind of colour vision.
BLUE, ORANGE, GREEN, RED = "#0072B2", "#E69F00", "#009E73", "#D55E00"
PURPLE, SKY, BLACK = "#CC79A7", "#56B4E9", "#222222"
COLOURS = [BLUE, RED, GREEN, ORANGE, PURPLE, SKY, BLACK]
MARKERS = ["circle", "square", "diamond", "triangle-up", "cross", "x", "star"]


@dataclass
class Series:
    """Points of one curve. `sd`: one standard deviation of y, drawn as a band of 95 % around a line
    and as bars on markers."""

    name: str
    x: np.ndarray
    y: np.ndarray
    sd: np.ndarray | None = None
    colour: str = BLUE
    kind: str = "line"  # or "markers"; "arrows": pairs of start and end, NaN between them
    marker: str = "circle"
    dash: bool = False
    size: float | None = None  # of the markers, px; by their number where it is not given
    labels: list | None = None  # said of each point when the mouse is on it


@dataclass
class Reference:
    """An arrow of a known length, to read the others by; it points to the right from (x, y)."""

    x: float
    y: float
    length: float
    text: str


@dataclass
class Span:
    """A shaded part of the x axis."""

    start: float
    end: float
    name: str
    colour: str


@dataclass
class Picture:
    """A grey picture behind the curves; pixel (0, 0) has its centre at (x_px, y_px)."""

    grey: np.ndarray  # (height, width), 8 bits
    x_px: float = 0
    y_px: float = 0


@dataclass
class Surface:
    """Values on a grid, as colours; z has the shape (len(y), len(x))."""

    x: np.ndarray
    y: np.ndarray
    z: np.ndarray
    name: str  # with unit
    contours: bool = False  # lines of equal value over the colours


@dataclass
class Panel:
    title: str
    x_label: str  # with unit
    y_label: str
    series: list[Series] = field(default_factory=list)
    spans: list[Span] = field(default_factory=list)
    picture: Picture | None = None
    surface: Surface | None = None
    reference: Reference | None = None
    same_scale: bool = False  # of both axes
    y_down: bool = False
    from_zero: bool = False  # the y axis starts at 0
    log_y: bool = False
    x_names: list | None = None  # of the places 0, 1, … on the x axis


@dataclass
class Figure:
    """Panels side by side. `name` is that of its files."""

    name: str
    title: str
    caption: str
    panels: list[Panel]
    section: str = "Motion"


def arrow_pairs(x, y, u, v):
    """The x and y of a series of kind "arrows": arrows from (x, y) along (u, v)."""
    gap = np.full(len(x), np.nan)
    return (np.column_stack([x, x + u, gap]).ravel(), np.column_stack([y, y + v, gap]).ravel())


def with_heads(x, y):
    """The arrows of a series as lines with heads of a third of their length."""
    x0, x1, y0, y1 = x[0::3], x[1::3], y[0::3], y[1::3]
    u, v = (x1 - x0) / 3, (y1 - y0) / 3
    gap = np.full(len(x0), np.nan)
    return (
        np.column_stack([x0, x1, x1 - u + v / 2, x1, x1 - u - v / 2, gap]).ravel(),
        np.column_stack([y0, y1, y1 - v - u / 2, y1, y1 - v + u / 2, gap]).ravel(),
    )


def thinned(x, y, most):
    """Which of the places on a grid to keep, so that at most about `most` are left, evenly."""
    every = int(np.ceil(np.sqrt(len(x) / most)))
    return np.isin(x, np.unique(x)[::every]) & np.isin(y, np.unique(y)[::every])


def one_digit_below(value):
    """The number of one digit at or below `value`."""
    power = 10.0 ** np.floor(np.log10(value))
    return power * np.floor(value / power * 1.0001)


def round_below(value):
    """The 1, 2 or 5 times a power of ten at or below `value`."""
    power = 10.0 ** np.floor(np.log10(value))
    return power * max(step for step in (1, 2, 5) if step * power <= value * 1.0001)
