// Puts the page together.
import * as server from "./server.js";
import {id, make, say} from "./dom.js";
import * as look from "./look.js";
import {arrowScale} from "./overlay.js";
import * as player from "./player.js";
import * as compare from "./compare.js";
import * as run from "./run.js";
import * as setup from "./setup.js";
import {get, set} from "./store.js";
import {Table} from "./table.js";

const PANELS = {look: ["Look", look], setup: ["Set up", setup], run: ["Run", run],
                compare: ["Compare", compare]};

function choosePanel(name) {
  for (const key of Object.keys(PANELS)) {
    id(`tab-${key}`).setAttribute("aria-selected", key === name);
    id(`panel-${key}`).hidden = key !== name;
  }
  id("main").dataset.panel = name;
  set({panel: name});
}

function buildPanels() {
  for (const [key, [name, module]] of Object.entries(PANELS)) {
    id("tabs").append(make("button", {id: `tab-${key}`, role: "tab", textContent: name, onclick: () => choosePanel(key)}));
    id("side").append(make("div", {id: `panel-${key}`, role: "tabpanel"}, ...module.build()));
  }
}

// A file of results, or null where there is none.
const result = (state, name) => state.files.includes(name) ? server.text("file", {shot: get("shot"), name}) : null;
const table = async (state, name) => { const csv = await result(state, name); return csv ? new Table(csv) : null; };

// What the results of the shot hold.
export async function loadResults(state) {
  const [track, motion, pose, summary, residuals] = await Promise.all(
    [table(state, "track.csv"), table(state, "motion.csv"), table(state, "pose.csv"), result(state, "summary.json"),
     table(state, "residuals.csv")]);
  let parsed = null;
  try { parsed = summary && JSON.parse(summary); } catch { say("summary.json cannot be read"); }
  set({track: track ?? motion, pose, residuals, summary: parsed, fields: state.fields, folder: state.folder,
       scale: arrowScale(track), metrePerPx: parsed?.scale_m_per_px ?? null, history: null});
}

// `frame`: the one to begin with.
export async function openShot(shot, frame = 0) {
  const state = await server.json("state", {shot});
  document.title = `${shot || state.title} · impactdic`;
  id("title").textContent = shot || state.title;
  set({shot, plots: state.plots, excluded: state.excluded, clip: state.clip, fields: null, windows: null, preview: null, frame, shown: undefined,
       outFolder: state.proposed, state});
  say(state.clip_error ? `The clip is not shown: ${state.clip_error}` : "");
  player.open(state.clip, shot);
  player.show(frame);
  await loadResults(state);
  return state;
}

async function begin() {
  set({layers: look.START, shot: ""});
  buildPanels();
  run.setReopen(async ended => {
    await openShot(get("shot"), get("frame"));
    if (ended === "done") choosePanel("look");
  });
  const state = await openShot("");
  choosePanel(state.shots_table ? "compare" : state.shots.length || state.files.length ? "look" : "setup");
  id("tab-compare").hidden = !state.shots_table;
  compare.setShow(async name => {
    await openShot(name);
    id("shot").value = name;
    choosePanel("look");
  });
  if (state.shots.length) {
    id("shots").hidden = false;
    for (const name of state.shots) id("shot").add(new Option(name, name));
    id("shot").onchange = () => openShot(id("shot").value).catch(error => say(error.message));
    await openShot(state.shots[0]);
  }
  set({ready: true});
  document.documentElement.dataset.ready = "yes";
}

begin().catch(error => say(error.message));
