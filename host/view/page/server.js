// Requests to the program. Addresses are relative: the page's own holds the token.

async function checked(answer) {
  if (answer.ok) return answer;
  let line = `${answer.status}`;
  try { line = (await answer.json()).error; } catch { /* no JSON: the status must do */ }
  throw Object.assign(new Error(line), {status: answer.status});
}

const at = (name, query) => `api/${name}?${new URLSearchParams(query)}`;

export const json = async (name, query = {}) => (await checked(await fetch(at(name, query)))).json();
export const text = async (name, query = {}) => (await checked(await fetch(at(name, query)))).text();
export const bytes = async (name, query = {}, signal = undefined) =>
  (await checked(await fetch(at(name, query), {signal}))).arrayBuffer();
export const post = async (name, body, signal = undefined) =>
  (await checked(await fetch(`api/${name}`, {method: "POST", body: JSON.stringify(body), signal}))).json();
