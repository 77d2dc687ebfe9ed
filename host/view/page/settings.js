// The settings of `track` as fields, in groups, with the texts of its --help.
import {make} from "./dom.js";
import {get, set} from "./store.js";

// The first group stands open; what no group names goes to the last.
const GROUPS = [
  ["Scale and axes", ["ball-diameter-mm", "mm-per-px", "camera", "surface-angle-deg", "fps", "inertia-factor"]],
  ["Where and when", ["roi", "polygon", "radius-px", "ball", "ball-at", "frames"]],
  ["How", ["estimator", "body", "no-field"]],
  ["Uncertainty and checks", ["ball-diameter-sd-mm", "mm-per-px-sd", "surface-angle-sd-deg", "gravity-angle-deg", "drop-height-mm",
                              "distance-mm", "distance-sd-mm"]],
  ["Windows", ["window", "spacing", "search", "method", "interp", "spline-degree", "max-iterations", "min-correlation",
               "min-texture", "max-sd"]],
  ["Files and the rest", []],
];
const OPEN = 3;  // groups
const inputs = new Map();

// "" stands for the default.
export function change(key, value) {
  const settings = {...get("settings")};
  if (value === "" || value === false || value === null) delete settings[key]; else settings[key] = value;
  set({settings});
  const input = inputs.get(key);
  if (!input) return;
  if (input.type === "checkbox") input.checked = Boolean(value); else input.value = value;
}

// The field whose value was refused, so that a person finds it.
export function mark(line) {
  for (const [key, input] of inputs) input.setAttribute("aria-invalid", new RegExp(`(--|key )${key}(?![\\w-])`).test(line ?? ""));
}

function field({key, kind, choices, default: usual, help}) {
  const name = `setting-${key}`, label = make("label", {htmlFor: name, title: help, textContent: key.replaceAll("-", " ")});
  let input;
  if (choices) {
    input = make("select", {id: name, title: help}, ...choices.map(c => new Option(c, c === usual ? "" : c)));
  } else if (kind === "flag") {
    input = make("input", {id: name, type: "checkbox", title: help});
  } else {
    input = make("input", {id: name, type: "text", title: help, placeholder: usual, autocomplete: "off", spellcheck: false});
    if (kind === "number") input.inputMode = "decimal";
  }
  input.onchange = () => change(key, kind === "flag" ? input.checked : input.value.trim());
  inputs.set(key, input);
  return [label, input];
}

// `beside`: what stands behind a key's field, by key: a button, and after it whole rows of three.
export function build(list, beside) {
  const known = new Set(GROUPS.flatMap(([, keys]) => keys)), byKey = new Map(list.map(s => [s.key, s]));
  return GROUPS.map(([title, keys], n) => {
    const all = n === GROUPS.length - 1 ? list.map(s => s.key).filter(key => !known.has(key)) : keys;
    const cells = all.filter(key => byKey.has(key)).flatMap(key => [...field(byKey.get(key)), ...(beside[key] ?? [make("span")])]);
    return make("details", {open: n < OPEN}, make("summary", {}, make("strong", {textContent: title})),
                make("div", {className: "settings"}, ...cells));
  });
}

export function fill(settings) {
  for (const [key, input] of inputs) {
    const value = settings[key];
    if (input.type === "checkbox") input.checked = value === true; else input.value = value ?? "";
  }
  set({settings: {...settings}});
}
