"""The report as one page that works offline: totals, table, and the surfaces to turn, each as a copy."""

from __future__ import annotations

import os
from base64 import b64encode
from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path
from urllib.parse import quote

from isocore.report.copies_found import with_copies
from isocore.report.keys import batch_as_dict
from isocore.report.record import MESH_BYTES, BatchReport
from isocore.report.texts import shown_json
from isocore.writers.colormaps import colormap

_PARTS = Path(__file__).parent / "page"
_SCRIPTS = ("page.js", "facts.js", "viewer.js", "start.js")


def render_html(batch: BatchReport, *, mesh_bytes: int = MESH_BYTES, page: Path | None = None) -> str:
    """The page. mesh_bytes bounds what the copies of the surfaces add to it; 0 leaves them out.

    page: where it will lie; it then has links to the meshes.
    """
    record = batch_as_dict(batch)
    left = mesh_bytes
    for one, run in zip(record["outputs"], with_copies(batch, mesh_bytes).outputs, strict=True):
        if run.copy is not None and run.copy.size <= left:
            left -= run.copy.size
            one["mesh"] = run.copy.as_dict()
        if page is not None and run.triangles and run.output != "-":
            one["link"] = _link(run.output, batch.folder, page)
    record["colormaps"] = _tables(run.colors.colormap for run in batch.outputs if run.colors is not None)
    parts = {
        "css": _part("page.css"),
        "three": _part("three.min.js"),
        "js": "\n".join(map(_part, _SCRIPTS)),
        "report": shown_json(record).replace("</", "<\\/").replace("<!", "<\\u0021"),
    }
    before, *rest = _part("page.html").split("{{")
    return before + "".join(parts[name] + after for name, after in (part.split("}}", 1) for part in rest))


def _tables(names: Iterable[object]) -> dict[str, str]:
    """The 256 colours of each map, as base64 of their red, green and blue."""
    found = {}
    for name in dict.fromkeys(name for name in names if isinstance(name, str)):  # a report may hold anything
        with suppress(ValueError):  # of another version
            found[name] = b64encode(colormap(name).tobytes()).decode()
    return found


def _link(output: str, folder: str, page: Path) -> str | None:
    """The way from the page to a mesh; None where none leads there, as between the drives of Windows."""
    places = [Path(folder) / output, Path(output)]
    mesh = next((place for place in places if place.is_file()), places[0])
    try:
        way = os.path.relpath(os.path.realpath(mesh), os.path.realpath(page.parent))
    except (OSError, ValueError):
        return None
    return quote(os.fsencode(way.replace(os.sep, "/")))


def _part(name: str) -> str:
    return (_PARTS / name).read_text(encoding="utf-8")
