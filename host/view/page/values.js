// The figures of the frame that is shown, as track.csv has them.
import {make} from "./dom.js";
import {on} from "./store.js";
import {withDeviation} from "./table.js";

// Name on the page, column, column of its deviation.
const ROWS = [
  ["x, px", "cx_px", "cx_sd_px"], ["y, px", "cy_px", "cy_sd_px"],
  ["radius, px", "r_px", "r_sd_px"], ["dx, px", "dx_px", "dx_sd_px"], ["dy, px", "dy_px", "dy_sd_px"],
  ["turn, °", "rot_deg", "rot_sd_deg"], ["turn X, °", "rot_x_deg", "rot_x_sd_deg"],
  ["turn Y, °", "rot_y_deg", "rot_y_sd_deg"], ["vx, m/s", "vx_m_s", "vx_sd_m_s"],
  ["vy, m/s", "vy_m_s", "vy_sd_m_s"], ["along, m/s", "vt_m_s"], ["out, m/s", "vn_m_s"],
  ["spin, rad/s", "omega_rad_s", "omega_sd_rad_s"], ["spin t, rad/s", "omega_t_rad_s", "omega_t_sd_rad_s"],
  ["spin n, rad/s", "omega_n_rad_s", "omega_n_sd_rad_s"],
  ["vz, m/s", "vz_m_s", "vz_sd_m_s"], ["windows", "windows"],
  ["ellipse e1, px", "e1_px", "e1_sd_px"], ["ellipse e2, px", "e2_px", "e2_sd_px"], ["by hand", "by_hand"],
  ["rim beside it x, px", "rim_off_x_px"], ["rim beside it y, px", "rim_off_y_px"],
];
const BY_HAND = ["no", "measured from the circle given", "the circle given", "said to show no ball"];
const EMPTY = {by_hand: "0"};  // what stands where there is nothing to say; else ""

export function build() {
  const list = make("dl", {className: "values", id: "values"});
  on(["shown", "track"], ({shown, track}) => {
    list.hidden = !track;
    if (!track) return;
    const row = track.row(shown);
    list.dataset.frame = shown;
    const shownRows = [["status", "status"], ...ROWS.filter(([, column]) =>
      track.has(column) && track.rows.some((_, k) => track.cell(k, column) !== (EMPTY[column] ?? "")))];
    list.replaceChildren(...shownRows.map(([name, column, sd]) => {
      const cell = track.cell(row, column);
      const text = column === "status" ? (row < 0 ? "not measured" : cell)
                 : column === "by_hand" ? BY_HAND[cell] ?? "—" : withDeviation(cell, sd && track.cell(row, sd));
      const value = make("dd", {title: cell, textContent: text});
      value.dataset.column = column;
      value.dataset.cell = cell;
      return make("div", {}, make("dt", {textContent: name}), value);
    }));
  });
  return list;
}
