"""The parts of a record that no other room has a type for: what was asked, what was written, what it is set beside.

A field's name is a key of the record; where its default is None, the key is left out of what has no such thing.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Given:
    """What was asked of backend and writer; max_error, min_piece, offset: as written. normals: whether they are."""

    threads: int
    cap: bool
    normals: bool
    block_size: int | None = None
    max_error: str | None = None
    simplify: bool | None = None
    triangles: int | None = None
    topology: str | None = None
    smooth: int | None = None
    background: int | None = None
    keep_largest: int | None = None
    min_piece: str | None = None
    fill_bubbles: bool | None = None
    format: str
    space: str
    offset: str | None = None
    ignore: tuple[float, ...] | None = None
    carry: tuple[str, ...] | None = None
    merge_isovalues: bool | None = None
    compress: bool | None = None


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Asked:
    """What was asked for: the input and the output as they were named, the isovalue as it was written.

    volume: which of several, from 0. step, time: of a series, the step from 0 and its time.
    """

    source: str
    output: str
    asked: str = ""
    volume: int | None = None
    step: int | None = None
    time: float | None = None
    options: Given | None = None


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Written:
    """The output's hash and length."""

    sha256: str
    bytes: int


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Carried:
    """A field that was carried to the surface's vertices.

    of: what the field is of, points or cells. range: of its finite values there, of a vector's lengths; None without
    one. nonfinite: vertices where it is not finite.
    """

    name: str
    of: str
    components: int
    range: tuple[float, float] | None
    nonfinite: int


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Colors:
    """What vertices are coloured by: a carried field, or the lengths of one; a map's name; the values at its ends."""

    by: str
    colormap: str
    range: tuple[float, float] | None


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Reference:
    """Marching cubes on the same field; seconds: prepare and extract."""

    name: str
    triangles: int
    vertices: int
    seconds: float


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Ratio:
    """Ours beside the reference. triangles: reference / ours; seconds: ours / reference; None over zero."""

    triangles: float | None
    seconds: float | None


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Seconds:
    """Seconds by stage, and their sum. own: prepare and extract, the two that a reference has, too."""

    read: float = 0.0
    prepare: float = 0.0
    extract: float = 0.0
    normals: float = 0.0
    measure: float = 0.0
    write: float = 0.0
    total: float = 0.0
    own: float | None = None

    def __post_init__(self) -> None:
        if self.own is None:
            object.__setattr__(self, "own", self.prepare + self.extract)
