// What was measured, drawn on the picture: outline, path, arrows, axes, in picture coordinates.
import {draw, id} from "./dom.js";
import {rigidMotion} from "./field.js";
import * as picture from "./picture.js";
import {get, on} from "./store.js";
import {BLUE, ORANGE, RED, SKY, YELLOW} from "./colours.js";

const svg = id("overlay");
const world = draw("g", {id: "world"}), screen = draw("g", {id: "screen"});
export const hand = draw("g", {id: "hand"});  // what is drawn by hand
svg.append(world, screen);

const LIT = {fill: "none", "vector-effect": "non-scaling-stroke", "stroke-linejoin": "round"};
// Over black and white alike: a dark line under each light one.
function line(tag, properties, colour, width = 2) {
  world.append(draw(tag, {...LIT, ...properties, stroke: "#000", "stroke-opacity": 0.55, "stroke-width": width + 2}),
               draw(tag, {...LIT, ...properties, stroke: colour, "stroke-width": width}));
}

const MOST_ARROWS = 130;
const NICE = [1, 2, 5];
// The number 1, 2 or 5 times a power of ten next below.
export function nice(value) {
  const power = 10 ** Math.floor(Math.log10(value));
  return power * NICE.filter(n => n * power <= value * 1.0000001).pop();
}

// How much longer than a displacement its arrow is: the same in all frames of a shot.
export function arrowScale(track) {
  if (!track) return 1;
  const steps = track.rows.map((_, k) => {
    const m = rigidMotion(track, k);
    return m ? Math.hypot(m.dx, m.dy) + Math.abs(m.rot) * track.number(k, "r_px") / 2 : NaN;
  }).filter(Number.isFinite).sort((a, b) => a - b);
  const usual = steps[Math.floor(steps.length / 2)], radius = track.numbers("r_px").find(Number.isFinite);
  return usual > 0 && radius > 0 ? Math.max(1, nice(radius / 3 / usual)) : 1;
}

// Shaft and head from (x, y) along (u, v).
function arrow(x, y, u, v) {
  const length = Math.hypot(u, v), head = Math.min(0.35 * length, 6);
  if (!(length > 0)) return "";
  const ex = u / length, ey = v / length, tx = x + u, ty = y + v;
  const wing = side => `L${tx - head * (ex - side * 0.5 * ey)} ${ty - head * (ey + side * 0.5 * ex)}`;
  return `M${x} ${y}L${tx} ${ty}M${tx} ${ty}${wing(1)}M${tx} ${ty}${wing(-1)}`;
}

// Of a circle, or of the ellipse where one was fitted: the rim is r + e1 cos 2φ + e2 sin 2φ from the centre.
function axes(r, e1, e2, cx, cy) {
  if (!Number.isFinite(e1 + e2)) return {rx: r, ry: r};
  const oval = Math.hypot(e1, e2);
  return {rx: r + oval, ry: r - oval, transform: `rotate(${Math.atan2(e2, e1) * 90 / Math.PI} ${cx} ${cy})`};
}

function drawCircle(track, row, preview) {
  const of = name => (preview ? Number(preview.row[name] || NaN) : track.number(row, name));
  const [cx, cy, r] = ["cx_px", "cy_px", "r_px"].map(of);
  if (![cx, cy, r].every(Number.isFinite)) return;
  const byHand = of("by_hand") > 0 ? {"stroke-dasharray": "10 4"} : {};
  line("ellipse", {cx, cy, ...axes(r, of("e1_px"), of("e2_px"), cx, cy), class: "outline", ...byHand}, preview ? SKY : ORANGE);
  line("path", {d: `M${cx - 4} ${cy}H${cx + 4}M${cx} ${cy - 4}V${cy + 4}`}, preview ? SKY : ORANGE, 1.5);
}

function drawPath(track) {
  const points = [], xs = track.numbers("cx_px"), ys = track.numbers("cy_px");
  const step = Math.max(1, Math.floor(xs.length / 3000));
  let pen = "M";
  for (let k = 0; k < xs.length; k += step) {
    if (!Number.isFinite(xs[k])) { pen = "M"; continue; }
    points.push(`${pen}${xs[k]} ${ys[k]}`);
    pen = "L";
  }
  line("path", {d: points.join(""), class: "path"}, SKY, 1.5);
}

