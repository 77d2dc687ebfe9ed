// What a fit made of the shot: its parameters, the model over the measurement, and what it leaves.
import {id, make} from "./dom.js";
import {BLACK, BLUE, ORANGE} from "./colours.js";
import {axis, CONFIG, LEGEND, cursorOver, plotly} from "./plots.js";
import {get, on} from "./store.js";
import {withDeviation} from "./table.js";

const MM = 1e3, UM = 1e6, MRAD = 1e3;

// The rows of one series: times, ms, and what the model has more than the measurement.
function series(residuals, name) {
  const rows = residuals.rows.map((_, k) => k).filter(k => residuals.cell(k, "series") === name);
  return {at: rows.map(k => 1e3 * residuals.number(k, "time_s")), off: rows.map(k => residuals.number(k, "residual"))};
}

// Where the centre was measured, and where the model has it, from the first frame on.
function paths(track, residuals) {
  return [["x_m", "x, right", BLUE], ["y_m", "y, up", ORANGE]].flatMap(([column, name, color]) => {
    const {at, off} = series(residuals, column), times = track.numbers("time_s").map(t => 1e3 * t), places = track.numbers(column);
    const row = new Map(times.map((t, k) => [t.toFixed(6), k])), seen = at.map(t => places[row.get(t.toFixed(6))] ?? NaN);
    const origin = seen.find(Number.isFinite) ?? 0;
    return [{x: at, y: seen.map(v => MM * (v - origin)), name: `${name}, measured`, mode: "markers", marker: {color, size: 4}},
            {x: at, y: seen.map((v, k) => MM * (v + off[k] - origin)), name: `${name}, model`, mode: "lines", line: {color, width: 1.5}}];
  });
}

const left = (residuals, name, title, color, factor, yaxis) => {
  const {at, off} = series(residuals, name);
  return {x: at, y: off.map(v => factor * v), name: title, yaxis, mode: "markers", marker: {color, size: 4}, showlegend: false};
};

async function draw({residuals, track, plots}) {
  const plot = id("model-curves");
  plot.hidden = !residuals || !track || !plots;
  if (plot.hidden) return;
  const Plotly = await plotly(), first = !plot._fullLayout;
  await Plotly.react(plot, [...paths(track, residuals),
    left(residuals, "x_m", "x", BLUE, UM, "y2"), left(residuals, "y_m", "y", ORANGE, UM, "y2"), left(residuals, "turn_rad", "turn", BLACK, MRAD, "y3")],
    {margin: {l: 58, r: 8, t: 28, b: 40}, grid: {rows: 3, columns: 1, subplots: [["xy"], ["xy2"], ["xy3"]], ygap: 0.12},
     xaxis: {...axis("time, ms"), anchor: "y3"}, yaxis: axis("place, mm"), yaxis2: axis("left of place, µm"), yaxis3: axis("left of turn, mrad"),
     legend: LEGEND, font: {size: 11}, hovermode: "closest"}, CONFIG);
  if (first) cursorOver(plot, () => 1e3 * (get("track")?.number(get("track").row(get("shown")), "time_s") ?? NaN));
}

export function build() {
  const title = make("h2", {textContent: "Model"}), list = make("ul", {id: "parameters"}), failed = make("p", {className: "soft"});
  on(["residuals", "state"], ({residuals, state}) => {
    title.hidden = list.hidden = !residuals;
    list.replaceChildren(...Object.entries(state?.parameters ?? {}).map(([name, {value, sd, determined}]) =>
      make("li", {textContent: `${name} ${Number.isFinite(value) ? withDeviation(String(value), Number.isFinite(sd) ? String(sd) : "") : "not measured"}${determined === false ? " (not determined)" : ""}`})));
  });
  on(["residuals", "track", "plots"], values => draw(values).catch(error => { failed.textContent = error.message; }));
  return [title, list, make("div", {className: "plot", id: "model-curves", hidden: true}), failed];
}
