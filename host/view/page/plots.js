// Curves of a shot with the frame that is shown, by plotly.
import {id, make} from "./dom.js";
import {BLACK, BLUE, ORANGE, RED, SKY} from "./colours.js";
import * as player from "./player.js";
import {get, on} from "./store.js";

const MOST_POINTS = 4000;  // of a curve: more take the browser long and show no more
export const CONFIG = {responsive: true, displaylogo: false, modeBarButtonsToRemove: ["lasso2d", "select2d"],
                toImageButtonOptions: {format: "svg", filename: "impactdic"}};
let loading = null;

// The script is large: it comes when the first curve is wanted, behind the picture.
export function plotly() {
  loading ??= new Promise((done, failed) => {
    const script = make("script", {src: "plotly.js"});
    script.onload = () => done(window.Plotly);
    script.onerror = () => failed(new Error("the plots' script is missing"));
    document.head.append(script);
  });
  return loading;
}

// Milliseconds of a row where times are known, else its frame.
function abscissa(track) {
  const times = track.numbers("time_s");
  return times.some(Number.isFinite) ? {name: "time, ms", at: times.map(t => 1e3 * t)}
                                     : {name: "frame", at: track.numbers("frame")};
}

const GROUPS = [
  [["velocity, m/s", [["vt_m_s", "along the surface", BLUE], ["vn_m_s", "out of it", ORANGE]]],
   ["px/frame", [["dx_px", "dx, right", BLUE], ["dy_px", "dy, down", ORANGE]]]],
  [["spin, rad/s", [["omega_rad_s", "spin", BLACK], ["omega_t_rad_s", "about t", SKY], ["omega_n_rad_s", "about n", RED]]],
   ["turn, °/frame", [["rot_deg", "turn", BLACK]]]],
  [["radius, px", [["r_px", "radius", BLUE]]]],
];
const DEVIATION = {vx_m_s: "vx_sd_m_s", omega_rad_s: "omega_sd_rad_s", r_px: "r_sd_px", dx_px: "dx_sd_px",
                   dy_px: "dy_sd_px", rot_deg: "rot_sd_deg"};

function traces(track) {
  const {at} = abscissa(track), step = Math.max(1, Math.ceil(at.length / MOST_POINTS));
  const thin = values => values.filter((_, k) => k % step === 0);
  const names = [], list = [];
  GROUPS.forEach((choices, n) => {
    const measured = column => track.has(column) && track.numbers(column).some(Number.isFinite);
    const [title, curves] = choices.find(([, c]) => measured(c[0][0])) ?? choices[choices.length - 1];
    names.push(title);
    for (const [column, name, colour] of curves.filter(([c]) => measured(c))) {
      const sd = DEVIATION[column] && track.has(DEVIATION[column]) ? thin(track.numbers(DEVIATION[column])) : null;
      list.push({x: thin(at), y: thin(track.numbers(column)), name, yaxis: `y${n ? n + 1 : ""}`, mode: "lines",
                 line: {color: colour, width: 1.5}, connectgaps: false,
                 customdata: thin(track.numbers("frame")).map((f, k) => [f, sd ? sd[k] : NaN]),
                 hovertemplate: `%{y:.5g}${sd ? " ± %{customdata[1]:.2g}" : ""}<extra>${name}, frame %{customdata[0]}</extra>`});
    }
  });
  return {names, list};
}

// Flight white, compression and restitution shaded.
function phases(track, summary) {
  const impact = summary?.impact;
  if (!impact?.found || !impact.t0 || !impact.t_end) return [];
  const {at} = abscissa(track), frames = track.numbers("frame");
  const place = frame => {
    const k = frames.findIndex(f => f >= frame);
    if (k < 1) return at[Math.max(k, 0)];
    return at[k - 1] + (at[k] - at[k - 1]) * (frame - frames[k - 1]) / (frames[k] - frames[k - 1]);
  };
  const part = (from, to, fillcolor, name) => ({type: "rect", xref: "x", yref: "paper", y0: 0, y1: 1, x0: place(from),
    x1: place(to), fillcolor, line: {width: 0}, layer: "below", name});
  const middle = impact.t_max_compression?.frame ?? impact.t_end.frame;
  return [part(impact.t0.frame, middle, "rgba(0,114,178,.14)", "compression"),
          part(middle, impact.t_end.frame, "rgba(230,159,0,.22)", "restitution")];
}

