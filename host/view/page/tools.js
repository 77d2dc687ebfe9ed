// Drawing by hand on the picture: surface, gravity, region, ball, scale. Each tool is a drag from one point to
// another; what it found goes to whoever has chosen it. Every value can also be typed.
import {draw, id} from "./dom.js";
import {hand} from "./overlay.js";
import * as picture from "./picture.js";
import {get, on, set} from "./store.js";
import {BLUE, ORANGE, SKY} from "./colours.js";

const far = (a, b) => Math.hypot(a.x - b.x, a.y - b.y);
const round = (value, digits) => Number(value.toFixed(digits));

// Where the ball is in this frame, as far as it is known.
function ballCentre() {
  const preview = get("preview"), track = get("track"), row = track?.row(get("shown")) ?? -1;
  const of = name => (preview && preview.frame === get("shown") ? Number(preview.row[name] || NaN)
                                                                : track?.has(name) ? track.number(row, name) : NaN);
  const centre = {x: of("cx_px"), y: of("cy_px")};
  return Number.isFinite(centre.x + centre.y) ? centre : null;
}

// The surface's inclination, counter-clockwise from image-right, with its normal on the ball's side;
// without a ball, upwards. Image y is down, angles are as seen on the screen.
export function surfaceAngle(a, b, ball) {
  const normal = {x: b.y - a.y, y: a.x - b.x}, middle = {x: (a.x + b.x) / 2, y: (a.y + b.y) / 2};
  const side = ball ? normal.x * (ball.x - middle.x) + normal.y * (ball.y - middle.y) : -normal.y;
  const [from, to] = side < 0 ? [b, a] : [a, b];
  return {a: from, b: to, angle: round(Math.atan2(from.y - to.y, to.x - from.x) * 180 / Math.PI, 2)};
}

// Of each tool: what a drag becomes; null where it is too short to mean anything.
const TOOLS = {
  gravity: (a, b) => (far(a, b) < 5 ? null : {a, b, angle: round(Math.atan2(a.y - b.y, b.x - a.x) * 180 / Math.PI, 2)}),
  surface: (a, b) => (far(a, b) < 5 ? null : surfaceAngle(a, b, ballCentre())),
  roi: (a, b) => {
    const {width, height} = get("clip");
    const x = Math.max(0, Math.round(Math.min(a.x, b.x))), y = Math.max(0, Math.round(Math.min(a.y, b.y)));
    const w = Math.min(width, Math.round(Math.max(a.x, b.x)) + 1) - x, h = Math.min(height, Math.round(Math.max(a.y, b.y)) + 1) - y;
    return w < 16 || h < 16 ? null : {x, y, w, h};
  },
  ball: (a, b) => (far(a, b) < 4 ? null : {x: a.x, y: a.y, r: round(far(a, b), 1)}),
  correct: (a, b) => (far(a, b) < 4 ? null : {x: a.x, y: a.y, r: round(far(a, b), 1)}),
  scale: (a, b) => (far(a, b) < 2 ? null : {a, b, px: round(far(a, b), 2)}),
};

const CLOSE_PX = 12;  // of the screen: a click so near the first corner is meant for it
let chosen = null, finish = null;

// `found(value)` is called once; choosing the same tool again puts it away.
export function choose(name, found) {
  const again = chosen === name;
  putAway();
  if (again) return;
  chosen = name;
  set({tool: name});
  let start = null;
  const preview = end => set({hand: {...get("hand"), [name]: TOOLS[name](start, end) ?? undefined}});
  picture.setTool({
    down: point => { start = point; },
    move: point => { if (start) preview(point); },
    up: point => {
      if (!start) return;
      const value = TOOLS[name](start, point);
      putAway();
      if (value) { set({hand: {...get("hand"), [name]: value}}); found(value); }
    },
  });
}

