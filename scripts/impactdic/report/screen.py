"""The first screen of the page as HTML."""

import base64
import html
import math

from .draw import png_of
from .figure import BLACK, ORANGE, RED, SKY

LARGEST_VIDEO = 30e6  # bytes; a larger one stays a file beside the page
PLAYED = (b"avc1", b"vp09", b"av01")  # what browsers play
MARKS = {"good": "✓", "bad": "!", "open": "–"}

STYLE = """
.sentence { font-size: 1.35rem; margin: 8px 0 12px; }
.lights { display: flex; flex-wrap: wrap; gap: 8px; list-style: none; margin: 0 0 12px; padding: 0; }
.lights li { border: 1px solid #ccc; border-left-width: 6px; border-radius: 4px; padding: 2px 10px; }
.lights small { display: block; color: #555; }
.lights .good { border-left-color: #0072B2; }
.lights .bad { border-left-color: #D55E00; background: #FFF1E6; }
.lights .open { border-left-color: #999; }
.keys { display: grid; grid-template-columns: repeat(3, minmax(0, 1fr)); gap: 8px; margin: 0 0 8px;
  max-width: 1000px; }
.keys figure { margin: 0; }
.keys svg { display: block; width: 100%; height: auto; }
video { display: block; max-width: 100%; margin: 8px 0; }
"""


def first_screen(first):
    """`first`: of first.py."""
    parts = [f'<p class="sentence">{html.escape(first.sentence)}</p>' if first.sentence else ""]
    if first.lights:
        items = "".join(
            f'<li class="{light.state}"><b>{MARKS[light.state]}</b> {html.escape(light.name)}'
            f"<small>{html.escape(light.why)}</small></li>" for light in first.lights)
        parts.append(f'<ul class="lights">{items}</ul>')
    if first.pictures:
        parts.append('<div class="keys">' + "".join(map(_picture, first.pictures)) + "</div>")
    if first.video is not None:
        parts.append(_video(first.video))
    return "\n".join(part for part in parts if part)


def _picture(key):
    height, width = key.grey.shape
    stroke = width / 160  # as thick on a phone as on a large screen, for the picture's size
    source = base64.b64encode(png_of(key.grey)).decode()
    x, y = key.x_px - 0.5, key.y_px - 0.5
    path = "M" + "L".join(f"{px:.2f} {py:.2f}" for px, py in key.path) if len(key.path) else ""
    drawn, colours = [], []
    shape = key.outline
    if shape is not None:
        drawn.append(
            f'<ellipse cx="{shape.x:.2f}" cy="{shape.y:.2f}" rx="{shape.long:.2f}" '
            f'ry="{shape.short:.2f}" transform="rotate({math.degrees(shape.angle):.2f} '
            f'{shape.x:.2f} {shape.y:.2f})" />')
        colours.append(RED)
    if path:
        drawn.append(f'<path d="{path}" />')
        colours.append(ORANGE)
    if key.surface is not None:
        drawn.append("<line {}/>".format("".join(
            f'{name}="{value:.2f}" ' for name, value in zip(("x1", "y1", "x2", "y2"), key.surface))))
        colours.append("#FFFFFF")
    if key.motion is not None:
        drawn.append(f'<path d="{_arrow(shape.x, shape.y, *key.motion, 5 * stroke)}" />')
        colours.append(SKY)
    lines = "".join(_haloed(shape, colour, stroke) for shape, colour in zip(drawn, colours))
    return (f'<figure><svg viewBox="{x:.2f} {y:.2f} {width} {height}" role="img" '
            f'aria-label="{html.escape(key.title)}">'
            f'<image x="{x:.2f}" y="{y:.2f}" width="{width}" height="{height}" '
            f'href="data:image/png;base64,{source}" />{lines}{_bar(key, stroke)}</svg>'
            f"<figcaption>{html.escape(key.title)}</figcaption></figure>")


def _haloed(shape, colour, stroke):
    """Over black and white alike: a dark line under each light one."""
    common = 'fill="none" stroke-linejoin="round" stroke-linecap="round"'
    under = shape.replace(" />", "/>").replace(
        "/>", f' {common} stroke="{BLACK}" stroke-opacity="0.6" stroke-width="{2.2 * stroke:.2f}"/>')
    over = shape.replace(" />", "/>").replace(
        "/>", f' {common} stroke="{colour}" stroke-width="{stroke:.2f}"/>')
    return under + over


def _arrow(x, y, u, v, head):
    length = (u * u + v * v) ** 0.5
    ex, ey = u / length * head, v / length * head
    tx, ty = x + u, y + v
    return (f"M{x:.2f} {y:.2f}L{tx:.2f} {ty:.2f}"
            f"M{tx - ex + ey / 2:.2f} {ty - ey - ex / 2:.2f}L{tx:.2f} {ty:.2f}"
            f"L{tx - ex - ey / 2:.2f} {ty - ey + ex / 2:.2f}")


def _bar(key, stroke):
    if key.bar is None:
        return ""
    height, width = key.grey.shape
    length, text = key.bar
    x, y = key.x_px + 0.04 * width, key.y_px + 0.95 * height
    size = 0.055 * width
    line = f'<line x1="{x:.2f}" y1="{y:.2f}" x2="{x + length:.2f}" y2="{y:.2f}"/>'
    return _haloed(line, "#FFFFFF", 2 * stroke) + (
        f'<text x="{x:.2f}" y="{y - 0.5 * size:.2f}" font-size="{size:.2f}" fill="#FFFFFF" '
        f'stroke="{BLACK}" stroke-width="{0.2 * size:.2f}" paint-order="stroke">'
        f"{html.escape(text)}</text>")


def _video(path):
    data = path.read_bytes() if path.stat().st_size <= LARGEST_VIDEO else b""
    if not any(code in data for code in PLAYED):
        return f"<p>The clip with what was measured on it: {html.escape(path.name)}</p>"
    source = base64.b64encode(data).decode()
    return (f'<video controls loop src="data:video/mp4;base64,{source}">'
            f"{html.escape(path.name)}</video>")
