// The panel that runs the measurement: progress, rows as they come, stop and resume.
import * as server from "./server.js";
import {id, make} from "./dom.js";
import {get, on, set} from "./store.js";
import {Table} from "./table.js";

const EVERY_MS = 400, LATEST_ROWS = 6;
let rows = [], header = "", watching = false, reopen = null, running = null;

// Called with "done" or "stopped" when a run has ended, to show its results.
export const setReopen = listener => { reopen = listener; };

// Rows come in pixels; metres are known when the run has ended.
async function look() {
  const status = await server.json("run", {from: rows.length});
  header = status.header;
  rows = rows.slice(0, status.from).concat(status.rows);
  if (status.state === "running" && status.rows.length) set({track: new Table([header, ...rows].join("\n"))});
  set({run: status});
  return status;
}

async function watch() {
  if (watching) return;
  watching = true;
  try {
    let status = await look();
    while (status.state === "running") {
      await new Promise(done => setTimeout(done, EVERY_MS));
      status = await look();
    }
    if (running === "here" && status.state !== "failed") await reopen?.(status.state);
    running = null;
  } catch (error) { set({runError: error.message}); }
  watching = false;
}

async function start(more) {
  set({runError: ""});
  rows = [];
  try {
    await server.post("run", {shot: get("shot"), settings: get("settings") ?? {}, folder: get("outFolder"), ...more});
    running = "here";
    await watch();
  } catch (error) { set({runError: error.message}); }
}

// With what was corrected by hand, in the folder that is shown.
export function goOn() {
  id("tab-run").click();
  return start({resume: true, folder: get("folder")});
}

const WORDS = {idle: "Nothing runs.", running: "Measuring", done: "Done.", stopped: "Stopped: what was measured stays, resume goes on.",
               failed: "Failed."};

export function build() {
  const folder = make("input", {id: "out-folder", type: "text", spellcheck: false, onchange: () => set({outFolder: folder.value.trim()})});
  const force = make("input", {id: "force", type: "checkbox"});
  const go = make("button", {className: "main", id: "run", textContent: "Run", onclick: () => start({force: force.checked})});
  const resume = make("button", {id: "resume", textContent: "Resume", onclick: () => start({resume: true})});
  const stop = make("button", {id: "stop", textContent: "Stop", onclick: () => server.post("stop", {}).catch(() => {})});
  const words = make("p", {id: "run-state", role: "status"}), bar = make("progress", {id: "progress", max: 1, value: 0});
  const wrong = make("p", {className: "error", id: "run-error"}), messages = make("pre", {id: "messages", hidden: true});
  const latest = make("div", {className: "scroll"});
  on(["outFolder"], ({outFolder}) => { if (document.activeElement !== folder) folder.value = outFolder ?? ""; });
  on(["run", "runError", "clip"], ({run, runError, clip}) => {
    const busy = run?.state === "running";
    go.disabled = resume.disabled = busy || !clip;
    stop.disabled = !busy;
    bar.hidden = !busy;
    bar.value = busy && run.total ? run.done / run.total : 0;
    words.dataset.state = run?.state ?? "";
    words.textContent = (WORDS[run?.state] ?? "") + (busy && run.total ? ` ${run.done} of ${run.total} frames` : "")
      + (busy && run.compiling ? ` (${run.compiling})` : "");
    wrong.textContent = runError || run?.error || "";
    messages.textContent = (run?.messages ?? []).join("\n");
    messages.hidden = !messages.textContent;
    latest.replaceChildren(...(busy || rows.length ? [table()] : []));
  });
  on(["command", "job"], ({job}) => { command.textContent = job?.command ?? ""; command.hidden = !job; });
  const command = make("div", {className: "command", hidden: true});
  watch();
  return [make("div", {className: "row"}, make("label", {}, "Folder for the results ", folder), make("label", {}, force, "also where it holds files")),
          command, make("div", {className: "row"}, go, stop, resume), words, bar, wrong, latest, messages];
}

// Column of track.csv, its name here, digits behind the point.
const LATEST = [["frame", "frame", 0], ["status", "status"], ["cx_px", "x", 2], ["cy_px", "y", 2], ["r_px", "r", 2], ["dx_px", "dx", 3],
                ["dy_px", "dy", 3], ["rot_deg", "turn", 3]];

// The latest rows, in px and degrees, as wide as a phone.
function table() {
  const names = header.split(","), keep = LATEST.filter(([column]) => names.includes(column));
  const line = (cells, tag) => make("tr", {}, ...cells.map(cell => make(tag, {textContent: cell})));
  const short = (cell, digits) => (digits === undefined ? cell.replaceAll("_", " ") : cell === "" ? "" : Number(cell).toFixed(digits));
  const body = rows.slice(-LATEST_ROWS).reverse().map(row => {
    const cells = row.split(",");
    return line(keep.map(([column, , digits]) => short(cells[names.indexOf(column)], digits)), "td");
  });
  return make("table", {id: "latest", title: "px and degrees"}, make("thead", {}, line(keep.map(([, name]) => name), "th")), make("tbody", {}, ...body));
}
