"""What a reader may be told about a file that the file does not tell itself."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class MeshOptions:
    """How the cells of a mesh hang together.

    merge_points: join points within this distance, in the mesh's unit; None joins those at equal coordinates.
    keep_duplicates: join none. corners: read curved cells by their corners alone.
    """

    merge_points: float | None = None
    keep_duplicates: bool = False
    corners: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class ReadOptions:
    """Each reader takes what concerns its format and leaves the rest.

    volume: which volume of a 4-D file, counted from 0; None where the file holds one.
    step: which step of a series, counted from 0 in the order of their times; None where the file is none.
    field, component: VTU, which point field and which part of it ("0", "1", ... or "magnitude").
    mesh: how cells hang together.
    carry: further fields that the field carries: of a VTK file by name, "all" of them; for a volume also files, each
        with a volume on the same grid.
    ignore: values, scaled, whose samples count as outside, as NaN does.
    shape, dtype, spacing, origin, byte_order, offset: raw files; they go before those of a sidecar.
    """

    volume: int | None = None
    step: int | None = None
    field: str | None = None
    component: str | None = None
    mesh: MeshOptions = MeshOptions()
    ignore: tuple[float, ...] = ()
    carry: tuple[str, ...] = ()
    shape: tuple[int, ...] | None = None
    dtype: str | None = None
    spacing: tuple[float, ...] | None = None
    origin: tuple[float, ...] | None = None
    byte_order: str | None = None
    offset: int | None = None
