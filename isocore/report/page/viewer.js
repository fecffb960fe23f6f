// The surfaces in three dimensions: one, or several together, each from its copy in the report.
const FIRST = "#6b9fd4";
const PALETTE = ["#6b9fd4", "#e0a458", "#6fb98f", "#d4737a", "#a58bd6", "#58bcc4", "#c9b458", "#cf86b8", "#8f9d6a", "#b0846a"];
const viewer = { ready: false, meshes: new Map(), side: null, box: null };
let shown = new Set();

function decode(text, type) {
  const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  return new type(bytes.buffer);
}

// Letters of the sides that a surface can be looked at from, and the directions to them; S or +z is up.
function sidesOf(run) {
  const named = { ras: ["R", "A"], lps: ["L", "P"], las: ["L", "A"] }[run.space];
  const [x, y] = named ?? ["+x", "+y"];
  const other = { R: "L", L: "R", A: "P", P: "A", "+x": "−x", "+y": "−y" };
  const [up, down] = named ? ["S", "I"] : ["+z", "−z"];
  const all = { [x]: [1, 0, 0], [other[x]]: [-1, 0, 0], [y]: [0, 1, 0], [other[y]]: [0, -1, 0], [up]: [0, 0, 1], [down]: [0, 0, -1] };
  const order = named ? ["A", "P", "L", "R", "S", "I"] : ["−y", "+y", "−x", "+x", "+z", "−z"];
  return { all, order, ahead: all[named ? "A" : "+y"] };
}
const WORDS = { A: "the front (anterior)", P: "the back (posterior)", L: "the left", R: "the right", S: "the head (superior)", I: "the feet (inferior)" };

function startViewer() {
  const canvas = at("#view canvas");
  viewer.renderer = new THREE.WebGLRenderer({ canvas, antialias: true, alpha: true, preserveDrawingBuffer: true });
  viewer.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
  viewer.scene = new THREE.Scene();
  viewer.camera = new THREE.PerspectiveCamera(30, 1, 0.01, 100);
  viewer.camera.up.set(0, 0, 1);
  viewer.scene.add(new THREE.AmbientLight(0xffffff, 0.55));
  // From above on the left, and fainter from the right: placed anew for every way of looking.
  viewer.lamps = [[-1, 1.3, 1.2, 2.3], [1.5, 0.1, 0.8, 0.8]].map(([x, y, z, strength]) => {
    const lamp = new THREE.DirectionalLight(0xffffff, strength);
    viewer.scene.add(lamp);
    return [lamp, [x, y, z]];
  });
  viewer.controls = new THREE.OrbitControls(viewer.camera, canvas);
  viewer.controls.addEventListener("change", render);
  viewer.controls.addEventListener("start", () => pressSide(null));
  new ResizeObserver(render).observe(at("#view"));
  viewer.ready = true;
}

function render() {
  const { clientWidth: width, clientHeight: height } = at("#view");
  if (!width || !height) return;
  viewer.renderer.setSize(width, height, false);
  viewer.camera.aspect = width / height;
  viewer.camera.updateProjectionMatrix();
  for (const [lamp, place] of viewer.lamps) {
    lamp.position.set(...place).applyQuaternion(viewer.camera.quaternion);
  }
  viewer.renderer.render(viewer.scene, viewer.camera);
}

