// What the modules share: values by name, and who wants to know when one changes. Listeners are
// called once before the next picture of the screen, whatever has changed until then.

const values = {};
const listeners = [];
let changed = new Set();

function tell() {
  const now = changed;
  changed = new Set();
  for (const [names, listener] of listeners) {
    if (names.some(name => now.has(name))) listener(values);
  }
}

export function on(names, listener) {
  listeners.push([names, listener]);
}

export function set(changes) {
  if (!changed.size) requestAnimationFrame(tell);
  for (const [name, value] of Object.entries(changes)) {
    values[name] = value;
    changed.add(name);
  }
}

export const get = name => values[name];
