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

const columns = [
  { title: "file", value: (run) => fileName(run.output === "-" ? run.source : run.output), show: String },
  { title: "status", value: (run) => (run.missed.length ? run.status + ", missed" : run.status), show: String },
  { title: "isovalue", value: (run) => run.isovalue, show: precise, number: true },
  { title: "triangles", value: (run) => dig(run, "surface.triangles"), show: whole, number: true },
  { title: "reference", value: (run) => dig(run, "reference.triangles"), show: whole, number: true },
  { title: "ratio", value: (run) => dig(run, "ratio.triangles"), show: short(2), number: true },
  { title: "seconds", value: (run) => run.seconds.total, show: short(3), number: true },
  { title: "own s", value: ownSeconds, show: short(3), number: true },
  { title: "ref. s", value: (run) => dig(run, "reference.seconds"), show: short(3), number: true },
  { title: "closed", value: closed, show: String },
];

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

function fillTable() {
  for (const [index, column] of columns.entries()) {
    const head = make("th", "", column.number ? "number" : "");
    const button = make("button", column.title);
    button.onclick = () => sortBy(index, head);
    head.append(button);
    at("thead tr").append(head);
  }
  for (const run of runs) {
    const row = make("tr");
    for (const column of columns) {
      const cell = make("td", column.show(column.value(run)), column.number ? "number" : "");
      if (column.title === "status") {
        cell.classList.add(run.status === "failed" || run.missed.length ? "bad" : isEmpty(run) || run.warnings.length ? "warn" : "good");
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

function drawBars(run) {
  const place = at("#bars");
  place.replaceChildren();
  const pairs = [
    ["triangles", dig(run, "surface.triangles"), dig(run, "reference.triangles"), whole],
    ["own s", ownSeconds(run), dig(run, "reference.seconds"), short(3)],
  ];
  for (const [title, ours, reference, show] of pairs) {
    const top = Math.max(ours ?? 0, reference ?? 0);
    if (!top) continue;
    const names = [[`${title}`, ours, "ours"], [`${dig(run, "reference.name") ?? "reference"}`, reference, ""]];
    for (const [name, value, kind] of names) {
      if (value == null) continue;
      const line = make("div", "", "bar");
      const bar = make("i", "", kind);
      bar.style.width = `${(100 * value) / top}%`;
      const track = make("div");
      track.append(bar);
      line.append(make("span", name, "quiet"), track, make("b", show(value)));
      place.append(line);
    }
  }
  if (!place.children.length) place.append(make("p", "No reference was run.", "quiet"));
}

function drawHistogram(run) {
  const place = at("#histogram");
  place.replaceChildren();
  const spread = run.histogram;
  if (!spread?.counts?.length) {
    place.append(make("p", "No samples were counted.", "quiet"));
    return;
  }
  const [width, height, foot] = [480, 110, 16];
  const svg = (tag, attributes, text = "") => {
    const element = document.createElementNS("http://www.w3.org/2000/svg", tag);
    for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
    element.textContent = text;
    return element;
  };
  const picture = svg("svg", { viewBox: `0 0 ${width} ${height + foot}`, role: "img" });
  picture.append(svg("title", {}, "Histogram of the samples, logarithmic, with the isovalue"));
  const step = width / spread.counts.length;
  const top = Math.log1p(spread.counts.reduce((a, b) => Math.max(a, b), 1));
  spread.counts.forEach((count, bin) => {
    const tall = (Math.log1p(count) / top) * height;
    picture.append(svg("rect", { x: bin * step, y: height - tall, width: Math.max(step - 0.5, 0.5), height: tall }));
  });
  const x = ((run.isovalue - spread.low) / (spread.high - spread.low)) * width;
  if (isNumber(run.isovalue) && x >= 0 && x <= width) picture.append(svg("line", { x1: x, x2: x, y1: 0, y2: height }));
  picture.append(svg("text", { x: 0, y: height + 13 }, precise(spread.low)));
  picture.append(svg("text", { x: width, y: height + 13, "text-anchor": "end" }, precise(spread.high)));
  place.append(picture);
  if (isNumber(run.isovalue)) place.append(make("p", `isovalue ${precise(run.isovalue)}: ${run.chosen}`, "quiet"));
}

function listFacts(run) {
  const list = at("#facts");
  list.replaceChildren();
  const add = (key, value) => {
    const show = key === "isovalue" || key === "range" ? precise : plain;
    if (value == null || value === "" || key.startsWith("histogram") || key === "mesh") return;
    if (Array.isArray(value)) {
      if (value.length) list.append(make("dt", key), make("dd", value.flat(3).map(show).join(", ")));
    } else if (typeof value === "object") {
      for (const [inner, part] of Object.entries(value)) add(`${key}.${inner}`, part);
    } else {
      list.append(make("dt", key), make("dd", isNumber(value) ? show(value) : String(value)));
    }
  };
  for (const [key, value] of Object.entries(run)) add(key, value);
}

const viewer = { ready: false };

function decode(text, type) {
  const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  return new type(bytes.buffer);
}

function startViewer() {
  const canvas = at("#view canvas");
  viewer.renderer = new THREE.WebGLRenderer({ canvas, antialias: true, alpha: true, preserveDrawingBuffer: true });
  viewer.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
  viewer.scene = new THREE.Scene();
  viewer.camera = new THREE.PerspectiveCamera(35, 1, 0.01, 100);
  viewer.scene.add(new THREE.AmbientLight(0xffffff, 1.1));
  viewer.lamp = new THREE.DirectionalLight(0xffffff, 2.2);
  viewer.scene.add(viewer.lamp);
  const material = new THREE.MeshStandardMaterial({ color: 0x6b9fd4, roughness: 0.65, side: THREE.DoubleSide });
  viewer.mesh = new THREE.Mesh(new THREE.BufferGeometry(), material);
  viewer.scene.add(viewer.mesh);
  viewer.controls = new THREE.OrbitControls(viewer.camera, canvas);
  viewer.controls.addEventListener("change", render);
  new ResizeObserver(render).observe(at("#view"));
  viewer.ready = true;
}

function render() {
  const { clientWidth: width, clientHeight: height } = at("#view");
  viewer.renderer.setSize(width, height, false);
  viewer.camera.aspect = width / height;
  viewer.camera.updateProjectionMatrix();
  viewer.lamp.position.copy(viewer.camera.position);
  viewer.renderer.render(viewer.scene, viewer.camera);
}

function show(run) {
  const note = at("#view p");
  at("#view").hidden = false;
  if (!run.mesh) {
    note.textContent = run.status === "failed" ? "no surface" : "no copy of this surface in the page";
    if (viewer.ready) {
      viewer.mesh.visible = false;
      render();
    }
    return;
  }
  try {
    if (!viewer.ready) startViewer();
  } catch (error) {
    note.textContent = "this browser cannot draw in 3-D";
    return;
  }
  const { low, high } = run.mesh;
  const steps = decode(run.mesh.vertices, Uint16Array);
  const size = Math.max(...high.map((value, axis) => value - low[axis])) || 1;
  const points = new Float32Array(steps.length);
  for (let i = 0; i < steps.length; ++i) {
    const axis = i % 3;
    points[i] = ((steps[i] / 65535 - 0.5) * (high[axis] - low[axis])) / size;
  }
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.BufferAttribute(points, 3));
  geometry.setIndex(new THREE.BufferAttribute(decode(run.mesh.triangles, Uint16Array), 1));
  geometry.computeVertexNormals();
  viewer.mesh.geometry.dispose();
  viewer.mesh.geometry = geometry;
  viewer.mesh.visible = true;
  viewer.camera.up.set(0, 0, 1);
  viewer.camera.position.set(1.05, -1.55, 0.75);
  viewer.controls.target.set(0, 0, 0);
  viewer.controls.update();
  const shown = steps.length && decode(run.mesh.triangles, Uint16Array).length / 3;
  note.textContent = `${whole(shown)} of ${whole(dig(run, "surface.triangles"))} triangles shown; drag to turn`;
  render();
}

function pick(run) {
  for (const [other, row] of rows) row.setAttribute("aria-selected", other === run);
  at("#name").textContent = `${fileName(run.source)} → ${fileName(run.output)}`;
  at("#message").textContent = [run.message, ...run.missed.map((miss) => `misses ${miss}`), ...run.warnings].join(" · ");
  at("#message").className = run.status === "failed" || run.missed.length ? "bad" : "warn";
  show(run);
  drawBars(run);
  drawHistogram(run);
  listFacts(run);
}

summarise();
fillTable();
if (runs.length) pick(runs.find((run) => run.mesh) ?? runs[0]);
else at("#detail").hidden = true;
