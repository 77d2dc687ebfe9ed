"""Figures as PNG and SVG, by matplotlib."""

import io

import matplotlib
import matplotlib.figure
import matplotlib.image
import numpy as np

MARKERS = {
    "circle": "o",
    "square": "s",
    "diamond": "D",
    "triangle-up": "^",
    "cross": "P",
    "x": "x",
    "star": "*",
}
STYLE = {
    "font.size": 9,
    "axes.grid": True,
    "grid.color": "#DDDDDD",
    "grid.linewidth": 0.6,
    "axes.axisbelow": True,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "legend.frameon": False,
    "legend.fontsize": 8,
    "svg.fonttype": "none",
    "svg.hashsalt": "impactdic",
}
PANEL_INCHES = (4.4, 3.3)
DPI = 150


def drawn(figure):
    """A figure of figure.py as a matplotlib.figure.Figure. It belongs to no backend: the caller's
    own stays as it is."""
    with matplotlib.rc_context(STYLE):
        width, height = PANEL_INCHES
        columns = min(3, len(figure.panels))
        rows = -(-len(figure.panels) // columns)
        size = (width * columns, height * rows)
        made = matplotlib.figure.Figure(figsize=size, layout="constrained")
        axes = made.subplots(rows, columns, squeeze=False)
        for axis, panel in zip(axes.flat, figure.panels):
            _draw_panel(axis, panel)
        for axis in list(axes.flat)[len(figure.panels) :]:
            axis.axis("off")
        made.suptitle(figure.title)
    return made


def save(figure, folder):
    """Writes NAME.png and NAME.svg into `folder`."""
    made = drawn(figure)
    with matplotlib.rc_context(STYLE):
        made.savefig(folder / f"{figure.name}.png", dpi=DPI)
        made.savefig(folder / f"{figure.name}.svg", dpi=DPI, metadata={"Date": None})


def png_of(grey):
    """A grey picture as the bytes of a PNG file."""
    file = io.BytesIO()
    matplotlib.image.imsave(file, grey, cmap="gray", vmin=0, vmax=255, format="png")
    return file.getvalue()


def _draw_panel(axis, panel):
    for span in panel.spans:
        axis.axvspan(span.start, span.end, color=span.colour, lw=0, label=span.name, zorder=0)
    if panel.picture is not None:
        height, width = panel.picture.grey.shape
        x, y = panel.picture.x_px - 0.5, panel.picture.y_px - 0.5
        extent = (x, x + width, y + height, y)
        axis.imshow(panel.picture.grey, cmap="gray", vmin=0, vmax=255, extent=extent)
        axis.grid(False)
    if panel.surface is not None:
        s = panel.surface
        mesh = axis.pcolormesh(s.x, s.y, s.z, shading="nearest", cmap="viridis", rasterized=True)
        axis.figure.colorbar(mesh, ax=axis, label=s.name)
    for series in panel.series:
        _draw_series(axis, series)
    axis.set(xlabel=panel.x_label, ylabel=panel.y_label, title=panel.title)
    if panel.same_scale:
        axis.set_aspect("equal", adjustable="box" if panel.picture is not None else "datalim")
    if panel.y_down and panel.picture is None:
        axis.invert_yaxis()
    if panel.picture is not None:
        height, width = panel.picture.grey.shape
        axis.set_xlim(panel.picture.x_px - 0.5, panel.picture.x_px + width - 0.5)
        axis.set_ylim(panel.picture.y_px + height - 0.5, panel.picture.y_px - 0.5)
    elif len(panel.series) + len(panel.spans) > 1:
        axis.legend()
    if panel.from_zero:
        axis.set_ylim(bottom=0)


def _draw_series(axis, s):
    if s.kind == "arrows":
        axis.plot(s.x, s.y, color=s.colour, lw=0.7)
    elif s.kind == "markers":
        size = 1.5 if len(s.x) > 150 else 5
        bars = None if s.sd is None else 1.96 * np.asarray(s.sd)
        look = {"fmt": MARKERS[s.marker], "ms": size, "color": s.colour, "lw": 0.8, "capsize": 2}
        axis.errorbar(s.x, s.y, yerr=bars, label=s.name, **look)
    else:
        axis.plot(s.x, s.y, "--" if s.dash else "-", color=s.colour, lw=1.2, label=s.name)
        if s.sd is not None:
            low, high = s.y - 1.96 * s.sd, s.y + 1.96 * s.sd
            axis.fill_between(s.x, low, high, color=s.colour, alpha=0.25, lw=0)
