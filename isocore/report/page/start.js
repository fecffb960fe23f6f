// What happens when the page opens, and when something in it is touched.
let picked = null;

const beside = (run) => runs.filter((other) => other.mesh && other.source === run.source);

// An output is looked at: its facts, and its surface alone unless it is shown already.
function pick(run) {
  picked = run;
  for (const [other, row] of rows) row.setAttribute("aria-selected", other === run);
  at("#name").textContent = runs.length === 1 && run.output === "-" ? run.source : `${fileName(run.source)} → ${fileName(run.output)}`;
  at("#message").textContent = [run.message, ...run.missed.map((miss) => `misses ${miss}`), ...run.warnings].filter(Boolean).join(" · ");
  at("#message").className = run.status === "failed" || run.missed.length ? "bad" : "warn";
  if (run.mesh) offerSides(run);
  if (!shown.has(run)) show([run]);
  const others = beside(run).length;
  at("#together").hidden = others < 2 || !run.mesh || others === runs.length && shown.size === others;
  at("#together").textContent = `all ${others} of this input`;
  drawBars(run);
  drawHistogram(run);
  listFacts(run);
  listRecord(run);
}

at("#opacity").oninput = dress;
at("#wires").onchange = dress;
at("#together").onclick = () => show(beside(picked));
at("#fill").onclick = () => {
  const filled = document.body.classList.toggle("filled");
  at("#fill").setAttribute("aria-pressed", filled);
};
addEventListener("keydown", (event) => {
  if (event.key === "Escape" && document.body.classList.contains("filled")) at("#fill").click();
});

summarise();
fillTable();
document.body.classList.toggle("single", runs.length === 1);
if (runs.length) {
  const first = runs.find((run) => run.mesh) ?? runs[0];
  pick(first);
  if (first.label) show(beside(first)); // the labels of a map belong together
} else {
  at("#detail").hidden = at("#stage").hidden = true;
}
