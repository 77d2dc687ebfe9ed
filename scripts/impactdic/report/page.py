"""The page: one HTML file that needs nothing else, figures by plotly."""

import base64
import html
import json
import re

import numpy as np

from . import screen
from .draw import png_of
from .figure import with_heads

MARGIN = {"l": 62, "r": 14, "t": 34, "b": 48}
GRID = "#E4E4E4"

# Nothing may be fetched, whatever a script asks for.
POLICY = "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; " \
         "img-src data: blob:; media-src data:"

STYLE = """
:root { font: 16px/1.5 system-ui, sans-serif; color: #222; background: #fff; }
body { margin: 0 auto; max-width: 1240px; padding: 0 16px 48px; overflow-wrap: anywhere; }
h1 { font-size: 1.7rem; margin: 24px 0 4px; }
h2 { font-size: 1.3rem; margin: 40px 0 8px; border-bottom: 1px solid #ccc; }
h3 { font-size: 1.05rem; margin: 24px 0 4px; }
nav a { margin-right: 14px; }
a { color: #0072B2; }
figure { margin: 0 0 16px; }
figcaption { color: #555; font-size: .9rem; }
.panels { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(100%, 340px), 1fr));
  gap: 8px; }
.panel { height: 340px; min-width: 0; }
.wide .panel { height: 400px; }
.square .panel { height: 420px; }
.panel.tall { height: 440px; }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; font-size: .92rem; font-variant-numeric: tabular-nums; }
th, td { text-align: left; vertical-align: top; padding: 4px 18px 4px 0;
  border-bottom: 1px solid #e4e4e4; }
th { white-space: nowrap; overflow-wrap: normal; }
td { min-width: 6.5em; }
.warnings { background: #FFF6E5; border-left: 4px solid #E69F00; padding: 8px 16px; }
.warnings ul { margin: 0; padding-left: 20px; }
pre { background: #f5f5f5; padding: 12px; white-space: pre-wrap; font-size: .85rem; }
@media (max-width: 600px) {
  body { padding: 0 10px 32px; } .panel { height: 300px; }
  .scroll table { width: 100%; }
  th { white-space: normal; }
  th:first-child:nth-last-child(2) { min-width: 9.5em; }
  td { min-width: 0; }
  th, td { padding-right: 8px; overflow-wrap: anywhere; }
  /* A wide table becomes a list of its rows: no column hides beyond the screen's edge. */
  .many thead { display: none; }
  .many, .many tbody, .many tr, .many td, .many th { display: block; border: 0; padding: 0; }
  .many tr { border-bottom: 1px solid #ccc; padding: 6px 0; }
  .many td { display: flex; gap: 12px; min-width: 0; }
  .many td:empty { display: none; }
  .many td::before { content: attr(data-name); flex: 0 0 45%; color: #555; }
}
"""

SCRIPT = """
"use strict";
const config = {responsive: true, displaylogo: false,
                displayModeBar: matchMedia("(hover: hover)").matches ? "hover" : false,
                modeBarButtonsToRemove: ["lasso2d", "select2d"]};
// A legend stands below the axis' name, whatever the height of the panel.
const lower = panel => panel.layout.showlegend &&
  Plotly.relayout(panel, {"legend.y": -52 / panel._fullLayout._size.h});
for (const [id, panel] of Object.entries(panels)) {
  Plotly.newPlot(id, panel.data, panel.layout, config).then(lower);
}
"""


# Of the page, in their order.
SECTIONS = ["Figures of the impact", "Clip", "Texture", "Tables", "Shots", "Frames",
            "Displacement field", "Study", "Motion",
            "Contact", "Many shots", "Models", "Quality", "Run", "Job", "Versions"]


def write(path, title, first, subtitle, warnings, figures, tables, texts):
    """Writes the page. `first`: of first.py; `figures`: of figure.py; `tables`: of tables.py;
    `texts`: (section, text) set as they are."""
    panels = {}
    sections = {name: [] for name in SECTIONS}
    for table in tables:
        sections[table.section].append(_table(table))
    for figure in figures:
        sections[figure.section].append(_figure(figure, panels))
    for name, text in texts:
        sections[name].append(f"<pre>{html.escape(text)}</pre>")
    sections = {name: bodies for name, bodies in sections.items() if bodies}
    # No text can end the script or begin a comment in it.
    data = json.dumps(panels, separators=(",", ":"), allow_nan=False).replace("<", "\\u003c")
    links = "\n".join(f'<a href="#{_id(s)}">{html.escape(s)}</a>' for s in sections)
    parts = [
        '<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">',
        f'<meta http-equiv="Content-Security-Policy" content="{POLICY}">',
        '<meta name="viewport" content="width=device-width, initial-scale=1">',
        f"<title>{html.escape(title)}</title>\n<style>{STYLE}{screen.STYLE}</style>",
        f"<script>{plotly_script()}</script>\n</head>\n<body>",
        f"<h1>{html.escape(title)}</h1>",
        screen.first_screen(first),
        _warnings(warnings),
        f"<p>{html.escape(subtitle)}</p>\n<nav>{links}</nav>",
    ]
    for name, bodies in sections.items():
        parts.append(f'<section>\n<h2 id="{_id(name)}">{html.escape(name)}</h2>')
        parts += bodies + ["</section>"]
    parts.append(f"<script>const panels = {data};{SCRIPT}</script>\n</body>\n</html>\n")
    path.write_text("\n".join(parts), encoding="utf-8")


