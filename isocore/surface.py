"""A surface: triangles in the world, ready to be measured and written."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import numpy.typing as npt

from isocore import _kernels, exchange
from isocore.placing import coordinate_type
from isocore.volume import Space

if TYPE_CHECKING:
    import meshio
    import pyvista
    import trimesh

Point = tuple[float, float, float]


class Part(NamedTuple):
    """A run of a surface's vertices and of its triangles, which name no others: a label, or all there is.

    vertices, triangles: how many. colour: red, green, blue, 0 to 255. label: its number in a label map. isovalue: of
    a part of several in one file.
    """

    name: str
    vertices: int
    triangles: int
    colour: tuple[int, int, int] | None = None
    label: int | None = None
    isovalue: float | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Surface:
    """A triangle mesh, counter-clockwise seen from outside.

    vertices: (v, 3) float32, world (float64 where float32 would move a vertex by more than 1e-3 voxel).
    triangles: (t, 3) int32, indices into vertices.
    normals: (v, 3) float32, unit length, pointing outside; or None.
    space, unit: as in Volume.
    offset: the point of the world that vertices are measured from; None is its origin.
    parts: what it is made of, one behind the other; () where nothing has a name or a colour.
    fields: by name (v,) or (v, k) float32 or float64, values that were carried to the vertices.
    colours: (v, 3) uint8 red, green, blue of each vertex, which go before those of parts; or None.
    """

    vertices: npt.NDArray[Any]
    triangles: npt.NDArray[np.int32]
    normals: npt.NDArray[np.float32] | None = None
    space: Space = "native"
    unit: str = ""
    offset: Point | None = None
    parts: tuple[Part, ...] = ()
    fields: Mapping[str, npt.NDArray[Any]] = field(default_factory=dict)
    colours: npt.NDArray[np.uint8] | None = None

    def __post_init__(self) -> None:
        real = self.vertices.dtype.kind == "f" and self.vertices.dtype.itemsize in (4, 8)
        if self.vertices.ndim != 2 or self.vertices.shape[1] != 3 or not real:
            raise ValueError("vertices must be (v, 3) float32 or float64")
        if self.triangles.ndim != 2 or self.triangles.shape[1] != 3 or self.triangles.dtype != np.int32:
            raise ValueError("triangles must be (t, 3) int32")
        for count, rows in (("vertices", self.vertices), ("triangles", self.triangles)):
            if self.parts and sum(getattr(part, count) for part in self.parts) != len(rows):
                raise ValueError(f"the parts' {count} must add up to all")
        normals = self.normals
        if normals is not None and (normals.shape != self.vertices.shape or normals.dtype != np.float32):
            raise ValueError("normals must be (v, 3) float32")
        for name, values in self.fields.items():
            if len(values) != len(self.vertices) or values.ndim > 2 or values.dtype.name not in ("float32", "float64"):
                raise ValueError(f"field {name!r} must be (v,) or (v, k) float32 or float64")
        object.__setattr__(self, "fields", {name: _frozen(values) for name, values in self.fields.items()})
        colours = self.colours
        if colours is not None and (colours.shape != self.vertices.shape or colours.dtype != np.uint8):
            raise ValueError("colours must be (v, 3) uint8")
        for name in ("vertices", "triangles", "normals", "colours"):
            array = getattr(self, name)
            if array is not None:
                object.__setattr__(self, name, _frozen(array))

    def __repr__(self) -> str:
        """How large it is, and what its coordinates mean."""
        counts = f"{len(self.vertices):,} vertices, {len(self.triangles):,} triangles"
        about = "" if self.offset is None else f", about {self.offset}"
        place = ", ".join(filter(None, (self.space, self.unit)))
        more = ("normals",) * (self.normals is not None) + tuple(self.fields)
        return f"Surface({', '.join((counts, *more))}, {place}{about})"

    def to_trimesh(self) -> trimesh.Trimesh:
        """This surface as a trimesh.Trimesh, with its normals and fields; needs `pip install trimesh`."""
        return exchange.to_trimesh(self.world_vertices, self.triangles, self.normals, self.fields, self._place)

    def to_pyvista(self) -> pyvista.PolyData:
        """As a pyvista.PolyData, with its normals ("Normals") and fields as point data; needs `pip install pyvista`."""
        return exchange.to_pyvista(self.world_vertices, self.triangles, self.normals, self.fields, self._place)

    def to_meshio(self) -> meshio.Mesh:
        """This surface as a meshio.Mesh, with its normals ("Normals") and fields as point data."""
        return exchange.to_meshio(self.world_vertices, self.triangles, self.normals, self.fields)

    @property
    def world_vertices(self) -> npt.NDArray[Any]:
        """(v, 3), world: `vertices` themselves, or a float64 copy of those that are measured from an offset."""
        return self.vertices if self.offset is None else self.vertices + np.array(self.offset, dtype=np.float64)

    @property
    def _place(self) -> dict[str, str]:
        return {"space": self.space, "unit": self.unit}

    def placed(
        self,
        affine: npt.NDArray[np.float64],
        *,
        space: Space | None = None,
        unit: str | None = None,
        threads: int = 1,
    ) -> Surface:
        """This surface, moved by `affine` (4, 4), which takes its frame to that of `space`.

        The only place where a mirrored affine swaps two corners of every triangle.
        """
        mirrored = np.linalg.det(affine[:3, :3]) < 0
        placed = place_fresh(
            self.vertices,
            self.triangles.copy() if mirrored else self.triangles,
            None if self.normals is None else self.normals.copy(),
            affine,
            space=self.space if space is None else space,
            unit=self.unit if unit is None else unit,
            threads=threads,
        )
        return replace(placed, fields=self.fields) if self.fields else placed


def _frozen(array: npt.NDArray[Any]) -> npt.NDArray[Any]:
    array = np.ascontiguousarray(array)
    array.flags.writeable = False
    return array


def joined(surfaces: list[Surface]) -> Surface:
    """One surface of several, which share frame, unit, offset and fields and each have parts. At least one.

    The list is emptied on the way, so that nothing is in memory twice.
    """
    first = surfaces[0]
    count = sum(len(surface.vertices) for surface in surfaces)
    if count > np.iinfo(np.int32).max:
        raise ValueError("has more vertices than an int32 can name")
    vertices = np.empty((count, 3), np.result_type(*(surface.vertices for surface in surfaces)))
    triangles = np.empty((sum(len(surface.triangles) for surface in surfaces), 3), np.int32)
    normals = None if any(surface.normals is None for surface in surfaces) else np.empty((count, 3), np.float32)
    values = {name: np.empty((count, *first.fields[name].shape[1:]), first.fields[name].dtype) for name in first.fields}
    parts: list[Part] = []
    surfaces.reverse()
    at = at_triangle = 0
    while surfaces:
        surface = surfaces.pop()
        own = slice(at, at + len(surface.vertices))
        vertices[own] = surface.vertices
        if normals is not None:
            normals[own] = surface.normals
        for name, array in values.items():
            array[own] = surface.fields[name]
        np.add(surface.triangles, np.int32(at), out=triangles[at_triangle : at_triangle + len(surface.triangles)])
        at, at_triangle = own.stop, at_triangle + len(surface.triangles)
        parts += surface.parts
    return Surface(vertices, triangles, normals, first.space, first.unit, first.offset, tuple(parts), values)


def place_fresh(
    vertices: npt.NDArray[Any],
    triangles: npt.NDArray[np.int32],
    normals: npt.NDArray[np.float32] | None,
    affine: npt.NDArray[np.float64],
    *,
    space: Space,
    unit: str,
    threads: int = 1,
    dtype: type | None = None,
) -> Surface:
    """As `Surface.placed`, on arrays nobody else holds: they are changed where they lie if they can be.

    vertices: (v, 3) float32 or float64; triangles: (t, 3) int32; normals: (v, 3) float32 or None, all in the
    frame that `affine` (4, 4) starts from. dtype: what the vertices shall be; as `coordinate_type` says, if not given.
    """
    rows = np.ascontiguousarray(affine[:3], dtype=np.float64)
    dtype = dtype or coordinate_type(vertices, rows)
    fits = vertices.dtype == dtype and vertices.flags.writeable
    out = vertices if fits else np.empty(vertices.shape, dtype)
    _kernels.place(vertices, rows, out, threads)
    if np.linalg.det(rows[:, :3]) < 0:
        _kernels.flip(triangles, threads)
    if normals is not None:
        _kernels.turn_normals(normals, rows, threads)
    return Surface(out, triangles, normals, space, unit)
