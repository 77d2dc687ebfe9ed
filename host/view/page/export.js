// Files for elsewhere: the picture with what is drawn on it, as PNG, SVG or PDF, films, and the tables.
import {colour} from "./colours.js";
import {draw, id, make, say} from "./dom.js";
import {withDensity} from "./paper.js";
import {pdfOf} from "./pdf.js";
import * as picture from "./picture.js";
import * as player from "./player.js";
import * as server from "./server.js";
import {get, on} from "./store.js";

const DENSITY = 300 / 96;  // pixels to one of the screen: 300 to the inch
const MOST_PICTURES = 1000;      // of a film

function save(blob, name) {
  const link = make("a", {href: URL.createObjectURL(blob), download: name});
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

// The colour bar, which on the page is no part of the drawing.
function legend(width) {
  const group = draw("g", {transform: `translate(${width - 190} 12)`, "font-size": 12, "font-family": "system-ui, sans-serif"});
  group.append(draw("rect", {width: 178, height: 50, rx: 6, fill: "#fff", "fill-opacity": 0.87}));
  for (let k = 0; k < 40; ++k) {
    group.append(draw("rect", {x: 9 + 4 * k, y: 20, width: 4.2, height: 10, fill: colour(k / 39, get("layers").colours)}));
  }
  const text = (x, y, anchor, name) => {
    const word = draw("text", {x, y, "text-anchor": anchor});
    word.textContent = id(name).textContent;
    group.append(word);
  };
  text(9, 15, "start", "legend-name");
  text(9, 44, "start", "legend-low");
  text(169, 44, "end", "legend-high");
  return group;
}

// What is on the screen, as one drawing, with the pixels of the picture in it.
function drawing() {
  const {clientWidth: width, clientHeight: height} = id("picture"), canvas = picture.render(DENSITY);
  const svg = draw("svg", {xmlns: "http://www.w3.org/2000/svg", width, height, viewBox: `0 0 ${width} ${height}`});
  svg.append(draw("rect", {width, height, fill: "#17181a"}),
             draw("image", {width, height, href: canvas.toDataURL("image/png")}),
             ...[...id("overlay").children].map(child => child.cloneNode(true)));
  if (!id("legend").hidden) svg.append(legend(width));
  return {svg, canvas, width, height};
}

const textOf = svg => new XMLSerializer().serializeToString(svg);

const name = end => `${get("shot") || get("state").title}_frame${get("shown")}.${end}`.replace(/[^\w.-]+/g, "_");

export function saveSvg() {
  save(new Blob([textOf(drawing().svg)], {type: "image/svg+xml"}), name("svg"));
}

// What is on the screen, as pixels: a canvas.
function paint() {
  const {svg, width, height} = drawing(), image = new Image();
  const canvas = make("canvas", {width: Math.round(DENSITY * width), height: Math.round(DENSITY * height)});
  return new Promise((done, failed) => {
    image.onload = () => {
      canvas.getContext("2d").drawImage(image, 0, 0, canvas.width, canvas.height);
      URL.revokeObjectURL(image.src);
      done(canvas);
    };
    image.onerror = () => failed(new Error("the picture cannot be drawn"));
    image.src = URL.createObjectURL(new Blob([textOf(svg)], {type: "image/svg+xml"}));
  });
}

const told = async work => { try { await work(); } catch (error) { say(error.message); } };

export const savePng = () => told(async () => {
  const canvas = await paint(), blob = await new Promise(done => canvas.toBlob(done, "image/png"));
  save(new Blob([withDensity(new Uint8Array(await blob.arrayBuffer()), 300)], {type: "image/png"}), name("png"));
});

const savePage = async (file, ...what) => save(new Blob(await pdfOf(...what), {type: "application/pdf"}), file);

export const savePdf = () => told(async () => {
  const {svg, canvas, width, height} = drawing();
  // Styles and places are known of what stands in the document; nobody sees it there.
  svg.style.cssText = "position: fixed; left: -20000px; top: 0";
  document.body.append(svg);
  try { await savePage(name("pdf"), [svg], width, height, canvas); } finally { svg.remove(); }
});

export const saveCurves = () => told(async () => {
  const plot = id("curves");
  await savePage(name("pdf").replace(/_frame\d+/, "_curves"), plot.querySelectorAll("svg.main-svg"), plot.clientWidth, plot.clientHeight);
});

// The frames from the first to the last one asked for, drawn by the program.
async function saveFilm(first, last, status) {
  const clip = get("clip"), step = Math.max(1, Math.ceil((last - first + 1) / MOST_PICTURES));
  const contrast = player.contrast();
  status.textContent = "writing the film …";
  await told(async () => {
    const bytes = await server.bytes("film", {shot: get("shot"), first, end: Math.min(clip.frames, last + 1), step, rate: id("speed").value, ...contrast});
    save(new Blob([bytes], {type: "video/mp4"}), name("mp4"));
  });
  status.textContent = "";
}

async function saveTable(file) {
  await told(async () => save(new Blob([await server.text("file", {shot: get("shot"), name: file})], {type: "text/csv"}), file));
}

function filmRow() {
  const field = (key, label) => make("input", {type: "number", min: 0, id: `film-${key}`, className: "level", ariaLabel: label});
  const first = field("first", "First frame of the film"), last = field("last", "Last frame of the film");
  const status = make("span", {className: "soft", role: "status"});
  const go = make("button", {id: "save-mp4", textContent: "MP4", title: `With what was measured, at the speed chosen below the picture; of more than ${MOST_PICTURES} frames every second, third …`,
    onclick: async () => { go.disabled = true; await saveFilm(Number(first.value), Number(last.value), status); go.disabled = false; }});
  on(["clip"], ({clip}) => {
    go.disabled = !clip;
    first.value = 0;
    last.value = first.max = last.max = clip ? clip.frames - 1 : 0;
  });
  const row = make("div", {className: "row"}, go, make("label", {}, "of frames ", first), make("label", {}, "to ", last), status);
  on(["state"], ({state}) => { row.hidden = !state.films; });
  return row;
}

export function build() {
  const button = (text, onclick, key) => make("button", {id: `save-${key}`, textContent: text, onclick});
  const csv = button("track.csv", () => saveTable("track.csv"), "csv");
  const curves = button("curves, PDF", saveCurves, "curves");
  on(["track", "plots"], ({track, plots}) => {
    csv.disabled = !track;
    curves.hidden = !plots;
    curves.disabled = !track?.has("cx_px");
  });
  return make("div", {id: "export"},
    make("div", {className: "row"}, make("span", {className: "soft", textContent: "Save"}), button("PNG", savePng, "png"), button("SVG", saveSvg, "svg"), button("PDF", savePdf, "pdf"), curves, csv),
    filmRow());
}