def plotly_script():
    """plotly.js, without the white space that makes up a third of it."""
    import plotly.offline
    import rjsmin

    # A number that ends in its point at the end of a line would swallow the next word.
    script = re.sub(r"(?<![\w$])(\d+)\.(?=[ \t]*\r?\n)", r"\1", plotly.offline.get_plotlyjs())
    return rjsmin.jsmin(script).replace("</script", "<\\/script")


def _id(name):
    return re.sub(r"[^a-z0-9]+", "-", name.lower())


def _warnings(warnings):
    if not warnings:
        return ""
    items = "".join(f"<li>{html.escape(w)}</li>" for w in warnings)
    return f'<div class="warnings"><ul>{items}</ul></div>'


def _table(table):
    head = ""
    if any(table.header):
        head = "<thead><tr>" + "".join(f'<th scope="col">{html.escape(c)}</th>'
                                       for c in table.header) + "</tr></thead>"
    body, many = "", ' class="many"' if len(table.header) > 3 else ""
    for row in table.rows:
        cells = "".join(f'<td data-name="{html.escape(name)}">{html.escape(c)}</td>'
                        for name, c in zip(table.header[1:], row[1:]))
        body += f'<tr><th scope="row">{html.escape(row[0])}</th>{cells}</tr>\n'
    return (f"<h3>{html.escape(table.title)}</h3>\n"
            f'<div class="scroll"><table{many}>{head}<tbody>{body}</tbody></table></div>')


def _figure(figure, panels):
    divs = ""
    for i, panel in enumerate(figure.panels):
        name = f"{_id(figure.name)}-{i + 1}"
        panels[name] = {"data": _data(panel), "layout": _layout(panel)}
        tall = " tall" if len(panel.series) > 4 else ""  # the names of its curves take lines
        divs += f'<div class="panel{tall}" id="{name}"></div>'
    shape = "wide" if len(figure.panels) == 1 else ""
    if figure.panels[0].picture is not None:
        shape = "square"
    return (f'<figure class="{shape}">\n<h3>{html.escape(figure.title)}</h3>\n'
            f'<div class="panels">{divs}</div>\n'
            f"<figcaption>{html.escape(figure.caption)}</figcaption>\n</figure>")


def _numbers(values, digits=7):
    """For JSON: null for what is not finite, and no more digits than are drawn."""
    return [float(f"{v:.{digits}g}") if np.isfinite(v) else None for v in np.asarray(values, float)]


def _data(panel):
    data = []
    if panel.surface is not None:
        s = panel.surface
        kind = {"type": "contour", "contours": {"coloring": "heatmap", "showlabels": True},
                "ncontours": 10, "line": {"color": "white", "width": 1}} if s.contours else {
                    "type": "heatmap"}
        data.append({
            **kind, "x": _numbers(s.x), "y": _numbers(s.y),
            "z": [_numbers(row, 5) for row in s.z], "colorscale": "Viridis",
            "colorbar": {"title": {"text": s.name, "side": "right"}, "thickness": 12},
            "hovertemplate": f"%{{x}}<br>%{{y}}<br>{s.name} %{{z}}<extra></extra>",
        })
    for series in panel.series:
        data += _band(series)
        data.append(_trace(panel, series))
    if panel.reference is not None:
        data += _reference(panel.reference)
    return data


def _reference(arrow):
    x, y = with_heads(np.array([arrow.x, arrow.x + arrow.length, np.nan]),
                      np.array([arrow.y, arrow.y, np.nan]))
    common = {"type": "scatter", "mode": "lines", "x": _numbers(x), "y": _numbers(y),
              "hoverinfo": "skip", "showlegend": False}
    return [{**common, "line": {"color": "#fff", "width": 5}},
            {**common, "line": {"color": "#000", "width": 1.6}}]


def _band(s):
    if s.sd is None or s.kind != "line":
        return []
    known = np.isfinite(s.y) & np.isfinite(s.sd)
    common = {"x": _numbers(s.x), "mode": "lines", "line": {"width": 0}, "hoverinfo": "skip",
              "showlegend": False, "legendgroup": s.name, "type": "scatter"}
    low = np.where(known, s.y - 1.96 * s.sd, np.nan)
    high = np.where(known, s.y + 1.96 * s.sd, np.nan)
    return [
        {**common, "y": _numbers(low)},
        {**common, "y": _numbers(high), "fill": "tonexty", "fillcolor": _faint(s.colour)},
    ]


