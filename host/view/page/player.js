// Plays and scrubs: which frame is wanted, and which one is on the screen.
import {id, say} from "./dom.js";
import {Frames} from "./frames.js";
import * as picture from "./picture.js";
import {get, on, set} from "./store.js";

const SPEEDS = [1, 5, 10, 30, 60];  // pictures a second
let frames = null, playing = false, started = 0, from = 0, direction = 1;

for (const speed of SPEEDS) id("speed").add(new Option(`${speed}/s`, speed, speed === 30, speed === 30));

// A clip to be shown, from its first frame on, or none.
export function open(clip, shot) {
  stop();
  const usable = Boolean(clip);
  for (const name of ["back", "play", "forth", "scrub", "frame", "speed"]) id(name).disabled = !usable;
  frames = usable ? new Frames(clip, shot, arrived, say) : null;
  id("scrub").max = id("frame").max = usable ? clip.frames - 1 : 0;
  if (usable) picture.setSize(clip.width, clip.height);
}

export function setContrast(black, white) {
  frames?.setContrast(black, white);
  show(get("frame") ?? 0);
}

// As the pictures are shown; nothing without a clip.
export const contrast = () => (frames ? {black: frames.contrast[0], white: frames.contrast[1]} : {});

export function show(frame) {
  const last = get("clip") ? get("clip").frames - 1 : 0;
  const next = Math.min(last, Math.max(0, Math.round(frame) || 0));
  direction = next < (get("frame") ?? 0) ? -1 : 1;
  set({frame: next});
  id("scrub").value = next;
  if (document.activeElement !== id("frame")) id("frame").value = next;
  if (!frames) return set({shown: next});  // results whose clip is gone
  if (frames.get(next)) arrived(next);
  frames.want(next, direction);
}

// The overlay belongs to the picture that is there, not to the one that is still to come.
function arrived(frame) {
  if (frame !== get("frame")) return;
  picture.show(frames.get(frame), frames.width, frames.height, frames.shrink);
  set({shown: frame, pictures: (get("pictures") ?? 0) + 1});
}

export function play() {
  const clip = get("clip");
  if (!frames || !clip) return;
  if (get("frame") >= clip.frames - 1) show(0);
  playing = true;
  from = get("frame");
  started = performance.now();
  id("play").textContent = "❚❚";
  requestAnimationFrame(tick);
}

export function stop() {
  playing = false;
  id("play").textContent = "▶";
}

// One picture after the other, none left out: where they come slowly, time waits.
function tick(now) {
  if (!playing) return;
  const speed = Number(id("speed").value), here = get("frame");
  const due = from + Math.floor((now - started) * speed / 1000);
  if (due > here && get("shown") === here) {
    if (here >= get("clip").frames - 1) return stop();
    show(here + 1);
    if (due > here + 3) { from = here + 1; started = now; }
  }
  requestAnimationFrame(tick);
}

id("play").onclick = () => (playing ? stop() : play());
id("back").onclick = () => { stop(); show(get("frame") - 1); };
id("forth").onclick = () => { stop(); show(get("frame") + 1); };
id("scrub").oninput = () => { stop(); show(Number(id("scrub").value)); };
id("frame").onchange = () => { stop(); show(Number(id("frame").value)); };
id("speed").onchange = () => { from = get("frame"); started = performance.now(); };

const STEPS = {ArrowLeft: -1, ArrowRight: 1, PageUp: -10, PageDown: 10};
id("picture").addEventListener("keydown", event => {
  if (event.ctrlKey || event.altKey || event.metaKey) return;
  if (event.shiftKey && event.key.startsWith("Arrow")) {
    picture.pan({ArrowLeft: 40, ArrowRight: -40}[event.key] || 0,
                {ArrowUp: 40, ArrowDown: -40}[event.key] || 0);
  } else if (event.key in STEPS) { stop(); show(get("frame") + STEPS[event.key]);
  } else if (event.key === "Home") show(0);
  else if (event.key === "End") show(get("clip").frames - 1);
  else if (event.key === " ") playing ? stop() : play();
  else if (event.key === "+" || event.key === "=") picture.zoom(1.25);
  else if (event.key === "-") picture.zoom(0.8);
  else if (event.key === "0") picture.fit();
  else return;
  event.preventDefault();
});

on(["shown"], ({shown, clip}) => {
  id("time").textContent = clip?.fps ? `${(1000 * shown / clip.fps).toFixed(2)} ms` : "";
});
