// A drawing of the page as PDF 1.4: its lines stay lines, its words words; pictures come as pixels.
// It knows the elements that the overlay and the curves are made of, not all of SVG.

const POINT = 0.75;     // of a pixel of the screen
const ROUND = 0.5523;   // a quarter of a circle as one cubic
const ascii = text => new TextEncoder().encode(text);
const short = value => String(Number(value.toFixed(3)));

// Commands M, L, C and Z with absolute points out of a path's text (M L H V C Q Z, absolute or not).
export function segments(d) {
  const list = [], tokens = d.match(/[a-zA-Z]|-?(?:\d+\.?\d*|\.\d+)(?:e[-+]?\d+)?/gi) ?? [];
  let x = 0, y = 0, x0 = 0, y0 = 0, command = "";
  for (let i = 0; i < tokens.length;) {
    if (/[a-z]/i.test(tokens[i])) command = tokens[i++];
    const upper = command.toUpperCase(), ox = command === upper ? 0 : x, oy = command === upper ? 0 : y;
    const next = offset => Number(tokens[i++]) + offset;
    if (upper === "Z") { list.push(["Z"]); x = x0; y = y0; command = ""; continue; }
    if (upper === "H") x = next(ox);
    else if (upper === "V") y = next(oy);
    else if (upper === "M" || upper === "L") { x = next(ox); y = next(oy); }
    else if (upper === "C" || upper === "Q") {
      let points = Array.from({length: upper === "C" ? 6 : 4}, (_, k) => next(k % 2 ? oy : ox));
      if (upper === "Q") {  // the cubic of the same shape
        const [qx, qy, ex, ey] = points, third = (a, b) => a + 2 / 3 * (b - a);
        points = [third(x, qx), third(y, qy), third(ex, qx), third(ey, qy), ex, ey];
      }
      list.push(["C", ...points]);
      [x, y] = points.slice(-2);
      continue;
    } else throw new Error(`a path has the command ${command}`);
    list.push([upper === "M" ? "M" : "L", x, y]);
    if (upper === "M") { x0 = x; y0 = y; command = command === "M" ? "L" : "l"; }
  }
  return list;
}

function ellipse(cx, cy, rx, ry) {
  const at = (u, v) => [cx + rx * u, cy + ry * v];
  return [["M", ...at(1, 0)], ["C", ...at(1, ROUND), ...at(ROUND, 1), ...at(0, 1)], ["C", ...at(-ROUND, 1), ...at(-1, ROUND), ...at(-1, 0)],
          ["C", ...at(-1, -ROUND), ...at(-ROUND, -1), ...at(0, -1)], ["C", ...at(ROUND, -1), ...at(1, -ROUND), ...at(1, 0)], ["Z"]];
}

function outlineOf(node) {
  const of = name => node[name].baseVal.value;
  if (node.tagName === "path") return segments(node.getAttribute("d") ?? "");
  if (node.tagName === "circle") return ellipse(of("cx"), of("cy"), of("r"), of("r"));
  if (node.tagName === "ellipse") return ellipse(of("cx"), of("cy"), of("rx"), of("ry"));
  if (node.tagName !== "rect") return null;
  const [x, y, w, h] = ["x", "y", "width", "height"].map(of);
  return [["M", x, y], ["L", x + w, y], ["L", x + w, y + h], ["L", x, y + h], ["Z"]];
}

// "rgb(1, 2, 3)" or "rgba(1, 2, 3, 0.5)"; null for none.
function colourOf(text) {
  const numbers = text.match(/[\d.]+/g)?.map(Number);
  return text.startsWith("rgb") ? {rgb: numbers.slice(0, 3).map(v => short(v / 255)).join(" "), alpha: numbers[3] ?? 1} : null;
}

// The words of WinAnsiEncoding, which is all that the font of every reader has.
const spelt = text => [...text.replaceAll("−", "-").replaceAll("→", "to")].map(c => (c.codePointAt(0) < 256 ? c : "?")).join("")
  .replace(/[\\()]/g, "\\$&");