def _faint(colour):
    red, green, blue = (int(colour[i : i + 2], 16) for i in (1, 3, 5))
    return f"rgba({red},{green},{blue},0.22)"


def _trace(panel, s):
    trace = {"type": "scatter", "x": _numbers(s.x), "y": _numbers(s.y), "name": html.escape(s.name),
             "legendgroup": s.name}
    if s.kind == "markers":
        size = s.size or (4 if len(s.x) > 150 else 8)
        trace |= {"mode": "markers",
                  "marker": {"color": s.colour, "symbol": s.marker, "size": size}}
        if s.sd is not None:
            trace["error_y"] = {"array": _numbers(1.96 * np.asarray(s.sd), 4), "width": 3,
                                "thickness": 1}
    else:
        trace |= {"mode": "lines", "line": {"color": s.colour, "width": 1.6,
                                            "dash": "dash" if s.dash else "solid"}}
    if s.kind == "arrows":
        x, y = with_heads(s.x, s.y)
        return trace | {"x": _numbers(x), "y": _numbers(y), "hoverinfo": "skip",
                        "showlegend": False}
    value = "%{y:.6g}"
    if s.sd is not None:
        trace["customdata"] = _numbers(s.sd, 2)
        value += " ± %{customdata}"
    if s.labels is not None:
        trace["text"] = [html.escape(label) for label in s.labels]
        value += "<br>%{text}"
    if _by_time(panel):
        trace["hovertemplate"] = f"{html.escape(s.name)} {value}<extra></extra>"
    else:
        trace["hovertemplate"] = f"{html.escape(s.name)}<br>%{{x:.6g}}, {value}<extra></extra>"
    return trace


def _by_time(panel):
    """All curves are read at once, at one instant."""
    return panel.x_label.startswith("time") and len(panel.series) <= 8


def _layout(panel):
    axis = {"gridcolor": GRID, "zeroline": False, "showline": True, "linecolor": "#888",
            "exponentformat": "power"}
    layout = {
        "margin": MARGIN,
        "title": {"text": panel.title, "font": {"size": 14}, "x": 0.5, "y": 0.97},
        "font": {"size": 12},
        "xaxis": {**axis, "title": {"text": panel.x_label}},
        # The margin below holds one line; on a phone two axes that both ask for room take turns.
        "yaxis": {**axis, "title": {"text": panel.y_label, "standoff": 8}, "automargin": True},
        "hovermode": "x unified" if _by_time(panel) else "closest",
        "paper_bgcolor": "#fff",
        "plot_bgcolor": "#fff",
        "showlegend": 1 < len(panel.series) <= 8 and panel.picture is None,
        "legend": {"orientation": "h", "y": -0.24, "yanchor": "top", "itemsizing": "constant"},
        "shapes": [],
        "annotations": [],
    }
    for span in panel.spans:
        layout["shapes"].append({
            "type": "rect", "xref": "x", "yref": "paper", "x0": span.start, "x1": span.end,
            "y0": 0, "y1": 1, "fillcolor": span.colour, "line": {"width": 0}, "layer": "below",
        })
        layout["annotations"].append({
            "x": (span.start + span.end) / 2, "y": 1, "xref": "x", "yref": "paper",
            "yanchor": "bottom", "text": span.name, "showarrow": False,
            "font": {"size": 9, "color": "#777"},
        })
    if panel.reference is not None:
        layout["annotations"].append({
            "x": panel.reference.x, "y": panel.reference.y, "xanchor": "left", "yanchor": "bottom",
            "yshift": 4, "text": panel.reference.text, "showarrow": False,
            "bgcolor": "rgba(255,255,255,0.85)", "font": {"size": 10, "color": "#000"},
        })
    if panel.same_scale:
        layout["yaxis"] |= {"scaleanchor": "x", "scaleratio": 1}
    if panel.y_down:
        layout["yaxis"]["autorange"] = "reversed"
    if panel.log_y:
        layout["yaxis"]["type"] = "log"
    if panel.x_names is not None:
        layout["xaxis"] |= {"tickmode": "array", "tickvals": list(range(len(panel.x_names))),
                            "ticktext": panel.x_names}
    if panel.from_zero:
        layout["yaxis"]["rangemode"] = "tozero"
    if panel.picture is not None:
        _set_picture(layout, panel.picture)
    return layout


def _set_picture(layout, picture):
    height, width = picture.grey.shape
    x, y = picture.x_px - 0.5, picture.y_px - 0.5
    source = "data:image/png;base64," + base64.b64encode(png_of(picture.grey)).decode()
    layout["images"] = [{
        "source": source, "xref": "x", "yref": "y", "x": x, "y": y, "sizex": width,
        "sizey": height, "sizing": "stretch", "layer": "below",
    }]
    layout["xaxis"] |= {"range": [x, x + width], "showgrid": False, "constrain": "domain"}
    layout["yaxis"] |= {"range": [y + height, y], "showgrid": False, "constrain": "domain"}
    layout["yaxis"].pop("autorange", None)
