// What happened in a shot, in a sentence.
import {withDeviation} from "./table.js";

const RPM = 60 / (2 * Math.PI);

const figure = f => (f && f.value !== null && f.value !== undefined
  ? withDeviation(String(f.value), f.sd === null || f.sd === undefined ? "" : String(f.sd))
    + (f.status === "doubtful" ? " (doubtful)" : "") : "");
const speed = side => {
  const vt = side?.vt_m_s?.value, vn = side?.vn_m_s?.value;
  return Number.isFinite(vt) && Number.isFinite(vn) ? Math.hypot(vt, vn).toFixed(2) : null;
};
const spin = side => {
  const omega = side?.omega_rad_s?.value;
  return Number.isFinite(omega) ? `${(omega * RPM + 0).toFixed(0)}`.replace("-0", "0") : null;
};

// "in 3.97 m/s → out 3.26 m/s, spin 0 → 302 rpm, e 0.865 ± 0.001, contact 6.3 ms"; "" without results.
export function sentence(summary) {
  const impact = summary?.impact;
  if (!impact) return "";
  if (!impact.found) return impact.explanation || "no impact in these frames";
  const parts = [], fast = [speed(impact.before), speed(impact.after)];
  const turns = [spin(impact.before), spin(impact.after)];
  if (fast.every(v => v !== null)) parts.push(`in ${fast[0]} m/s → out ${fast[1]} m/s`);
  if (turns.every(v => v !== null)) parts.push(`spin ${turns[0]} → ${turns[1]} rpm`);
  if (figure(impact.restitution)) parts.push(`e ${figure(impact.restitution)}`);
  const contact = impact.contact_s?.value;
  if (Number.isFinite(contact)) parts.push(`contact ${(1e3 * contact).toPrecision(3)} ms`);
  return parts.join(", ") || impact.status;
}
