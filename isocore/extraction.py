"""What a method is told beside its options, and what it gives back."""

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
class Outlook:
    """What is known when a method prepares, besides what was asked. It decides advice and what is worth preparing.

    isovalues: how many will be asked for, 0 where that is not known.
    index: the thinning index that lies beside a mesh, used where it matches.
    """

    isovalues: int = 0
    index: Path | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Extraction:
    """A surface in the world, and what its method has to say about it, by the report's keys."""

    surface: Surface
    facts: dict[str, Any] = field(default_factory=dict)
    warnings: tuple[str, ...] = ()


Extract = Callable[[float], Extraction]