// Below the curves: above them stand the buttons.
export const LEGEND = {orientation: "h", y: -0.14, yanchor: "top", x: 0, font: {size: 11}};
export const axis = title => ({title: {text: title, font: {size: 12}}, zeroline: false, gridcolor: "#e8e8e8", automargin: true});

// Curves that were drawn while their panel was hidden, or another one was shown, take the width of
// their place.
export function fit(plot) {
  if (plot._fullLayout && plot.offsetParent && Math.abs(plot._fullLayout.width - plot.clientWidth) > 1) window.Plotly.Plots.resize(plot);
}
const watched = new ResizeObserver(entries => entries.forEach(({target}) => fit(target)));

// A line over the curves at the frame that is shown.
export function cursorOver(plot, place) {
  const cursor = make("div", {className: "cursor"});
  plot.append(cursor);
  const move = () => {
    const layout = plot._fullLayout, x = place();
    if (!layout?.xaxis || !Number.isFinite(x)) { cursor.hidden = true; return; }
    const left = layout.xaxis.l2p(x);
    cursor.hidden = left < 0 || left > layout.xaxis._length;
    cursor.style.left = `${layout.xaxis._offset + left}px`;
    cursor.style.top = `${layout._size.t}px`;
    cursor.style.height = `${layout._size.h}px`;
  };
  plot.on("plotly_afterplot", move);
  on(["shown"], move);
  move();
}

async function drawTrack({track, summary, plots}) {
  const plot = id("curves");
  plot.hidden = !track?.has("cx_px") || !plots;
  if (plot.hidden) return;
  const Plotly = await plotly();
  const {names, list} = traces(track);
  const layout = {
    margin: {l: 58, r: 8, t: 28, b: 40}, grid: {rows: 3, columns: 1, subplots: [["xy"], ["xy2"], ["xy3"]], ygap: 0.12},
    xaxis: {...axis(abscissa(track).name), anchor: "y3"}, yaxis: axis(names[0]), yaxis2: axis(names[1]), yaxis3: axis(names[2]),
    shapes: phases(track, summary), hovermode: "closest", showlegend: true, uirevision: "same",
    legend: LEGEND, font: {size: 11}, dragmode: "zoom",
  };
  const first = !plot._fullLayout;
  await Plotly.react(plot, list, layout, CONFIG);
  fit(plot);
  if (first) {
    watched.observe(plot);
    plot.on("plotly_click", event => player.show(event.points[0].customdata[0]));
    cursorOver(plot, () => {
      const now = get("track"), row = now?.row(get("shown")) ?? -1;
      return row < 0 ? NaN : abscissa(now).at[row];
    });
  }
}

async function drawHistory({history, plots}) {
  const plot = id("history");
  plot.hidden = id("history-name").hidden = !history || !plots;
  if (plot.hidden) return;
  const Plotly = await plotly();
  id("history-name").textContent = `Window ${history.window}`;
  const curve = (of, name, color, yaxis) => ({x: history.frames, y: history.rows.map(of), name, yaxis, mode: "lines",
    line: {color, width: 1.5}});
  await Plotly.react(plot, [curve(f => f.u_px, "u", BLUE, "y"), curve(f => f.v_px, "v", ORANGE, "y"),
                            curve(f => f.correlation, "ZNCC", BLACK, "y2")],
    {margin: {l: 58, r: 50, t: 28, b: 40}, xaxis: axis("frame"), yaxis: axis("displacement, px"),
     yaxis2: {...axis("ZNCC"), overlaying: "y", side: "right", showgrid: false, range: [0, 1.02]},
     legend: {...LEGEND, y: -0.28}, font: {size: 11}}, CONFIG);
}

const failed = error => { id("plots-failed").textContent = error.message; };

export function build() {
  on(["track", "summary", "plots"], values => drawTrack(values).catch(failed));
  on(["history"], values => drawHistory(values).catch(failed));
  return [make("div", {className: "plot", id: "curves", hidden: true}),
          make("h2", {id: "history-name", hidden: true}), make("div", {className: "plot small", id: "history", hidden: true}),
          make("p", {className: "soft", id: "plots-failed"})];
}
