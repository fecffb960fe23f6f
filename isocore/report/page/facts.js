// Of one output: bars beside the reference, the histogram, and what the report says of it, in words.
function drawBars(run) {
  const place = at("#bars");
  place.replaceChildren();
  const pairs = [
    ["triangles", dig(run, "surface.triangles"), dig(run, "reference.triangles"), whole],
    ["seconds", ownSeconds(run), dig(run, "reference.seconds"), short(3)],
  ];
  for (const [title, ours, reference, show] of run.reference ? pairs : []) {
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

const digits = (value) => value.toLocaleString("en", { maximumSignificantDigits: 4 });
const several = (count, one, many = `${one}s`) => `${whole(count)} ${count === 1 ? one : many}`;
const cubed = (unit, power) => (unit ? ` ${unit}${power}` : ` cubed units`.replace("cubed", power === "²" ? "squared" : "cubed"));
const joined = (...parts) => parts.filter((part) => part).join("; ");
const SPACES = {
  ras: "RAS: x to the right, y to the front, z to the head",
  lps: "LPS: x to the left, y to the back, z to the head",
  las: "LAS: x to the left, y to the front, z to the head",
  index: "samples, counted from 0",
};

function inputInWords(run) {
  if (!run.shape) return run.source;
  const unit = run.unit ? ` ${run.unit}` : "";
  const size = run.kind === "volume"
    ? `a volume of ${run.shape.map(whole).join(" × ")} samples (${run.dtype}), ${run.spacing.map(digits).join(" × ")}${unit} apart`
    : `a mesh of ${several(run.shape[0], "point")} and ${several(run.shape[1], "cell")} (${run.dtype})`;
  const which = joined(run.field && `field ${run.field}`, run.volume != null && `volume ${run.volume}`, run.step != null && `step ${run.step}`);
  return `${run.source}: ${size}${which && `; ${which}`}`;
}

function shapeInWords(surface) {
  const holes = surface.boundary_edges ? `open along ${several(surface.boundary_edges, "edge")}` : surface.watertight ? "closed" : "not closed";
  const bad = surface.nonmanifold_edges + surface.nonmanifold_vertices;
  return joined(
    holes,
    several(surface.components, "piece"),
    bad ? `not manifold at ${several(bad, "place")}` : "manifold",
    surface.misoriented_edges && `${several(surface.misoriented_edges, "edge")} between triangles that turn against each other`,
    surface.degenerate && several(surface.degenerate, "triangle without area", "triangles without area"),
    surface.self_intersections == null ? "" : surface.self_intersections ? `cuts itself: ${several(surface.self_intersections, "pair")} of triangles meet` : "does not cut itself",
  );
}

function errorInWords(run) {
  const { error } = run;
  if (!error) return "";
  const unit = error.unit ? ` ${error.unit}` : "";
  const far = (voxels, world) => (voxels == null ? `${digits(world)}${unit}` : `${digits(voxels)} voxel (${digits(world)}${unit || " in the world"})`);
  return joined(
    `vertices of ${dig(run, "reference.name") === "mc" ? "marching cubes" : "the reference"} lie at most ${far(error.max, error.max_world)} from the surface, on average ${far(error.mean, error.mean_world)}`,
    error.back_max_world != null && `no point of the surface lies further than ${far(error.back_max, error.back_max_world)} from the reference`,
    error.bound !== "none" && `allowed: ${error.bound}${/[a-z]/.test(error.bound) ? "" : " voxel"}`,
  );
}

function againstInWords(run) {
  const ratio = dig(run, "ratio.triangles"), { reference } = run;
  if (!reference) return "";
  const fewer = ratio > 1.005 ? `${digits(ratio)} times fewer triangles than marching cubes' ${whole(reference.triangles)}` : `marching cubes has ${several(reference.triangles, "triangle")}`;
  return `${fewer}; ${digits(ownSeconds(run))} s, marching cubes ${digits(reference.seconds)} s`;
}

function carriedInWords(run) {
  return (run.carried ?? []).map(({ name, components, range }) => {
    const what = components > 1 ? `${name} (${components} components), length` : name;
    return range ? `${what} from ${digits(range[0])} to ${digits(range[1])}` : `${what}: no numbers`;
  }).join("; ");
}

function factsOf(run) {
  const { surface, seconds } = run;
  const unit = surface?.unit ? ` ${surface.unit}` : "";
  const sides = surface?.bounds && surface.bounds[1].map((high, axis) => digits(high - surface.bounds[0][axis])).join(" × ");
  const label = run.label && `${run.label.name || "label"} (${run.label.value}): ${several(run.label.voxels, "voxel")}, ${digits(run.label.voxel_volume)}${cubed(run.unit, "³")}`;
  const taken = seconds.total == null ? "" : ["read", "prepare", "extract", "normals", "measure", "write"].filter((stage) => seconds[stage] >= 0.0005).map((stage) => `${stage} ${seconds[stage].toFixed(3)}`).join(", ");
  return [
    ["input", inputInWords(run)],
    ["coordinates", SPACES[run.space] ?? (run.space ? "as in the file, which does not say which way they point" : "")],
    ["label", label],
    ["isovalue", isNumber(run.isovalue) ? `${precise(run.isovalue)} (${run.chosen})` : ""],
    ["method", joined(run.backend, run.backend_chosen)],
    ["surface", surface && `${several(surface.triangles, "triangle")}, ${several(surface.vertices, "vertex", "vertices")}`],
    ["shape", surface?.triangles ? shapeInWords(surface) : ""],
    ["size", surface?.triangles ? joined(
      `${sides}${unit}`,
      `area ${digits(surface.area)}${cubed(surface.unit, "²")}`,
      surface.volume != null && `volume ${digits(surface.volume)}${cubed(surface.unit, "³")}`) : ""],
    ["carried", carriedInWords(run)],
    ["reference", againstInWords(run)],
    ["error", errorInWords(run)],
    ["pieces", run.pieces && `${whole(run.pieces.kept)} of ${several(run.pieces.found, "piece")} kept`],
    ["time", seconds.total == null ? "" : `${seconds.total.toFixed(3)} s${taken && `: ${taken}`}`],
    ["memory", run.peak_rss_bytes == null ? "" : `${digits(run.peak_rss_bytes / 2 ** 20)} MiB at most`],
  ];
}

function listFacts(run) {
  const list = at("#facts");
  list.replaceChildren();
  for (const [key, text] of factsOf(run)) if (text) list.append(make("dt", key), make("dd", text));
  if (run.bytes == null && !run.link) return;
  const cell = make("dd");
  if (run.link) {
    const link = make("a", run.output);
    link.href = run.link;
    cell.append(link);
  } else cell.append(run.output);
  if (run.bytes != null) cell.append(`, ${run.bytes < 1e6 ? `${digits(run.bytes / 1e3)} kB` : `${digits(run.bytes / 1e6)} MB`}`);
  list.append(make("dt", "file"), cell);
}

function listRecord(run) {
  const list = at("#record");
  list.replaceChildren();
  const add = (key, value) => {
    const show = key === "isovalue" || key === "range" ? precise : plain;
    if (value == null || value === "" || key.startsWith("histogram") || key === "mesh" || key === "link") return;
    if (Array.isArray(value) && value.some((part) => part && typeof part === "object" && !Array.isArray(part))) {
      value.forEach((part, number) => add(`${key}.${number}`, part));
    } else if (Array.isArray(value)) {
      if (value.length) list.append(make("dt", key), make("dd", value.flat(3).map(show).join(", ")));
    } else if (typeof value === "object") {
      for (const [inner, part] of Object.entries(value)) add(`${key}.${inner}`, part);
    } else {
      list.append(make("dt", key), make("dd", isNumber(value) ? show(value) : String(value)));
    }
  };
  for (const [key, value] of Object.entries(run)) add(key, value);
}
