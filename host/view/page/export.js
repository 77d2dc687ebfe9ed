// Files for elsewhere: the picture with what is drawn on it, as PNG or SVG, and the tables.
import {colour} from "./colours.js";
import {draw, id, make, say} from "./dom.js";
import * as picture from "./picture.js";
import * as server from "./server.js";
import {get} from "./store.js";

const DENSITY = 3;  // pixels of a PNG to one of the screen: print at some 300 to the inch

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

// What is on the screen, as one drawing; `density` is that of the picture in it.
function drawing(density) {
  const {clientWidth: width, clientHeight: height} = id("picture");
  const svg = draw("svg", {xmlns: "http://www.w3.org/2000/svg", width, height, viewBox: `0 0 ${width} ${height}`});
  svg.append(draw("rect", {width, height, fill: "#17181a"}),
             draw("image", {width, height, href: picture.render(density).toDataURL("image/png")}),
             ...[...id("overlay").children].map(child => child.cloneNode(true)));
  if (!id("legend").hidden) svg.append(legend(width));
  return {text: new XMLSerializer().serializeToString(svg), width, height};
}

const name = end => `${get("shot") || get("state").title}_frame${get("shown")}.${end}`.replace(/[^\w.-]+/g, "_");

export function saveSvg() {
  save(new Blob([drawing(DENSITY).text], {type: "image/svg+xml"}), name("svg"));
}

export function savePng() {
  const {text, width, height} = drawing(DENSITY), image = new Image();
  const canvas = make("canvas", {width: DENSITY * width, height: DENSITY * height});
  image.onload = () => {
    canvas.getContext("2d").drawImage(image, 0, 0, canvas.width, canvas.height);
    URL.revokeObjectURL(image.src);
    canvas.toBlob(blob => save(blob, name("png")), "image/png");
  };
  image.onerror = () => say("the picture cannot be drawn");
  image.src = URL.createObjectURL(new Blob([text], {type: "image/svg+xml"}));
}

async function saveTable(file) {
  try {
    save(new Blob([await server.text("file", {shot: get("shot"), name: file})], {type: "text/csv"}), file);
  } catch (error) { say(error.message); }
}

export function build() {
  const button = (text, onclick, key) => make("button", {id: `save-${key}`, textContent: text, onclick});
  return make("div", {className: "row", id: "export"}, make("span", {className: "soft", textContent: "Save"}),
              button("PNG", savePng, "png"), button("SVG", saveSvg, "svg"), button("track.csv", () => saveTable("track.csv"), "csv"));
}
