"""Figures as PNG and SVG, by matplotlib."""

import io

import matplotlib
import matplotlib.figure
import matplotlib.image
import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.backends.backend_pdf import FigureCanvasPdf
from matplotlib.backends.backend_svg import FigureCanvasSVG

from .figure import with_heads

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
    "pdf.fonttype": 42,  # text stays text that can be edited
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
    """Writes NAME.png, NAME.svg and NAME.pdf into `folder`."""
    made = drawn(figure)
    with matplotlib.rc_context(STYLE):
        made.draw_without_rendering()  # finds the layout,
        made.set_layout_engine("none")  # once for all three
        # Figure.savefig would draw each of them once more to find the layout again.
        for write, metadata in ((FigureCanvasPdf(made).print_pdf, {"CreationDate": None}),
                                (FigureCanvasAgg(made).print_png, {}),
                                (FigureCanvasSVG(made).print_svg, {"Date": None})):
            made.set_dpi(DPI)
            kind = write.__name__.removeprefix("print_")
            write(folder / f"{figure.name}.{kind}", metadata=metadata)


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
        if s.contours and np.nanmax(s.z) > np.nanmin(s.z):
            lines = axis.contour(s.x, s.y, s.z, levels=8, colors="white", linewidths=0.7)
            axis.clabel(lines, fontsize=6)
    for series in panel.series:
        _draw_series(axis, series)
    if panel.reference is not None:
        _draw_reference(axis, panel.reference)
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
        _draw_legend(axis, panel)
    if panel.log_y:
        axis.set_yscale("log")
    if panel.x_names is not None:
        many = {"rotation": 30, "ha": "right"} if len(panel.x_names) > 6 else {}
        axis.set_xticks(range(len(panel.x_names)), panel.x_names, **many)
    if panel.from_zero:
        axis.set_ylim(bottom=0)


def _draw_legend(axis, panel):
    """Swatches are as large and as dark as they must be to be seen."""
    dots = any(s.kind == "markers" and _marker_size(s) < 5 for s in panel.series)
    place = {}
    if len(panel.series) > 5:  # it would cover the curves
        place = {"loc": "upper center", "bbox_to_anchor": (0.5, -0.2), "ncols": 3}
    legend = axis.legend(markerscale=3 if dots else 1, **place)
    for patch in legend.get_patches():
        patch.set(edgecolor="#888888", linewidth=0.6)
    for line in legend.get_lines():
        line.set_linewidth(max(1.6, line.get_linewidth()))


def _draw_reference(axis, arrow):
    x, y = with_heads(np.array([arrow.x, arrow.x + arrow.length, np.nan]),
                      np.array([arrow.y, arrow.y, np.nan]))
    axis.plot(x, y, color="white", lw=3.5)
    axis.plot(x, y, color="black", lw=1)
    axis.annotate(arrow.text, (arrow.x, arrow.y), xytext=(0, 4), textcoords="offset points",
                  fontsize=7, bbox={"fc": "white", "ec": "none", "pad": 1, "alpha": 0.85})


def _marker_size(series):
    return 0.6 * series.size if series.size else 1.5 if len(series.x) > 150 else 5


def _draw_series(axis, s):
    if s.kind == "arrows":
        axis.plot(*with_heads(s.x, s.y), color=s.colour, lw=0.7, label=s.name)
    elif s.kind == "markers":
        x, y = np.asarray(s.x), np.asarray(s.y)
        bars = np.full(len(x), np.nan) if s.sd is None else 1.96 * np.asarray(s.sd)
        look = {"ms": _marker_size(s), "color": s.colour, "lw": 0.8}
        without = ~np.isfinite(bars)  # errorbar would warn of them
        axis.plot(x[without], y[without], MARKERS[s.marker], label=s.name if without.all() else None, **look)
        if not without.all():
            axis.errorbar(x[~without], y[~without], yerr=bars[~without], label=s.name,
                          fmt=MARKERS[s.marker], capsize=2, **look)
    else:
        axis.plot(s.x, s.y, "--" if s.dash else "-", color=s.colour, lw=1.2, label=s.name)
        if s.sd is not None:
            low, high = s.y - 1.96 * s.sd, s.y + 1.96 * s.sd
            axis.fill_between(s.x, low, high, color=s.colour, alpha=0.25, lw=0)
