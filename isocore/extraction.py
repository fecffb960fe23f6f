"""What is asked of a backend, and what it gives back."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from isocore.cell_mesh import CellMesh
from isocore.surface import Surface
from isocore.volume import Volume

Field = Volume | CellMesh


@dataclass(frozen=True, slots=True, kw_only=True)
class Options:
    """What a user may ask of an extraction. A backend lists those it understands beyond the first five.

    threads: at least 1. Results do not depend on it.
    cap: close the surface at the volume's border.
    normals: compute vertex normals.
    isovalues: how many will be asked for, 0 where that is not known; decides advice and what is worth preparing, not
        results.
    index: the thinning index of a mesh, used where it matches.
    topology: "faces" (the default) closes every loop of a cell by a disk; "trilinear" joins two by a tube where the
        trilinear function does.
    """

    threads: int = 1
    cap: bool = False
    normals: bool = False
    isovalues: int = 0
    index: Path | None = None
    block_size: int | None = None
    max_error: str | None = None
    topology: str | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Extraction:
    """A surface in the world, and what its method has to say about it, by the report's keys."""

    surface: Surface
    facts: dict[str, Any] = field(default_factory=dict)
    warnings: tuple[str, ...] = ()


Extract = Callable[[float], Extraction]
