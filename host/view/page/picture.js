// The picture and how it lies on the screen: zoom, pan, pointers. Pixel centres lie at integers.
import {id} from "./dom.js";

const box = id("picture"), canvas = id("canvas"), context = canvas.getContext("2d");
const grey = document.createElement("canvas"), greyContext = grey.getContext("2d");
const MOST_ZOOM = 64;

// Screen = offset + scale * (picture + 1/2), in CSS pixels of the box.
export const view = {scale: 1, x: 0, y: 0, fitted: true};
const moved = [];     // called when the picture lies elsewhere
const painters = [];  // called with the context, in picture coordinates, after the picture
let size = {width: 0, height: 0}, drawn = size;
let tool = null;

export const onMove = listener => moved.push(listener);
export const paintAlso = painter => painters.push(painter);
export const pictureSize = () => size;

// Draws by pointer instead of panning: {down, move, up} with points of the picture; null: pan.
export function setTool(next) {
  tool = next;
  box.classList.toggle("drawing", Boolean(next));
}

export function setSize(width, height) {
  size = {width, height};
  fit();
}

export function fit() {
  const {clientWidth: w, clientHeight: h} = box;
  if (!size.width || !w || !h) return;
  view.scale = Math.min(w / size.width, h / size.height);
  view.x = (w - view.scale * size.width) / 2;
  view.y = (h - view.scale * size.height) / 2;
  view.fitted = true;
  changed();
}

export function zoom(factor, x = box.clientWidth / 2, y = box.clientHeight / 2) {
  const least = Math.min(box.clientWidth / size.width, box.clientHeight / size.height) / 4;
  const scale = Math.min(MOST_ZOOM, Math.max(least, view.scale * factor));
  view.x = x - (x - view.x) * scale / view.scale;
  view.y = y - (y - view.y) * scale / view.scale;
  view.scale = scale;
  view.fitted = false;
  changed();
}

export function pan(dx, dy) {
  view.x += dx;
  view.y += dy;
  view.fitted = false;
  changed();
}

// `grey`: bytes of (height, width), which may be shrunk against the clip.
export function show(bytes, width, height, shrink) {
  if (grey.width !== width || grey.height !== height) { grey.width = width; grey.height = height; }
  const image = greyContext.createImageData(width, height);
  const words = new Uint32Array(image.data.buffer);
  for (let i = 0; i < bytes.length; ++i) words[i] = 0xff000000 | bytes[i] * 0x010101;
  greyContext.putImageData(image, 0, 0);
  drawn = {width: width * shrink, height: height * shrink};
  paint();
}

// `density`: pixels to one of the screen.
function paintOn(canvas, context, density) {
  const w = Math.round(box.clientWidth * density), h = Math.round(box.clientHeight * density);
  if (canvas.width !== w || canvas.height !== h) { canvas.width = w; canvas.height = h; }
  context.setTransform(1, 0, 0, 1, 0, 0);
  context.clearRect(0, 0, w, h);
  const s = view.scale * density;
  context.setTransform(s, 0, 0, s, view.x * density, view.y * density);
  context.imageSmoothingEnabled = view.scale < 2;
  if (grey.width) context.drawImage(grey, 0, 0, drawn.width, drawn.height);
  context.translate(0.5, 0.5);
  for (const painter of painters) painter(context);
}

export const paint = () => paintOn(canvas, context, devicePixelRatio || 1);

// What is on the screen, finer, for a file.
export function render(density) {
  const copy = document.createElement("canvas");
  paintOn(copy, copy.getContext("2d"), density);
  return copy;
}

function changed() {
  paint();
  for (const listener of moved) listener(view);
}

export function toPicture(event) {
  const at = box.getBoundingClientRect();
  return {x: (event.clientX - at.left - view.x) / view.scale - 0.5,
          y: (event.clientY - at.top - view.y) / view.scale - 0.5};
}

const pointers = new Map();
let clicked = null;  // where a press began that may become a click
export let onClick = null;
export const setClick = listener => { onClick = listener; };

box.addEventListener("pointerdown", event => {
  if (event.target.closest("#legend")) return;
  box.setPointerCapture(event.pointerId);
  pointers.set(event.pointerId, event);
  clicked = pointers.size === 1 ? event : null;
  if (tool && pointers.size === 1) tool.down(toPicture(event));
});
box.addEventListener("pointermove", event => {
  const before = pointers.get(event.pointerId);
  if (!before) return;
  const others = [...pointers.values()].filter(p => p.pointerId !== event.pointerId);
  pointers.set(event.pointerId, event);
  if (clicked && Math.hypot(event.clientX - clicked.clientX, event.clientY - clicked.clientY) > 4) {
    clicked = null;
  }
  if (others.length === 1) {  // two fingers
    const [other] = others, at = box.getBoundingClientRect();
    const far = (a, b) => Math.hypot(a.clientX - b.clientX, a.clientY - b.clientY) || 1;
    zoom(far(event, other) / far(before, other), (event.clientX + other.clientX) / 2 - at.left,
         (event.clientY + other.clientY) / 2 - at.top);
  } else if (tool) {
    tool.move(toPicture(event));
  } else {
    pan(event.clientX - before.clientX, event.clientY - before.clientY);
  }
});
for (const name of ["pointerup", "pointercancel"]) {
  box.addEventListener(name, event => {
    if (!pointers.delete(event.pointerId)) return;
    if (tool && !pointers.size) tool.up(toPicture(event));
    else if (clicked && name === "pointerup" && onClick) onClick(toPicture(event));
    clicked = null;
  });
}
box.addEventListener("wheel", event => {
  event.preventDefault();
  const at = box.getBoundingClientRect();
  zoom(Math.exp(-event.deltaY * (event.deltaMode ? 0.05 : 0.0015)), event.clientX - at.left,
       event.clientY - at.top);
}, {passive: false});
box.addEventListener("dblclick", () => { if (!tool) fit(); });
new ResizeObserver(() => (view.fitted ? fit() : changed())).observe(box);
