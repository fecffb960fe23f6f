"""What a method is told beside its options, and what it gives back."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import TYPE_CHECKING, Any

from isocore.cell_mesh import CellMesh
from isocore.surface import Surface
from isocore.volume import Volume

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

Field = Volume | CellMesh


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Outlook:
    """What is known when a method prepares, besides what was asked. It decides advice and what is worth preparing.

    isovalues: how many will be asked for, 0 where that is not known.
    cells: of the mesh, 0 where the field is none.
    index: the thinning index that lies beside a mesh, used where it matches.
    named: whether the user named the method; against the program's own choice there is no advice.
    """

    isovalues: int = 0
    cells: int = 0
    index: Path | None = None
    named: bool = True


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Angles:
    """Between each triangle's normal and the field's gradient at its corners, in degrees; p95: 95 % are no larger."""

    mean: float
    p95: float
    max: float


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Deviation:
    """How far the reference's vertices lie from the surface: largest, mean and root mean square.

    In voxels, None for a mesh, and in the world in `unit`; bound: what was asked for, as it was written. back_max: no
    point of the surface lies further from the reference; None where that is not known. normal_degrees: how far
    triangles are turned from the field's gradient, in the world.
    """

    max: float | None
    mean: float | None
    rms: float | None
    max_world: float
    mean_world: float
    rms_world: float
    unit: str
    bound: str
    back_max: float | None = None
    back_max_world: float | None = None
    normal_degrees: Angles | None = None


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Simplification:
    """How triangles became fewer: edges contracted, and refused by each rule; seconds: of its own."""

    triangles_before: int
    collapses: int
    refused_link: int
    refused_shape: int
    refused_outward: int
    refused_back: int
    refused_crossing: int
    seconds: float


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Search:
    """How the cells that a surface passes through were found, in numbers of cells; None where a method has none.

    extrema: points that are local extrema; skeleton: cells of the thinned field; seeds: where walks started.
    """

    cells: int
    extrema: int | None = None
    skeleton: int | None = None
    seeds: int | None = None
    visited: int
    intersected: int


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Ambiguous:
    """Cell faces and cells where the samples allow two surfaces; tubes: pairs of loops that were joined by one."""

    faces: int
    cells: int
    tubes: int | None = None


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Climbing:
    """What became of the blocks. highrices: boxes that got triangles; split_again: those that broke the bound."""

    highrices: int
    split_again: int
    blocks: int
    blocks_visited: int
    blocks_skipped: int


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class LabelFacts:
    """One label of a label map.

    name, color (`#rrggbb`): where they are known. voxels: its samples; voxel_volume: theirs, in cubed units of length.
    neighbours: the labels it shares a border with, background too.
    """

    value: int
    name: str = ""
    color: str | None = None
    voxels: int
    voxel_volume: float
    neighbours: tuple[int, ...]


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Pieces:
    """What was kept of a surface's pieces, which are solids with their bubbles.

    found: pieces before. dropped: pieces that were too small; swallowed: those in bubbles that were filled; open: of
    those found, the ones that end at the volume's border. triangles_dropped, vertices_dropped: with all of them and
    with the filled bubbles. volume_dropped, volume_filled: in cubed units of length, of what is closed; the volume
    after is that before - dropped + filled.
    """

    found: int
    kept: int
    dropped: int
    swallowed: int
    bubbles_filled: int
    open: int
    triangles_dropped: int
    vertices_dropped: int
    volume_dropped: float
    volume_filled: float


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Findings:
    """What a method has to say about one surface, by the report's keys; facts: what no other key covers."""

    simplification: Simplification | None = None
    error: Deviation | None = None
    search: Search | None = None
    ambiguous: Ambiguous | None = None
    climbing: Climbing | None = None
    label: LabelFacts | None = None
    pieces: Pieces | None = None
    facts: dict[str, Any] = field(default_factory=dict)


@dataclass(frozen=True, slots=True, eq=False)
class Extraction:
    """A surface in the world, and what its method has to say about it.

    seconds_normals: for vertex normals alone; seconds_degrees: for the angles between triangles and the gradient.
    """

    surface: Surface
    findings: Findings = field(default_factory=Findings)
    warnings: tuple[str, ...] = ()
    seconds_normals: float = 0.0
    seconds_degrees: float = 0.0

    @property
    def facts(self) -> dict[str, Any]:
        """The findings as they stand in the report; what there is nothing to say about is left out."""
        found = self.findings
        names = ("simplification", "error", "search", "ambiguous", "climbing", "label", "pieces")
        parts = {name: getattr(found, name) for name in names}
        return {key: keys_of(part) for key, part in parts.items() if part is not None} | found.facts


Extract = Callable[[float], Extraction]


def keys_of(section: DataclassInstance) -> dict[str, Any]:
    """A section of the report by its keys; a field whose default is None is left out where it is None."""
    values = ((item, getattr(section, item.name)) for item in fields(section))
    return {item.name: value for item, value in values if value is not None or item.default is not None}
