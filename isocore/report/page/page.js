"use strict";
// Draws the page out of the report inside it. Texts are set as text, never as markup.
const report = JSON.parse(document.getElementById("report").textContent);
const runs = report.outputs;
const at = (selector) => document.querySelector(selector);
const dig = (run, path) => path.split(".").reduce((part, key) => (part == null ? part : part[key]), run);
const isNumber = (value) => typeof value === "number";
const whole = (value) => (isNumber(value) ? value.toLocaleString("en") : "");
const short = (digits) => (value) => (isNumber(value) ? value.toFixed(digits) : "");
const rounded = (digits) => (value) => (isNumber(value) ? String(Number(value.toPrecision(digits))) : value ?? "");
const plain = rounded(9);
const precise = rounded(15); // of samples and isovalues, which may differ in their last digits only
// As few digits as tell these numbers apart, but six where there are as many.
function apart(numbers) {
  const kinds = (digits) => new Set(numbers.map(rounded(digits))).size;
  let digits = 6;
  while (digits < 15 && kinds(digits) < kinds(15)) ++digits;
  return rounded(digits);
}
const fileName = (path) => path.split(/[\\/]/).pop();
const isEmpty = (run) => run.surface?.triangles === 0;
const closed = (run) =>
  run.surface == null ? "" : isEmpty(run) || run.surface.watertight == null ? "-" : run.surface.watertight ? "yes" : "no";
const ownSeconds = (run) => (run.surface ? run.seconds.own : null);

function make(tag, text = "", name = "") {
  const element = document.createElement(tag);
  element.textContent = text;
  element.className = name;
  return element;
}

// Breaks where a name has parts.
function breakable(cell) {
  const parts = cell.textContent.split(/(?<=[-_.])/);
  cell.replaceChildren(...parts.flatMap((part) => [document.createElement("wbr"), part]));
}

const allColumns = [
  { title: "file", value: (run) => fileName(run.output === "-" ? run.source : run.output), show: String },
  { title: "status", value: (run) => (run.missed.length ? run.status + ", missed" : run.status), show: String },
  { title: "isovalue", value: (run) => run.isovalue, show: apart(runs.map((run) => run.isovalue).filter(isNumber)), number: true },
  { title: "triangles", value: (run) => dig(run, "surface.triangles"), show: whole, number: true },
  { title: "reference", value: (run) => dig(run, "reference.triangles"), show: whole, number: true },
  { title: "ratio", value: (run) => dig(run, "ratio.triangles"), show: short(2), number: true },
  { title: "seconds", value: (run) => run.seconds.total, show: short(3), number: true },
  { title: "own s", value: ownSeconds, show: short(3), number: true },
  { title: "ref. s", value: (run) => dig(run, "reference.seconds"), show: short(3), number: true },
  { title: "closed", value: closed, show: String },
];

// A column in which nothing stands is left out.
const columns = allColumns.filter((column) => runs.length === 0 || runs.some((run) => column.show(column.value(run) ?? "") !== ""));

function summarise() {
  const totals = report.totals;
  const parts = ["done", "empty", "skipped", "failed"].filter((key) => totals[key]).map((key) => `${totals[key]} ${key}`);
  if (totals.missed) parts.push(`${totals.missed} missed a requirement`);
  at("#totals").textContent =
    `${parts.join(", ") || "nothing done"} — ${whole(totals.triangles)} triangles in ${totals.seconds.toFixed(2)} s`;
  const { tool, host } = report;
  const known = (...texts) => texts.filter((text) => text != null).join(" ");
  at("#made").textContent = [
    known(tool.name, tool.version, tool.kernels && `(${tool.kernels}),`),
    known(host.system, host.machine && `${host.machine},`, host.cpus, host.cpus && "processors"),
    `— isocore ${report.arguments.join(" ")}`,
  ].join(" ");
  const list = at("#attention ul");
  const tell = (run, text, name) => {
    const item = make("li", text, name);
    item.onclick = () => pick(run);
    list.append(item);
  };
  for (const run of runs) if (run.status === "failed") tell(run, run.message, "bad");
  for (const run of runs) for (const miss of run.missed) tell(run, `${run.output}: misses ${miss}`, "bad");
  for (const run of runs) if (run.status === "empty") tell(run, `${run.source}: ${run.message}`, "warn");
  for (const run of runs) for (const warning of run.warnings) tell(run, `${run.source}: ${warning}`, "warn");
  at("#attention").hidden = !list.children.length;
}

const rows = new Map();
const boxes = new Map();

function tickbox(title, act) {
  const box = document.createElement("input");
  box.type = "checkbox";
  box.title = title;
  box.setAttribute("aria-label", title);
  box.onclick = (event) => {
    event.stopPropagation();
    act();
  };
  return box;
}

function fillTable() {
  const all = make("th", "", "tick");
  all.append(tickbox("show every surface of the table", () => (runs.some((run) => run.mesh && !rows.get(run).hidden && !shown.has(run))
    ? show(runs.filter((run) => run.mesh && !rows.get(run).hidden)) : show([picked]))));
  at("thead tr").append(all);
  for (const [index, column] of columns.entries()) {
    const head = make("th", "", column.number ? "number" : "");
    const button = make("button", column.title);
    button.onclick = () => sortBy(index, head);
    head.append(button);
    at("thead tr").append(head);
  }
  for (const run of runs) {
    const row = make("tr");
    const tick = make("td", "", "tick");
    if (run.mesh) {
      const box = tickbox("show this surface with the others", () => show(box.checked ? [...shown, run] : [...shown].filter((other) => other !== run)));
      tick.append(box);
      boxes.set(run, box);
    }
    row.append(tick);
    for (const column of columns) {
      const cell = make("td", column.show(column.value(run)), column.number ? "number" : "");
      if (column.title === "status") {
        cell.classList.add(run.status === "failed" || run.missed.length ? "bad" : isEmpty(run) || run.warnings.length ? "warn" : "good");
      }
      if (column.title === "file") {
        cell.classList.add("file");
        breakable(cell);
      }
      row.append(cell);
    }
    row.tabIndex = 0;
    row.onclick = () => pick(run);
    row.onkeydown = (event) => event.key === "Enter" && pick(run);
    rows.set(run, row);
  }
  at("tbody").append(...rows.values());
}

function sortBy(index, head) {
  const descending = head.getAttribute("aria-sort") === "ascending";
  for (const other of document.querySelectorAll("th")) other.removeAttribute("aria-sort");
  head.setAttribute("aria-sort", descending ? "descending" : "ascending");
  const { value } = columns[index];
  const compare = (a, b) => {
    if (a == null || b == null) return (a == null) - (b == null); // what is unknown stays at the end
    const order = isNumber(a) ? a - b : String(a).localeCompare(String(b), "en", { numeric: true });
    return descending ? -order : order;
  };
  const order = [...runs].sort((a, b) => compare(value(a), value(b)));
  at("tbody").append(...order.map((run) => rows.get(run)));
}

at("#filter").oninput = (event) => {
  const wanted = event.target.value.toLowerCase();
  for (const [run, row] of rows) {
    row.hidden = !`${run.source} ${run.output} ${run.status} ${run.missed.join(" ")}`.toLowerCase().includes(wanted);
  }
};

