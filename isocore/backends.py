"""The table of backends: how a field becomes a surface.

A backend is a row. ``prepare(field, options, outlook)`` is where a method pays once per field and returns
``extract(isovalue)``, where it pays per isovalue. To add one: a kernel folder with a glossary, its bindings, a file in
methods/, one row below; the contract tests find it by themselves.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import fields
from typing import Any, NamedTuple

from isocore.cell_mesh import CellMesh
from isocore.errors import OptionError
from isocore.extraction import Extract, Extraction, Field, Outlook
from isocore.job import Job, Options
from isocore.labels import Label
from isocore.late import late
from isocore.volume import Volume

__all__ = [
    "BACKENDS",
    "Backend",
    "Extract",
    "Extraction",
    "Field",
    "Options",
    "Outlook",
    "check_options",
    "default_backend",
    "prepare",
]

#: The backend that all others are compared with.
REFERENCE = "mc"
#: Milliseconds of one processor per million cells: to thin them, and to look at them all for one isovalue.
_THINNING, _LOOKING = 250.0, 5.0
#: By how many milliseconds a walk draws slower than a scan; with the surface, it grows like cells^(2/3), in millions.
_WALKING = 1.5


class Backend(NamedTuple):
    """One method. accepts: the field types it takes; options: the names in Options that it alone understands."""

    name: str
    title: str
    accepts: tuple[type, ...]
    prepare: Callable[[Any, Options, Outlook], Extract]
    options: frozenset[str] = frozenset()
    cites: str = ""


BACKENDS: dict[str, Backend] = {
    backend.name: backend
    for backend in (
        Backend(
            name="asc",
            title="adaptive skeleton climbing",
            accepts=(Volume,),
            prepare=late("methods.climbing", "prepare_climbing"),
            options=frozenset({"block_size", "max_error", "simplify", "triangles"}),
            cites="Poston, Wong, Heng 1998",
        ),
        Backend(
            name="thinning",
            title="volume thinning",
            accepts=(CellMesh, Volume),
            prepare=late("methods.thinning", "prepare_thinning"),
            options=frozenset({"simplify", "triangles"}),
            cites="Itoh, Yamaguchi, Koyamada 1996, 2001",
        ),
        Backend(
            name="mc",
            title="marching cubes; marching tetrahedra for meshes",
            accepts=(Volume, CellMesh),
            prepare=late("methods.marching_cubes", "prepare_marching_cubes"),
            options=frozenset({"topology", "smooth", "simplify", "triangles"}),
            cites="Lorensen, Cline 1987; Nielson, Hamann 1991",
        ),
    )
}

#: What extracts label maps: not chosen by name but by asking for labels, and not by isovalue but by label.
LABELS = Backend(
    name="labels",
    title="multiple material marching cubes",
    accepts=(Volume,),
    prepare=late("methods.label_map", "prepare_labels"),
    options=frozenset({"smooth", "background", "max_error", "simplify", "triangles"}),
    cites="Hege, Seebass, Stalling, Zoeckler 1997; Wu, Sullivan 2003",
)


def default_backend(field_type: type, outlook: Outlook) -> tuple[str, str]:
    """The backend used when none is named, and why.

    Volumes are climbed. Of a mesh, thinning pays for few isovalues only where its index lies beside.
    """
    if not issubclass(field_type, CellMesh):
        return "asc", "the default for volumes"
    if outlook.index is not None:
        return "thinning", "the index beside the mesh is used"
    asked = f"{outlook.isovalues:,} isovalue" + "s" * (outlook.isovalues != 1)
    if outlook.isovalues < repays_thinning(outlook.cells):
        return "mc", f"a full scan, since {asked} would not repay thinning and no index lies beside the mesh"
    return "thinning", f"{asked} repay thinning"


def repays_thinning(cells: int) -> float:
    """From how many isovalues on thinning a mesh and walking through it is quicker than as many full scans.

    Fitted to what tests/bench/repays.py measures on smooth tetrahedra from 6,000 to 6,000,000: a walk saves the look at
    all cells, but draws its own slower than a scan. Infinite for small meshes, where it saves nothing.
    """
    millions = cells / 1e6
    saved = _LOOKING * millions - _WALKING * millions ** (2 / 3)
    return _THINNING * millions / saved if saved > 0 else math.inf


def backend_for(job: Job, field_type: type, outlook: Outlook) -> tuple[str, str]:
    """The backend of a job, and why it is this one."""
    if any(isinstance(target.choice, Label) for target in job.targets):
        return LABELS.name, "labels are asked for"
    if job.backend:
        return job.backend, "given"
    if job.options.smooth:
        return REFERENCE, "its surface is what is smoothed"
    return default_backend(field_type, outlook)


def prepare(field: Field, backend: str, options: Options, outlook: Outlook | None = None) -> Extract:
    """Prepare `field` for extraction by the backend of that name; outlook: what is to come, where that is known.

    Raises OptionError for an unknown name, a field it does not take, or an option it does not understand.
    """
    row = LABELS if backend == LABELS.name else BACKENDS.get(backend)
    if row is None:
        raise OptionError(f"{backend}: no such backend; choose one of {', '.join(BACKENDS)}")
    if not isinstance(field, row.accepts):
        kind = "volumes" if isinstance(field, Volume) else "meshes"
        able = [name for name, other in BACKENDS.items() if isinstance(field, other.accepts)]
        raise OptionError(f"{backend}: does not take {kind}; choose one of {', '.join(able)}")
    check_options(backend, options)
    return row.prepare(field, options, outlook or Outlook())


def check_options(backend: str, options: Options) -> None:
    """Refuse an option that the backend does not understand, rather than ignore it."""
    rows = BACKENDS | {LABELS.name: LABELS}
    own = rows[backend].options
    of_others = frozenset().union(*(row.options for row in rows.values())) - own
    if options.max_error is not None and "simplify" in own and "max_error" in of_others:
        if not (options.simplify or options.triangles):
            raise OptionError(f"--max-error: {backend} keeps one only with --simplify; add that or leave it out")
        of_others -= {"max_error"}
    for option in fields(Options):
        if option.name in of_others and getattr(options, option.name) is not None:
            raise OptionError(f"--{option.name.replace('_', '-')}: is not an option of {backend}; leave it out")