// One page of so many pixels of the screen.
class Page {
  constructor(width, height) {
    Object.assign(this, {width, height, text: [`${POINT} 0 0 -${POINT} 0 ${short(POINT * height)} cm`], alphas: new Map(), images: []});
  }
  alpha(fill, stroke) {
    const key = `${short(fill)} ${short(stroke)}`;
    if (!this.alphas.has(key)) this.alphas.set(key, `/A${this.alphas.size}`);
    this.text.push(`${this.alphas.get(key)} gs`);
  }
  path(list, m) {
    const place = numbers => numbers.map((_, k) => (k % 2 ? null : [m.a * numbers[k] + m.c * numbers[k + 1] + m.e, m.b * numbers[k] + m.d * numbers[k + 1] + m.f]))
      .filter(Boolean).flat().map(short).join(" ");
    for (const [op, ...numbers] of list) this.text.push(op === "Z" ? "h" : `${place(numbers)} ${op.toLowerCase()}`);
  }
  // What follows lies inside the rectangle that the element is cut to.
  clip(node, m) {
    const name = /url\(["']?#([^"')]+)/.exec(node.getAttribute("clip-path") ?? "")?.[1];
    const rect = name && document.getElementById(name)?.querySelector("rect");
    if (!rect) return;
    this.path(outlineOf(rect), m);
    this.text.push("W n");
  }
  draw(node, opacity, canvas) {
    const style = getComputedStyle(node), m = node.getCTM?.();
    if (!m || style.display === "none" || style.visibility === "hidden" || ["defs", "clipPath"].includes(node.tagName)) return;
    const seen = opacity * Number(style.opacity);
    if (!(seen > 0)) return;
    this.text.push("q");
    this.clip(node, m);
    if (node.tagName === "image") this.image(canvas);
    else if (node.tagName === "text") this.words(node, style, m, seen);
    else this.shape(node, style, m, seen);
    if (node.tagName === "g" || node.tagName === "svg") for (const child of node.children) this.draw(child, seen, canvas);
    this.text.push("Q");
  }
  paint(style, m, seen) {
    const fill = colourOf(style.fill), stroke = colourOf(style.stroke), scale = Math.sqrt(Math.abs(m.a * m.d - m.b * m.c));
    const unit = style.vectorEffect === "non-scaling-stroke" ? 1 : scale, width = parseFloat(style.strokeWidth) * unit;
    const shown = {fill: fill ? fill.alpha * Number(style.fillOpacity) * seen : 0, stroke: stroke && width > 0 ? stroke.alpha * Number(style.strokeOpacity) * seen : 0};
    if (shown.fill) this.text.push(`${fill.rgb} rg`);
    if (shown.stroke) {
      const dashes = style.strokeDasharray === "none" ? [] : style.strokeDasharray.match(/[\d.]+/g).map(v => short(v * unit));
      this.text.push(`${stroke.rgb} RG ${short(width)} w [${dashes.join(" ")}] 0 d 1 j`);
    }
    this.alpha(shown.fill, shown.stroke);
    return shown;
  }
  shape(node, style, m, seen) {
    const list = outlineOf(node);
    if (!list?.length) return;
    const {fill, stroke} = this.paint(style, m, seen);
    if (!fill && !stroke) return;
    this.path(list, m);
    this.text.push(fill && stroke ? "B" : fill ? "f" : "S");
  }
  words(node, style, m, seen) {
    const words = node.textContent;
    if (!words.trim()) return;
    const {fill, stroke} = this.paint(style, m, seen), {x, y} = node.getStartPositionOfChar(0);
    if (!fill && !stroke) return;
    const at = [m.a, m.b, -m.c, -m.d, m.a * x + m.c * y + m.e, m.b * x + m.d * y + m.f].map(short).join(" ");
    this.text.push(`BT /F ${short(parseFloat(style.fontSize))} Tf ${fill && stroke ? 2 : fill ? 0 : 1} Tr ${at} Tm (${spelt(words)}) Tj ET`);
  }
  // Over all of the page.
  image(canvas) {
    this.images.push(canvas);
    this.text.push(`${this.width} 0 0 -${this.height} 0 ${this.height} cm /I${this.images.length - 1} Do`);
  }
}

const packed = async bytes => new Uint8Array(await new Response(new Blob([bytes]).stream().pipeThrough(new CompressionStream("deflate"))).arrayBuffer());

// Grey where all of it is.
async function pixels(canvas) {
  const {width, height} = canvas, rgba = canvas.getContext("2d").getImageData(0, 0, width, height).data;
  let grey = true;
  for (let i = 0; i < rgba.length && grey; i += 4) grey = rgba[i] === rgba[i + 1] && rgba[i] === rgba[i + 2];
  const out = new Uint8Array((grey ? 1 : 3) * width * height);
  for (let i = 0, k = 0; i < rgba.length; i += 4) {
    out[k++] = rgba[i];
    if (!grey) { out[k++] = rgba[i + 1]; out[k++] = rgba[i + 2]; }
  }
  return stream(await packed(out), `/Type /XObject /Subtype /Image /Width ${width} /Height ${height} /ColorSpace /Device${grey ? "Gray" : "RGB"} /BitsPerComponent 8`);
}

const stream = (bytes, more = "") => [`<< ${more} /Filter /FlateDecode /Length ${bytes.length} >>\nstream\n`, bytes, "\nendstream"];

// Object by object, with the table of where each begins.
function file(objects) {
  const parts = [], places = [];
  let length = 0;
  const put = part => { const bytes = typeof part === "string" ? ascii(part) : part; parts.push(bytes); length += bytes.length; };
  put("%PDF-1.4\n");
  objects.forEach((object, k) => {
    places.push(length);
    put(`${k + 1} 0 obj\n`);
    object.forEach(put);
    put("\nendobj\n");
  });
  const table = length;
  put(`xref\n0 ${objects.length + 1}\n0000000000 65535 f \n${places.map(at => `${String(at).padStart(10, "0")} 00000 n \n`).join("")}`);
  put(`trailer\n<< /Size ${objects.length + 1} /Root 1 0 R >>\nstartxref\n${table}\n%%EOF\n`);
  return parts;
}

// The drawings, one over the other, which stand in the document; `canvas` has the pixels of their
// image, which fills the page. The parts of the file.
export async function pdfOf(drawings, width, height, canvas = null) {
  const page = new Page(width, height);
  for (const drawing of drawings) page.draw(drawing, 1, canvas);
  const alphas = [...page.alphas].map(([key, name]) => `${name} << /ca ${key.split(" ")[0]} /CA ${key.split(" ")[1]} >>`).join(" ");
  const images = page.images.map((_, k) => `/I${k} ${6 + k} 0 R`).join(" ");
  const latin1 = Uint8Array.from(page.text.join("\n"), c => c.codePointAt(0));
  return file([
    ["<< /Type /Catalog /Pages 2 0 R >>"], ["<< /Type /Pages /Kids [3 0 R] /Count 1 >>"],
    [`<< /Type /Page /Parent 2 0 R /MediaBox [0 0 ${short(POINT * width)} ${short(POINT * height)}] /Contents 5 0 R`
      + ` /Resources << /Font << /F 4 0 R >> /ExtGState << ${alphas} >> /XObject << ${images} >> >> >>`],
    ["<< /Type /Font /Subtype /Type1 /BaseFont /Helvetica /Encoding /WinAnsiEncoding >>"],
    stream(await packed(latin1)), ...await Promise.all(page.images.map(pixels))]);
}
