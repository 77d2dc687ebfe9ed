// The shots of a batch: a table that sorts, leads to each shot, and leaves shots out for a reason.
import * as server from "./server.js";
import {make} from "./dom.js";
import {get, on, set} from "./store.js";
import {Table, withDeviation} from "./table.js";

// Name on the page, column of shots.csv, column of its deviation, what its unit is multiplied by.
const COLUMNS = [["shot", "shot"], ["status", "status"], ["surface, °", "surface_angle_deg"], ["ball", "ball"],
                 ["e", "restitution", "restitution_sd"], ["friction", "friction", "friction_sd"],
                 ["contact, ms", "contact_s", "contact_sd_s", 1e3], ["in, m/s", "vn_before_m_s", "vn_before_sd_m_s"],
                 ["doubtful", "doubtful"], ["notes", "notes"]];
const MEANS = [["e", "restitution", "restitution_sd"], ["friction", "friction", "friction_sd"]];

let order = {column: null, down: false}, group = "", show = null;

// Called with the name of a shot that was clicked.
export const setShow = listener => { show = listener; };

function sorted(table) {
  const rows = table.rows.map((_, k) => k);
  if (!order.column) return rows;
  const key = k => { const cell = table.cell(k, order.column); return cell === "" ? null : Number.isNaN(Number(cell)) ? cell : Number(cell); };
  // What was not measured comes last, whichever way.
  return rows.sort((a, b) => {
    const [x, y] = [key(a), key(b)];
    if (x === null || y === null) return (x === null) - (y === null);
    const less = typeof x === typeof y ? x < y : typeof x === "number";
    return (x === y ? 0 : less ? -1 : 1) * (order.down ? -1 : 1);
  });
}

async function exclude(shot, reason) {
  try {
    set({excluded: (await server.post("exclude", {shot, reason})).excluded, compareError: ""});
  } catch (error) { set({compareError: error.message}); }
}

// Mean of the shots that count, and its deviation: out of their scatter, or of their own deviations where
// those say more (scripts/impactdic/report/groups.py).
function mean(values, own) {
  const n = values.length, m = values.reduce((a, b) => a + b, 0) / n;
  const scatter = n > 1 ? Math.sqrt(values.reduce((a, b) => a + (b - m) ** 2, 0) / (n - 1) / n) : NaN;
  const said = [scatter, Math.hypot(...own) / n].filter(Number.isFinite), sd = said.length ? Math.max(...said) : NaN;
  return `${withDeviation(String(m), Number.isFinite(sd) ? String(sd) : "")} (${n === 1 ? "one shot, its own deviation" : n})`;
}

// Its name, else what is known of it (scripts/impactdic/report/groups.py).
function ballOf(table, k) {
  const known = [["ball_diameter_mm", v => `${v} mm`], ["mass_g", v => `${v} g`], ["inertia_factor", v => `I/mR² ${v}`]];
  return table.cell(k, "ball") || known.filter(([column]) => table.cell(k, column)).map(([column, words]) => words(table.cell(k, column))).join(", ") || "ball";
}
const surfaceOf = (table, k) => `${table.cell(k, "surface_angle_deg") || "?"}°`;
const GROUPS = {ball: ballOf, surface: surfaceOf};

// Balls and surfaces are never mixed, and figures in doubt do not count.
function groups(table, excluded) {
  const found = new Map();
  table.rows.forEach((_, k) => {
    if (table.cell(k, "status") !== "ok" || table.cell(k, "doubtful") || excluded[table.cell(k, "shot")] !== undefined) return;
    const name = [ballOf(table, k), surfaceOf(table, k)].join(", ");
    if (!found.has(name)) found.set(name, []);
    found.get(name).push(k);
  });
  return [...found].map(([name, rows]) => {
    const of = (column, sd) => rows.filter(k => Number.isFinite(table.number(k, column))).map(k => table.number(k, sd));
    const parts = MEANS.map(([title, column, sd]) => [title, of(column, column), of(column, sd)])
      .filter(([, values]) => values.length).map(([title, values, own]) => `${title} ${mean(values, own)}`);
    return make("li", {textContent: `${name}: ${parts.join(", ") || "nothing measured"}`});
  });
}

