// The panel to set a measurement up: settings, drawing, and this frame measured again at once.
import * as server from "./server.js";
import {make, say} from "./dom.js";
import {rigidMotion} from "./field.js";
import * as corrections from "./corrections.js";
import * as settings from "./settings.js";
import {get, on, set} from "./store.js";
import * as tools from "./tools.js";
import {withDeviation} from "./table.js";

const WAIT_MS = 15;          // after the last change
const SLOW_MS = 700;         // above which it is said that something is at work
const RADIUS_SPREAD = 0.15;  // about a radius drawn by hand

const tool = (name, text, title, found) => make("button", {className: "tool", id: `draw-${name}`, textContent: text, title,
  onclick: () => tools.choose(name, found)});

// Fields that can be drawn, and the lengths that a drawn scale needs.
function drawing() {
  const length = make("input", {id: "scale-mm", type: "text", inputMode: "decimal", autocomplete: "off"});
  const takeScale = () => {
    const line = get("hand")?.scale, mm = Number(length.value);
    if (!line || !(mm > 0)) return;
    settings.change("ball-diameter-mm", "");
    settings.change("mm-per-px", String(Number((mm / line.px).toPrecision(6))));
  };
  length.onchange = takeScale;
  return {
    "surface-angle-deg": [tool("surface", "draw", "Drag along the surface", found => settings.change("surface-angle-deg", String(found.angle)))],
    "gravity-angle-deg": [tool("gravity", "draw", "Drag the way things fall: along a plumb line, downwards", found => settings.change("gravity-angle-deg", String(found.angle)))],
    roi: [tool("roi", "draw", "Drag a rectangle", ({x, y, w, h}) => settings.change("roi", `${x},${y},${w},${h}`))],
    polygon: [make("button", {className: "tool", id: "draw-polygon", textContent: "draw",
      title: "Click the corners; Enter, a click on the first one or here closes it: the ball's centre lies inside",
      onclick: () => tools.choosePolygon(corners => {
        set({hand: {...get("hand"), polygon: undefined}});
        settings.change("polygon", corners.map(({x, y}) => `${x},${y}`).join(","));
      })})],
    "radius-px": [tool("ball", "draw", "Drag from the ball's centre to its rim", ({r}) => settings.change("radius-px",
      `${Math.floor((1 - RADIUS_SPREAD) * r)}:${Math.ceil((1 + RADIUS_SPREAD) * r)}`))],
    "mm-per-px": [tool("scale", "draw", "Drag along a known length, then type it", takeScale),
                  make("label", {htmlFor: "scale-mm", textContent: "length of the drawn line, mm"}), length, make("span")],
  };
}

let current = null, timer = 0;

// As the program answers; the windows of the same frame stay until there are new ones.
function takeOver(found, old) {
  const windows = found.windows[0]?.map((_, k) => Object.fromEntries(found.columns.map((name, c) => [name, found.windows[c][k] ?? NaN])));
  const row = {has: () => true, number: (_, name) => (found.row[name] ? Number(found.row[name]) : NaN)};
  const keep = !windows && old?.frame === found.frame;
  settings.mark("");
  set({preview: {...found, windows: windows ?? (keep ? old.windows : []), motion: keep ? old.motion : rigidMotion(row, 0)},
       previewError: "", metrePerPx: found.m_per_px});
}

// The outline at once, then all of it.
async function measure() {
  const frame = get("shown");
  if (get("panel") !== "setup" || frame === undefined || !get("clip")) return;
  current?.abort();
  const mine = current = new AbortController();
  const slow = setTimeout(async () => {
    const {compiling} = await server.json("run", {from: 0}).catch(() => ({}));
    if (mine === current) set({busy: compiling || "measuring"});
  }, SLOW_MS);
  try {
    for (const outline of [true, false]) {
      const found = await server.post("measure", {shot: get("shot"), frame, settings: get("settings"), outline}, mine.signal);
      if (mine !== current) return;
      takeOver(found, get("preview"));
    }
  } catch (error) {
    if (error.name === "AbortError" || mine !== current || error.status === 409) return;
    settings.mark(error.message);
    set({preview: null, previewError: error.message});
  } finally {
    clearTimeout(slow);
    if (mine === current) set({busy: ""});
  }
}

async function showJob() {
  try {
    const job = await server.post("job", {shot: get("shot"), settings: get("settings"), folder: get("outFolder")});
    set({job});
  } catch { set({job: null}); }
}

function soon() {
  if (get("panel") !== "setup") {
    // One frame's scale is not that of the run.
    if (get("preview")) set({preview: null, metrePerPx: get("summary")?.scale_m_per_px ?? null});
    return;
  }
  clearTimeout(timer);
  timer = setTimeout(() => { measure(); showJob(); }, WAIT_MS);
}
on(["settings", "shown", "panel", "clip", "outFolder"], soon);

const cell = (preview, column, sd) => withDeviation(preview.row[column] ?? "", preview.row[sd] ?? "");

// What was found in this frame, and what this clip and pattern let one expect.
function words({preview, previewError, busy}) {
  if (previewError) return previewError;
  if (!preview) return busy ? `${busy} …` : "";
  const {row, advice} = preview;
  const parts = [`frame ${preview.frame}: ${row.status}`];
  if (row.r_px) parts.push(`radius ${cell(preview, "r_px", "r_sd_px")} px`);
  if (row.dx_px) parts.push(`dx ${cell(preview, "dx_px", "dx_sd_px")}, dy ${cell(preview, "dy_px", "dy_sd_px")} px, turn ${cell(preview, "rot_deg", "rot_sd_deg")}°`);
  const text = [parts.join(", ")];
  if (advice?.windows) {
    const {usable, windows, window_px: size, expected_error_px: error} = advice.windows;
    text.push(`expected: ${error === null ? "no" : error.toPrecision(2)} px a window of ${size} px (${Math.round(100 * usable / Math.max(1, windows))} % usable)`
      + (advice.ball ? `, ${Math.hypot(advice.ball.dx_sd_px, advice.ball.dy_sd_px).toPrecision(2)} px the ball` : ""));
  }
  if (busy) text.push(`${busy} …`);
  return text.join("\n");
}

export function build() {
  const fields = make("div", {id: "settings"}), found = make("pre", {id: "found", role: "status"});
  const command = make("div", {className: "command", id: "command"});
  const save = make("a", {id: "save-job", textContent: "Save job.toml", download: "job.toml"});
  let link = "";
  on(["preview", "previewError", "busy"], values => {
    found.textContent = words(values);
    found.classList.toggle("error", Boolean(values.previewError));
    found.dataset.ms = values.preview?.ms ?? "";
  });
  on(["job"], ({job}) => {
    command.textContent = job?.command ?? "";
    command.hidden = save.hidden = !job;
    URL.revokeObjectURL(link);
    link = job ? URL.createObjectURL(new Blob([job.toml], {type: "application/toml"})) : "";
    save.href = link;
  });
  on(["state"], ({state}) => {
    if (!fields.childElementCount) fields.append(...settings.build(state.settings, drawing()));
    settings.fill(state.given ?? {});
    set({hand: {}, preview: null, previewError: ""});
  });
  const reset = make("button", {textContent: "All defaults", onclick: () => { settings.fill({}); set({hand: {}}); say(""); }});
  return [make("p", {className: "soft", textContent: "Type or draw; the frame that is shown is measured again at once. Names have the texts of impactdic track --help."}),
          found, ...corrections.build(), fields, make("div", {className: "row"}, reset, save), command];
}