// One click a corner; Enter, the button or a click on the first corner closes it.
export function choosePolygon(found) {
  const corners = [];
  const show = () => set({hand: {...get("hand"), polygon: corners.length ? [...corners] : undefined}});
  const close = () => {
    putAway();
    if (corners.length < 3) { corners.length = 0; return show(); }
    found(corners);
  };
  if (chosen === "polygon") return finish?.();
  putAway();
  chosen = "polygon";
  finish = close;
  set({tool: chosen});
  picture.setTool({
    down: () => {},
    move: () => {},
    up: point => {
      if (corners.length > 2 && far(point, corners[0]) * picture.view.scale < CLOSE_PX) return close();
      corners.push({x: round(point.x, 1), y: round(point.y, 1)});
      show();
    },
  });
}

export function putAway() {
  chosen = null;
  finish = null;
  picture.setTool(null);
  set({tool: null});
}

// Forgets what was drawn, because its value has been typed.
export const forget = name => set({hand: {...get("hand"), [name]: undefined}});

document.addEventListener("keydown", event => {
  if (event.key === "Escape" && chosen) putAway();
  if (event.key === "Enter" && finish) { event.preventDefault(); finish(); }
});

function stroke(tag, properties, colour) {
  const plain = {fill: "none", "vector-effect": "non-scaling-stroke", ...properties};
  hand.append(draw(tag, {...plain, stroke: "#000", "stroke-opacity": 0.55, "stroke-width": 5}),
              draw(tag, {...plain, stroke: colour, "stroke-width": 2.5}));
}

// What the settings say, whether drawn, typed or of an earlier run.
function drawSettings({settings, shown, hand: drawn}) {
  const typed = (settings?.polygon ?? "").split(",").map(Number);
  const corners = drawn?.polygon ?? typed.flatMap((x, k) => (k % 2 ? [] : [{x, y: typed[k + 1]}]));
  if (corners.length > 1 && corners.every(p => Number.isFinite(p.x + p.y))) {
    stroke("path", {d: `M${corners.map(p => `${p.x} ${p.y}`).join("L")}Z`, class: "polygon", "stroke-dasharray": "6 4"}, "#fff");
  }
  const given = (settings?.["ball-at"] ?? "").split("/").find(one => one.startsWith(`${shown}:`));
  const [cx, cy, r] = (given?.split(":")[1] ?? "").split(",").map(Number);
  if (r > 0) stroke("circle", {cx, cy, r, class: "correction", "stroke-dasharray": "2 5"}, "#fff");
}

on(["hand", "panel", "settings", "shown"], values => {
  const {hand: drawn, panel} = values;
  hand.replaceChildren();
  if (!drawn || panel !== "setup") return;
  drawSettings(values);
  const {surface, gravity, roi, ball, correct, scale} = drawn;
  if (surface) {
    const {a, b} = surface, x = (a.x + b.x) / 2, y = (a.y + b.y) / 2, share = 0.12;
    stroke("path", {d: `M${a.x} ${a.y}L${b.x} ${b.y}M${x} ${y}l${share * (b.y - a.y)} ${share * (a.x - b.x)}`, class: "surface"}, BLUE);
  }
  if (gravity) {
    const {a, b} = gravity, u = (b.x - a.x) / 6, v = (b.y - a.y) / 6;
    stroke("path", {d: `M${a.x} ${a.y}L${b.x} ${b.y}M${b.x - u + v / 2} ${b.y - v - u / 2}L${b.x} ${b.y}L${b.x - u - v / 2} ${b.y - v + u / 2}`, class: "gravity"}, SKY);
  }
  if (roi) stroke("rect", {x: roi.x - 0.5, y: roi.y - 0.5, width: roi.w, height: roi.h, "stroke-dasharray": "6 4"}, "#fff");
  if (ball) stroke("circle", {cx: ball.x, cy: ball.y, r: ball.r, "stroke-dasharray": "4 4"}, ORANGE);
  if (correct && get("tool") === "correct") stroke("circle", {cx: correct.x, cy: correct.y, r: correct.r, "stroke-dasharray": "2 5"}, "#fff");
  if (scale) stroke("path", {d: `M${scale.a.x} ${scale.a.y}L${scale.b.x} ${scale.b.y}`}, "#fff");
});
on(["tool"], ({tool}) => {
  for (const button of document.querySelectorAll("button.tool")) {
    button.setAttribute("aria-pressed", button.id === `draw-${tool}`);
  }
  id("picture").dataset.tool = tool ?? "";
});