// A surface about its own middle, its longest side 1; the scene moves and scales it.
function meshOf(run) {
  if (viewer.meshes.has(run)) return viewer.meshes.get(run);
  const { low, high } = run.mesh;
  const steps = decode(run.mesh.vertices, Uint16Array);
  const size = Math.max(...high.map((value, axis) => value - low[axis])) || 1;
  const points = new Float32Array(steps.length);
  for (let i = 0; i < steps.length; ++i) points[i] = ((steps[i] / 65535 - 0.5) * (high[i % 3] - low[i % 3])) / size;
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.BufferAttribute(points, 3));
  geometry.setIndex(new THREE.BufferAttribute(decode(run.mesh.triangles, steps.length < 3 * 65536 ? Uint16Array : Uint32Array), 1));
  if (run.mesh.normals) geometry.setAttribute("normal", new THREE.BufferAttribute(decode(run.mesh.normals, Int8Array), 3, true));
  else geometry.computeVertexNormals();
  const colors = colorsOf(run);
  if (colors) geometry.setAttribute("color", new THREE.BufferAttribute(colors, 3));
  const surface = new THREE.Mesh(geometry, new THREE.MeshStandardMaterial({
    vertexColors: colors !== null, roughness: 0.7, side: THREE.DoubleSide, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1,
  }));
  const wires = new THREE.Mesh(geometry, new THREE.MeshStandardMaterial({ color: 0x10161d, roughness: 1, wireframe: true, transparent: true, opacity: 0.55 }));
  const made = { surface, wires, size };
  viewer.meshes.set(run, made);
  viewer.scene.add(surface, wires);
  return made;
}

const tables = new Map(Object.entries(report.colormaps ?? {}).map(([name, text]) => [name, decode(text, Uint8Array)]));
const isColoured = (run) => Boolean(run.mesh?.values && run.colors && tables.has(run.colors.colormap));

// A colour for each vertex by what the surface carries, as light adds up; grey for what is no number. Null: one for all.
function colorsOf(run) {
  if (!isColoured(run)) return null;
  const steps = decode(run.mesh.values, Uint16Array), table = tables.get(run.colors.colormap);
  const [first, last] = run.mesh.value_range, [low, high] = run.colors.range ?? [0, 0];
  const linear = Float32Array.from(table, (value) => (value <= 10 ? value / 255 / 12.92 : ((value / 255 + 0.055) / 1.055) ** 2.4));
  const colors = new Float32Array(3 * steps.length).fill(0.216);
  for (let i = 0; i < steps.length; ++i) {
    if (steps[i] === 65535) continue;
    const value = first + (steps[i] / 65534) * (last - first);
    const place = high > low ? Math.min(255, Math.max(0, Math.floor((256 * (value - low)) / (high - low)))) : 128;
    for (let n = 0; n < 3; ++n) colors[3 * i + n] = linear[3 * place + n];
  }
  return colors;
}

// What the colours stand for: the map from its low end to its high one.
function scaleOf({ by, colormap, range }) {
  const item = make("li", "", "scale");
  const table = tables.get(colormap), mark = make("i");
  const stops = [...Array(16).keys()].map((n) => `rgb(${table.slice(51 * n, 51 * n + 3).join(" ")})`);
  mark.style.background = `linear-gradient(to right, ${stops.join(", ")})`;
  item.append(`${by} `, digits(range[0]), mark, digits(range[1]));
  return item;
}

function colourOf(run, number, count) {
  if (isColoured(run)) return "#ffffff";
  return run.mesh.colour ?? dig(run, "label.color") ?? (count > 1 ? PALETTE[number % PALETTE.length] : FIRST);
}

// Show these surfaces, and no others; the camera keeps its side and takes the distance that holds all of them.
function show(wanted) {
  const drawable = [...new Set(wanted)].filter((run) => run?.mesh);
  shown = new Set(drawable);
  for (const [run, box] of boxes) box.checked = shown.has(run);
  const note = at("#note");
  at("#controls").hidden = !drawable.length;
  try {
    if (!viewer.ready && drawable.length) startViewer();
  } catch (error) {
    note.textContent = "this browser cannot draw in 3-D";
    return;
  }
  for (const { surface, wires } of viewer.meshes.values()) surface.visible = wires.visible = false;
  const low = [0, 1, 2].map((axis) => Math.min(...drawable.map((run) => run.mesh.low[axis])));
  const high = [0, 1, 2].map((axis) => Math.max(...drawable.map((run) => run.mesh.high[axis])));
  const whole_ = Math.max(...high.map((value, axis) => value - low[axis])) || 1;
  for (const run of drawable) {
    const { surface, wires, size } = meshOf(run);
    for (const part of [surface, wires]) {
      part.scale.setScalar(size / whole_);
      part.position.set(...[0, 1, 2].map((axis) => ((run.mesh.low[axis] + run.mesh.high[axis]) / 2 - (low[axis] + high[axis]) / 2) / whole_));
    }
  }
  viewer.box = drawable.length ? high.map((value, axis) => (value - low[axis]) / whole_) : null;
  listShown(drawable);
  dress();
  if (drawable.length) lookFrom(viewer.side);
  else if (viewer.ready) render();
}

