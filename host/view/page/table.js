// Tables of results. Cells stay as the file has them, so that what is shown is what it says.

export class Table {
  constructor(csv) {
    const lines = csv.split("\n").filter(line => line);
    this.names = (lines.shift() || "").split(",");
    this.rows = lines.map(line => line.split(",")).filter(row => row.length === this.names.length);
    this.byFrame = new Map(this.rows.map((row, k) => [Number(row[0]), k]));
    this.columns = new Map();
  }
  has(name) { return this.names.includes(name); }
  // "" where nothing was measured.
  cell(row, name) { return this.rows[row]?.[this.names.indexOf(name)] ?? ""; }
  // NaN where nothing was measured.
  number(row, name) { const cell = this.cell(row, name); return cell === "" ? NaN : Number(cell); }
  numbers(name) {
    if (!this.columns.has(name)) this.columns.set(name, this.rows.map((_, k) => this.number(k, name)));
    return this.columns.get(name);
  }
  row(frame) { return this.byFrame.get(frame) ?? -1; }
}

// A value with its deviation, to two digits of the deviation; without one to five digits.
export function withDeviation(cell, deviation) {
  if (cell === "") return "—";
  const value = Number(cell), sd = Number(deviation);
  if (deviation === "" || deviation === undefined || !(sd > 0)) {
    return Number.isInteger(value) ? String(value) : String(Number(value.toPrecision(6)));
  }
  const digits = Math.min(12, Math.max(0, 1 - Math.floor(Math.log10(sd))));
  return `${value.toFixed(digits)} ± ${sd.toFixed(digits)}`;
}
