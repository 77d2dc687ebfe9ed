// The panel to look at results: layers, figures, curves.
import {SHOWN} from "./field.js";
import {make} from "./dom.js";
import {buildLost} from "./corrections.js";
import * as exporting from "./export.js";
import * as models from "./models.js";
import * as player from "./player.js";
import * as lights from "./lights.js";
import * as plots from "./plots.js";
import {sentence} from "./sentence.js";
import {get, on, set} from "./store.js";
import * as values from "./values.js";

const LAYERS = {circle: "outline", path: "path", arrows: "arrows", axes: "axes", bar: "scale bar"};

export const START = {circle: true, path: true, arrows: false, axes: true, bar: true, map: "", colours: "viridis"};

const change = changes => set({layers: {...get("layers"), ...changes}});

function layerRow() {
  const boxes = Object.entries(LAYERS).map(([key, name]) => make("label", {},
    make("input", {type: "checkbox", id: `layer-${key}`, checked: START[key],
                   onchange: event => change({[key]: event.target.checked})}), name));
  return make("div", {className: "row", role: "group", ariaLabel: "Layers"}, ...boxes);
}

function mapRow() {
  const map = make("select", {id: "layer-map", onchange: () => change({map: map.value})}, new Option("no colours", ""),
                   ...Object.entries(SHOWN).map(([key, what]) => new Option(what.name, key)));
  const colours = make("select", {id: "layer-colours", onchange: () => change({colours: colours.value})},
                       new Option("viridis"), new Option("cividis"));
  const row = make("div", {className: "row"}, make("label", {}, "Field ", map), make("label", {}, "in ", colours));
  on(["fields", "preview"], ({fields, preview}) => { row.hidden = !fields && !preview?.windows; });
  return row;
}

// Grey levels that are black and white.
function contrastRow() {
  const field = (name, label) => make("input", {type: "number", id: name, ariaLabel: label, className: "level"});
  const black = field("black", "Grey level shown black"), white = field("white", "Grey level shown white");
  const take = () => player.setContrast(Number(black.value), Math.max(Number(white.value), Number(black.value) + 1));
  const fill = clip => { if (clip) { black.value = clip.black; white.value = clip.white; } };
  black.onchange = white.onchange = take;
  const whole = make("button", {textContent: "all levels", onclick: () => {
    black.value = 0; white.value = 2 ** get("clip").bits - 1; take();
  }});
  const stretch = make("button", {textContent: "stretched", onclick: () => { fill(get("clip")); take(); }});
  on(["clip"], ({clip}) => fill(clip));
  return make("div", {className: "row"}, make("label", {}, "Black ", black), make("label", {}, "white ", white), stretch, whole);
}

export function build() {
  const words = make("p", {className: "sentence", id: "sentence"});
  const warnings = make("ul", {className: "warnings", id: "warnings", hidden: true});
  on(["summary", "clip"], ({summary, clip}) => {
    words.textContent = sentence(summary);
    words.hidden = !words.textContent;
    const lines = summary?.warnings ?? clip?.warnings ?? [];
    warnings.hidden = !lines.length;
    warnings.replaceChildren(...lines.map(line => make("li", {textContent: line})));
  });
  return [words, lights.build(), warnings, layerRow(), mapRow(), contrastRow(), exporting.build(), make("h2", {textContent: "This frame"}), buildLost("look"), values.build(),
          make("h2", {textContent: "Curves"}), ...plots.build(), ...models.build()];
}