// Colours, opacity and wires, as the controls say.
function dress() {
  const opacity = at("#opacity").value / 100;
  [...shown].forEach((run, number) => {
    const { surface, wires } = meshOf(run);
    surface.visible = true;
    wires.visible = at("#wires").checked;
    surface.material.color.set(colourOf(run, number, shown.size));
    surface.material.opacity = opacity;
    surface.material.transparent = opacity < 1;
    surface.material.depthWrite = opacity === 1;
    surface.material.needsUpdate = true;
  });
  if (viewer.ready) render();
}

function listShown(drawable) {
  const legend = at("#legend");
  legend.replaceChildren();
  const scales = new Map(drawable.filter((run) => isColoured(run) && run.colors.range).map((run) => [JSON.stringify(run.colors), run.colors]));
  legend.append(...[...scales.values()].map(scaleOf));
  if (drawable.length > 1) {
    drawable.forEach((run, number) => {
      const item = make("li");
      const mark = make("i");
      mark.style.background = colourOf(run, number, drawable.length);
      item.append(mark, dig(run, "label.name") || fileName(run.output));
      legend.append(item);
    });
  }
  const drawn = drawable.reduce((sum, run) => sum + run.mesh.count, 0);
  const there = drawable.reduce((sum, run) => sum + (dig(run, "surface.triangles") ?? 0), 0);
  at("#note").textContent = !drawable.length
    ? picked?.status === "failed" ? "no surface" : isEmpty(picked ?? {}) ? "an empty surface" : "no copy of this surface in the page"
    : drawn === there ? `${whole(there)} triangles; drag to turn` : `a copy of ${whole(drawn)} triangles, of ${whole(there)}; drag to turn`;
}

// The camera goes to this side, or stays on its own; either way it sees all that is shown.
function lookFrom(side) {
  const { all, order, ahead } = sidesOf([...shown][0]);
  const { camera, controls } = viewer;
  if (side && !all[side]) side = null;
  if (!viewer.placed && !side) side = order[0];
  const half = (camera.fov / 2) * (Math.PI / 180);
  camera.aspect = at("#view").clientWidth / (at("#view").clientHeight || 1);
  const narrow = Math.min(half, Math.atan(Math.tan(half) * camera.aspect));
  let distance = Math.hypot(...viewer.box) / 2 / Math.sin(narrow);
  if (side) {
    const way = all[side];
    const axis = way.findIndex((value) => value); // the sides of the box across and upright, in front of half its depth
    const [across, upright] = [axis === 0 ? 1 : 0, axis === 2 ? 1 : 2].map((other) => viewer.box[other] / 2);
    const tall = Math.tan(half);
    distance = viewer.box[axis] / 2 + 1.1 * Math.max(upright / tall, across / (tall * camera.aspect));
    const pole = way[2]; // just beside it, so that the front is up
    camera.position.set(...way.map((value, axis) => distance * (value - pole * 1e-4 * ahead[axis])));
  } else camera.position.setLength(distance);
  controls.target.set(0, 0, 0);
  controls.update();
  viewer.placed = true;
  pressSide(side);
  render();
}

function pressSide(side) {
  viewer.side = side;
  for (const button of document.querySelectorAll("#sides button")) button.setAttribute("aria-pressed", button.textContent === side);
}

function offerSides(run) {
  const { order } = sidesOf(run);
  at("#sides").replaceChildren(...order.map((side) => {
    const button = make("button", side);
    button.title = `look from ${WORDS[side] ?? side}`;
    button.onclick = () => lookFrom(side);
    return button;
  }));
  pressSide(viewer.side);
}