function line(table, k, excluded) {
  const shot = table.cell(k, "shot"), out = excluded[shot] !== undefined;
  const reason = make("input", {type: "text", value: excluded[shot] ?? "", placeholder: "reason", ariaLabel: `Why ${shot} is left out`,
                                onchange: () => exclude(shot, reason.value.trim())});
  const inUnit = (cell, unit) => (cell === "" ? "" : String(unit * Number(cell)));
  const cells = COLUMNS.filter(([, column]) => table.has(column)).map(([, column, sd, unit = 1]) => {
    const cell = table.cell(k, column);
    if (column === "status" && table.cell(k, "reason")) {
      const why = table.cell(k, "reason");
      return make("td", {title: why, textContent: `${cell}: ${why.split(" (")[0]}`});
    }
    if (column === "shot" && get("state").shots.includes(cell)) {
      return make("td", {}, make("button", {className: "link", textContent: cell, onclick: () => show(cell)}));
    }
    if (column === "doubtful" && cell.split(";").length > 2) {
      return make("td", {title: cell, textContent: `${cell.split(";").length} figures`});
    }
    const number = sd || (cell !== "" && Number.isFinite(Number(cell)));
    return make("td", {title: cell, className: sd ? "figure" : "", textContent: number ? withDeviation(inUnit(cell, unit), sd ? inUnit(table.cell(k, sd), unit) : "") : cell});
  });
  // On a narrow screen a row is a list of names and cells.
  COLUMNS.filter(([, column]) => table.has(column)).forEach(([title], i) => { cells[i].dataset.name = title; });
  const last = make("td", {}, reason);
  last.dataset.name = "left out because";
  return make("tr", {className: out ? "out" : ""}, ...cells, last);
}

// The rows in their order; in groups each under its name.
function body(table, excluded, columns) {
  const rows = sorted(table), of = GROUPS[group];
  if (!of) return rows.map(k => line(table, k, excluded));
  const names = [...new Set(rows.map(k => of(table, k)))].sort((a, b) => a.localeCompare(b, undefined, {numeric: true}));
  return names.flatMap(name => [
    make("tr", {className: "group"}, make("th", {colSpan: columns, scope: "rowgroup", textContent: name})),
    ...rows.filter(k => of(table, k) === name).map(k => line(table, k, excluded))]);
}

export function build() {
  const choice = make("select", {id: "group", onchange: () => { group = choice.value; redraw(); }},
                      new Option("no groups", ""), new Option("ball"), new Option("surface"));
  const place = make("div", {className: "scroll", id: "shots-table"}), list = make("ul", {id: "means"});
  const wrong = make("p", {className: "error"});
  const redraw = () => {
    const text = get("state")?.shots_table, excluded = get("excluded") ?? {};
    wrong.textContent = get("compareError") ?? "";
    if (!text) return;
    const table = new Table(text), titles = COLUMNS.filter(([, column]) => table.has(column));
    const head = titles.map(([title, column]) => make("th", {ariaSort: order.column === column ? (order.down ? "descending" : "ascending") : "none"},
      make("button", {textContent: title, onclick: () => {
        order = {column, down: order.column === column && !order.down};
        redraw();
      }})));
    place.replaceChildren(make("table", {}, make("thead", {}, make("tr", {}, ...head, make("th", {textContent: "left out because"}))),
                               make("tbody", {}, ...body(table, excluded, head.length + 1))));
    list.replaceChildren(...groups(table, excluded));
  };
  on(["state", "excluded", "compareError"], redraw);
  return [make("p", {className: "soft", textContent: "A click on a name shows the shot, one on a column sorts. A shot with a reason is left out of the means; the reasons are kept in excluded.csv."}),
          make("label", {}, "In groups by ", choice), place, make("h2", {textContent: "Means, with the deviation of the mean"}), list, wrong];
}