function drawArrows(windows, scale, track, row) {
  const motion = rigidMotion(track, row);
  const list = windows ? windows.filter(f => f.status === 0) : [];
  // Of the windows' grid every so many columns and rows, so that arrows can be told apart.
  const every = Math.max(1, Math.ceil(Math.sqrt(list.length / MOST_ARROWS)));
  const order = name => new Map([...new Set(list.map(f => f[name]))].sort((a, b) => a - b).map((v, k) => [v, k]));
  const columns = order("x_px"), rows = order("y_px");
  const keep = list.filter(f => columns.get(f.x_px) % every === 0 && rows.get(f.y_px) % every === 0);
  const d = keep.map(f => arrow(f.x_px, f.y_px, scale * f.u_px, scale * f.v_px)).join("");
  if (d) line("path", {d, class: "arrows"}, YELLOW, 1.5);
  if (motion) line("path", {d: arrow(motion.cx, motion.cy, scale * motion.dx, scale * motion.dy), class: "motion"}, RED, 3);
}

// Two or three diameters that are painted on the ball in thought, and turn with it.
function drawAxes(pose, track, row) {
  const r = track.number(row, "r_px"), cx = track.number(row, "cx_px"), cy = track.number(row, "cy_px");
  const k = pose.row(Number(track.cell(row, "frame")));
  const [w, x, y, z] = ["qw", "qx", "qy", "qz"].map(name => pose.number(k, name));
  if (![r, cx, cy, w, x, y, z].every(Number.isFinite)) return;
  // Columns of the rotation matrix: X right, Y up, Z towards the camera.
  const axes = [[1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)],
                [2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)],
                [2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)]];
  axes.forEach(([ax, ay, az], n) => {
    if (n === 2 && Math.hypot(ax, ay) < 1e-3) return;  // a flat ball's points at the camera
    const dash = az < -1e-9 ? {"stroke-dasharray": "4 4"} : {};
    line("path", {d: `M${cx} ${cy}L${cx + r * ax} ${cy - r * ay}`, class: "axis", ...dash}, [ORANGE, BLUE, "#fff"][n], 2.5);
  });
}

const label = (x, y, text) => {
  for (const extra of [{stroke: "#000", "stroke-width": 3}, {}]) {
    const word = draw("text", {x, y, fill: "#fff", "font-size": 12, "font-family": "system-ui, sans-serif", ...extra});
    word.textContent = text;
    screen.append(word);
  }
};

// A reference arrow and a scale bar at the lower left, in screen pixels.
function drawReferences({layers, track, scale, clip, metrePerPx}) {
  screen.replaceChildren();
  const {scale: zoom} = picture.view, bottom = id("picture").clientHeight - 14;
  let x = 16;
  if (layers.arrows && track) {
    const px = nice(90 / (scale * zoom)), length = px * scale * zoom;
    const speed = metrePerPx && clip?.fps ? ` = ${Number((px * metrePerPx * clip.fps).toPrecision(3))} m/s` : "";
    const d = arrow(x, bottom, length, 0);
    screen.append(draw("path", {d, stroke: "#000", "stroke-width": 4, fill: "none"}),
                  draw("path", {d, stroke: "#fff", "stroke-width": 2, fill: "none", class: "reference"}));
    label(x, bottom - 8, `${Number(px.toPrecision(3))} px/frame${speed}`);
    x += Math.max(length, 150) + 24;
  }
  if (layers.bar && metrePerPx) {
    const mm = nice(120 / zoom * metrePerPx * 1e3), length = mm / 1e3 / metrePerPx * zoom;
    const d = `M${x} ${bottom - 4}v8m0-4h${length}m0-4v8`;
    screen.append(draw("path", {d, stroke: "#000", "stroke-width": 4, fill: "none"}),
                  draw("path", {d, stroke: "#fff", "stroke-width": 2, fill: "none", class: "bar"}));
    label(x, bottom - 8, `${mm} mm`);
  }
}

function place() {
  const {scale, x, y} = picture.view;
  for (const group of [world, hand]) {
    group.setAttribute("transform", `translate(${x + scale / 2} ${y + scale / 2}) scale(${scale})`);
  }
}

function redraw(values) {
  const {layers, track, pose, shown, windows, scale, preview} = values;
  if (!layers) return;
  world.replaceChildren();
  const row = track?.has("cx_px") ? track.row(shown) : -1;
  if (track?.has("cx_px") && layers.path) drawPath(track);
  if (layers.arrows) drawArrows(windows, scale ?? 1, track, row);
  if (row >= 0 && layers.circle) drawCircle(track, row);
  if (row >= 0 && layers.axes && pose) drawAxes(pose, track, row);
  if (preview && preview.frame === shown && preview.row) drawCircle(null, -1, preview);
  drawReferences(values);
  place();
}
on(["layers", "track", "pose", "shown", "windows", "scale", "preview", "metrePerPx"], redraw);
picture.onMove(() => {
  place();
  if (get("layers")) drawReferences({layers: get("layers"), track: get("track"), scale: get("scale") ?? 1,
                                     clip: get("clip"), metrePerPx: get("metrePerPx")});
});
svg.append(hand);
