// The displacement field as colours, and the history of a window.
import * as server from "./server.js";
import {colour, paintBar} from "./colours.js";
import {id, say} from "./dom.js";
import * as picture from "./picture.js";
import {get, on, set} from "./store.js";

const DEGREE = Math.PI / 180;

// What can be shown of a window: of its columns, and of the ball's rigid motion (dx, dy, turn, about
// cx, cy) where there is one.
export const SHOWN = {
  u: {name: "u, px to the right", of: f => f.u_px},
  v: {name: "v, px down", of: f => f.v_px},
  speed: {name: "displacement, px", of: f => Math.hypot(f.u_px, f.v_px)},
  residual: {name: "off the rigid motion, px", of: (f, m) => m && Math.hypot(...residual(f, m))},
  correlation: {name: "ZNCC", of: f => f.correlation},
  sd: {name: "deviation, px", of: f => Math.hypot(f.u_sd_px, f.v_sd_px)},
  exx: {name: "strain xx", of: f => f.ux},
  eyy: {name: "strain yy", of: f => f.vy},
  exy: {name: "shear strain xy", of: f => (f.uy + f.vx) / 2},
};

// Counter-clockwise on the screen, y down: a point at (x, y) from the centre goes to
// (x cos w + y sin w, -x sin w + y cos w).
function residual(f, m) {
  const c = Math.cos(m.rot), s = Math.sin(m.rot), x = f.x_px - m.cx, y = f.y_px - m.cy;
  return [f.u_px - m.dx - (x * c + y * s - x), f.v_px - m.dy - (-x * s + y * c - y)];
}

export function rigidMotion(track, row) {
  if (!track || row < 0 || !track.has("cx_px")) return null;
  const of = name => track.number(row, name);
  const m = {dx: of("dx_px"), dy: of("dy_px"), rot: of("rot_deg") * DEGREE, cx: of("cx_px"), cy: of("cy_px")};
  return Object.values(m).every(Number.isFinite) ? m : null;
}

// One object a window out of (columns, windows) floats.
export function windowsOf(buffer, columns) {
  const values = new Float32Array(buffer), count = values.length / columns.length;
  return Array.from({length: count}, (_, i) => Object.fromEntries(
    columns.map((name, c) => [name, values[c * count + i]])));
}

let current = 0;

// Fetches the field of the frame that is shown, where anything wants it.
async function follow({shown, fields, shot, layers, preview}) {
  const mine = ++current;
  if (preview && preview.frame === shown && preview.windows) return set({windows: preview.windows});
  const row = fields ? fields.frames.indexOf(shown) : -1;
  if (row < 0 || !(layers.map || layers.arrows)) return set({windows: null});
  try {
    const buffer = await server.bytes("field", {shot, row});
    if (mine === current) set({windows: windowsOf(buffer, fields.columns)});
  } catch (error) { say(error.message); }
}
on(["shown", "fields", "layers", "preview"], values => { if (values.layers) follow(values); });

let spacing = 8, range = null;

function prepare({windows, layers, track, shown, preview}) {
  range = null;
  id("legend").hidden = true;
  if (windows?.length && layers.map) {
    const motion = preview && preview.frame === shown ? preview.motion : rigidMotion(track, track?.row(shown) ?? -1);
    const what = SHOWN[layers.map];
    for (const f of windows) f.shown = f.status === 0 ? what.of(f, motion) : NaN;
    const values = windows.map(f => f.shown).filter(Number.isFinite).sort((a, b) => a - b);
    const xs = [...new Set(windows.filter(f => Number.isFinite(f.x_px)).map(f => f.x_px))].sort((a, b) => a - b);
    spacing = xs.slice(1).reduce((least, x, k) => Math.min(least, x - xs[k]), 64);
    if (values.length) {
      range = [values[Math.floor(0.02 * (values.length - 1))], values[Math.ceil(0.98 * (values.length - 1))]];
      id("legend").hidden = false;
      id("legend-name").textContent = what.name;
      id("legend-low").textContent = range[0].toPrecision(4);
      id("legend-high").textContent = range[1].toPrecision(4);
      paintBar(id("legend-bar"), layers.colours);
    }
  }
  picture.paint();
}
on(["windows", "layers", "shown"], values => { if (values.layers) prepare(values); });

picture.paintAlso(context => {
  const windows = get("windows");
  if (!windows || !range) return;
  context.globalAlpha = 0.8;
  const width = range[1] - range[0] || 1;
  for (const f of windows) {
    if (!Number.isFinite(f.shown)) continue;
    context.fillStyle = colour((f.shown - range[0]) / width, get("layers").colours);
    context.fillRect(f.x_px - spacing / 2, f.y_px - spacing / 2, spacing, spacing);
  }
  context.globalAlpha = 1;
});

// The window next to a point of the picture, and what came of it in every frame.
export async function pick(point) {
  const windows = get("windows"), {fields, shot} = {fields: get("fields"), shot: get("shot")};
  if (!windows?.length || !fields || (get("preview") && get("preview").frame === get("shown"))) return;
  const far = f => Math.hypot(f.x_px - point.x, f.y_px - point.y);
  const near = windows.reduce((best, f, k) => (far(f) < far(windows[best]) || !(far(windows[best]) >= 0) ? k : best), 0);
  if (!(far(windows[near]) < 2 * spacing)) return set({history: null});
  try {
    const rows = windowsOf(await server.bytes("history", {shot, window: near}), fields.columns);
    set({history: {window: near, rows, frames: fields.frames}});
  } catch (error) { say(error.message); }
}
picture.setClick(pick);
