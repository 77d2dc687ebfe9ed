// Frames corrected by hand: the setting ball-at, "FRAME:X,Y,R/FRAME:none".
import {make} from "./dom.js";
import * as player from "./player.js";
import * as run from "./run.js";
import * as settings from "./settings.js";
import {get, on} from "./store.js";
import * as tools from "./tools.js";

const KEY = "ball-at", WHOLE = ["ok", "last_frame", "reference"];

// What stands behind each frame's number.
export function corrections(values) {
  return new Map((values?.[KEY] ?? "").split("/").filter(Boolean).map(one => {
    const [frame, what] = one.split(":");
    return [Number(frame), what ?? ""];
  }));
}

// "" takes the frame as it is found.
function correct(frame, what) {
  const all = corrections(get("settings"));
  if (what) all.set(frame, what); else all.delete(frame);
  settings.change(KEY, [...all].sort((a, b) => a[0] - b[0]).map(([f, w]) => `${f}:${w}`).join("/"));
}

// Frames that were not measured in full.
const lost = track => (track?.has("status") ? track.rows.flatMap((_, k) => (WHOLE.includes(track.cell(k, "status")) ? [] : [track.number(k, "frame")])) : []);

function seek(step) {
  const frames = lost(get("track")), here = get("frame");
  const next = step > 0 ? frames.find(f => f > here) : frames.filter(f => f < here).pop();
  if (next !== undefined) player.show(next);
}

// Leads from one lost frame to the next.
export function buildLost(where) {
  const words = make("span", {id: `lost-${where}`});
  const back = make("button", {id: `lost-back-${where}`, textContent: "‹ lost", title: "To the one before that was not measured in full", onclick: () => seek(-1)});
  const forth = make("button", {id: `lost-forth-${where}`, textContent: "lost ›", title: "To the next one that was not measured in full", onclick: () => seek(1)});
  const row = make("div", {className: "row"}, words, back, forth);
  on(["track", "frame"], ({track, frame}) => {
    const frames = lost(track);
    row.hidden = !frames.length;
    words.textContent = `${frames.length} of ${track?.rows.length ?? 0} frames are not measured in full`;
    back.disabled = !(frames[0] < frame);
    forth.disabled = !(frames[frames.length - 1] > frame);
  });
  return row;
}

export function build() {
  const words = make("span", {id: "correct-frame"}), list = make("div", {className: "row", id: "corrected"});
  const here = make("button", {className: "tool", id: "draw-correct", textContent: "the ball is here", title: "Drag from the ball's centre to its rim",
    onclick: () => tools.choose("correct", ({x, y, r}) => correct(get("shown"), [x, y, r].map(v => v.toFixed(1)).join(",")))});
  const none = make("button", {id: "correct-none", textContent: "no ball", title: "There is no ball in this frame", onclick: () => correct(get("shown"), "none")});
  const undo = make("button", {id: "correct-undo", textContent: "as found", title: "Without a correction", onclick: () => correct(get("shown"), "")});
  // Behind what was measured: the results of this shot, measured again from before what has changed.
  const go = make("button", {className: "main", id: "go-on", textContent: "Go on with this", hidden: true,
    title: "Measures the frames again that the correction can change, into the same folder", onclick: run.goOn});
  on(["settings", "state", "run"], ({settings: values, state, run: status}) => {
    go.hidden = !state?.files.includes("track.csv") || (values?.[KEY] ?? "") === (state.given?.[KEY] ?? "");
    go.disabled = status?.state === "running";
  });
  on(["shown", "settings", "clip"], ({shown, settings: values, clip}) => {
    const all = corrections(values);
    words.textContent = `Frame ${shown ?? 0}:`;
    undo.disabled = !all.has(shown);
    here.disabled = none.disabled = !clip;
    list.hidden = !all.size;
    list.replaceChildren("Corrected:", ...[...all].map(([frame, what]) => make("button", {className: "link", textContent: String(frame), title: what, onclick: () => player.show(frame)})));
  });
  return [make("div", {className: "row", role: "group", ariaLabel: "Correct this frame by hand"}, words, here, none, undo, go), list, buildLost("setup")];
}
