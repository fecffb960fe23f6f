"""The report as one page that works offline: totals, table, and each surface to turn."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from isocore.report.keys import batch_as_dict
from isocore.report.record import BatchReport, RunReport
from isocore.report.reduce import BYTES_PER_TRIANGLE, MOST_TRIANGLES, packed, reduced
from isocore.report.texts import shown_json

#: Bytes of all reduced surfaces together, unless told otherwise.
MESH_BYTES = 16 << 20
_PARTS = Path(__file__).parent / "page"
_FEWEST_TRIANGLES = 200


def render_html(batch: BatchReport, *, mesh_bytes: int = MESH_BYTES) -> str:
    """The page. mesh_bytes bounds what the copies of the surfaces add to it; 0 leaves them out."""
    record = batch_as_dict(batch)
    shown = [n for n, run in enumerate(batch.outputs) if run.triangles and run.output != "-"]
    left = mesh_bytes
    for place, number in enumerate(shown):
        most = min(left // (len(shown) - place) // BYTES_PER_TRIANGLE, MOST_TRIANGLES)
        if most < _FEWEST_TRIANGLES:
            most = min(left // BYTES_PER_TRIANGLE, _FEWEST_TRIANGLES)
        mesh = _copy(batch.outputs[number], most) if most else None
        if mesh is not None:
            size = len(mesh["vertices"]) + len(mesh["triangles"])
            if size <= left:
                record["outputs"][number]["mesh"] = mesh
                left -= size
    parts = {
        "css": _part("page.css"),
        "three": _part("three.min.js"),
        "js": _part("page.js"),
        "report": shown_json(record).replace("</", "<\\/").replace("<!", "<\\u0021"),
    }
    before, *rest = _part("page.html").split("{{")
    return before + "".join(parts[name] + after for name, after in (part.split("}}", 1) for part in rest))


def _copy(run: RunReport, most: int) -> dict[str, Any] | None:
    from isocore.writers.read_back import read_mesh  # a report without surfaces to show loads no kernels

    try:
        mesh = read_mesh(Path(run.output))
        return None if mesh is None else packed(reduced(mesh, most))
    except MemoryError:
        return None


def _part(name: str) -> str:
    return (_PARTS / name).read_text(encoding="utf-8")
