// What speaks for a result and what against it, in marks and words beside their colours.
import {make} from "./dom.js";
import {on} from "./store.js";

const ENOUGH = 0.9;  // share of the windows that is usable
const MARKS = {good: "✓", bad: "!", open: "–"};

// [name, state, why]
function judged(summary) {
  const list = [], {impact, advice} = summary;
  const closure = impact?.impulse_closure;
  if (impact?.found && closure) {
    const state = {closes: "good", undetermined: "open"}[closure.verdict] ?? "bad";
    list.push(["closure", state, closure.explanation ?? ""]);
  }
  if (impact?.found && impact.gravity) {
    const agrees = impact.gravity.agrees_with_9_81, found = impact.gravity.measured_m_s2?.value;
    const why = Number.isFinite(found) ? `${found.toPrecision(3)} m/s² measured` : "not measured";
    list.push(["gravity", agrees === true ? "good" : agrees === false ? "bad" : "open", why]);
  }
  const windows = advice?.windows;
  if (windows?.windows > 0) {
    const share = windows.usable / windows.windows;
    list.push(["texture", share >= ENOUGH ? "good" : "bad", `${Math.round(100 * share)} % of the windows are usable`]);
  }
  list.push(["scale", summary.scale_m_per_px ? "good" : "open", summary.scale?.from ? `from ${summary.scale.from}` : "no scale is given"]);
  return list;
}

export function build() {
  const list = make("ul", {id: "lights", ariaLabel: "Checks"});
  on(["summary"], ({summary}) => {
    list.hidden = !summary;
    list.replaceChildren(...(summary ? judged(summary) : []).map(([name, state, why]) =>
      make("li", {className: state, title: why}, make("b", {textContent: MARKS[state]}), name,
        ...(state === "bad" && why ? [make("span", {className: "soft", textContent: `: ${why}`})] : []))));
  });
  return list;
}
