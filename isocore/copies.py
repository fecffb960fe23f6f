"""Small copies of surfaces to look at: what a page shows instead of the meshes themselves.

A copy is made where the surface is, from its arrays. Where that has too many triangles, vertices that hang together in
one cell of a grid are made one, so that no hole appears: a few passes over the mesh, much less than it took to make it.
"""

from __future__ import annotations

import base64
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import numpy.typing as npt

from isocore import _kernels
from isocore.surface import Point, Surface

Colour = tuple[int, int, int]

#: Of one copy, however much room there is: so many are drawn at once by any browser.
MOST_TRIANGLES = 120_000
#: Of a copy in a page: half a vertex of 6 bytes, a normal of 3 and a value of 2, and 6 bytes of indices, as base64.
BYTES_PER_TRIANGLE = 16
#: In place of a value that is no number; all others are steps below it.
_NO_VALUE = 65535
_FEWEST_TRIANGLES = 200


@dataclass(frozen=True, slots=True, eq=False)
class Copy:
    """A surface in 16-bit steps between two corners of its box, in the world.

    vertices: little-endian uint16, x, y, z of each. triangles: three vertex numbers each, uint16, or uint32 where there
    are 65536 vertices or more. normals: int8, x, y, z of each vertex, or None. count: of triangles. values: uint16, of
    each vertex the steps of 1 / 65534 from the low to the high end of value_range, 65535 where there is none; or None.
    """

    low: Point
    high: Point
    vertices: bytes
    triangles: bytes
    normals: bytes | None
    count: int
    colour: Colour | None = None
    values: bytes | None = None
    value_range: tuple[float, float] | None = None

    @property
    def size(self) -> int:
        """Bytes in a page, about."""
        arrays = (self.vertices, self.triangles, self.normals or b"", self.values or b"")
        return sum(map(len, arrays)) * 4 // 3

    def as_dict(self) -> dict[str, Any]:
        """Plain JSON types; arrays in base64."""
        texts = {"vertices": self.vertices, "triangles": self.triangles, "normals": self.normals}
        texts |= {} if self.values is None else {"values": self.values}
        return {
            "low": list(self.low),
            "high": list(self.high),
            "count": self.count,
            "colour": None if self.colour is None else "#{:02x}{:02x}{:02x}".format(*self.colour),
            **({} if self.value_range is None else {"value_range": list(self.value_range)}),
            **{name: None if data is None else base64.b64encode(data).decode() for name, data in texts.items()},
        }


def copy_from_dict(record: Any) -> Copy | None:
    """The inverse of Copy.as_dict; None for what is none, as in a damaged file."""
    try:
        data = {key: base64.b64decode(record[key], validate=True) for key in ("vertices", "triangles")}
        normals = None if record["normals"] is None else base64.b64decode(record["normals"], validate=True)
        values = base64.b64decode(record["values"], validate=True) if "values" in record else None
        limits = tuple(map(float, record["value_range"])) if values is not None else None
        low, high = (tuple(map(float, record[key])) for key in ("low", "high"))
        colour = None if record["colour"] is None else tuple(bytes.fromhex(record["colour"][1:]))
        more = {"count": int(record["count"]), "colour": colour, "values": values, "value_range": limits}
        copy = Copy(low=low, high=high, normals=normals, **data, **more)  # type: ignore[arg-type]
    except (KeyError, TypeError, ValueError, OverflowError):
        return None
    return copy if _holds(copy) else None


def _holds(copy: Copy) -> bool:
    """Whether the arrays belong together."""
    vertices = len(copy.vertices) // 6
    width = 2 if vertices < 65536 else 4
    if len(copy.vertices) != 6 * vertices or len(copy.triangles) != 3 * width * copy.count or not copy.count:
        return False
    if len(copy.low) != 3 or len(copy.high) != 3 or not np.isfinite((copy.low, copy.high)).all():
        return False
    if copy.normals is not None and len(copy.normals) != 3 * vertices:
        return False
    if copy.values is not None:
        limits = copy.value_range or ()
        if len(copy.values) != 2 * vertices or len(limits) != 2 or not np.isfinite(limits).all():
            return False
    return int(np.frombuffer(copy.triangles, f"<u{width}").max()) < vertices


def triangles_each(page_bytes: int, surfaces: int) -> int:
    """How many triangles each of so many copies may have, for all of them to fit into a page; 0 for none at all."""
    share = min(page_bytes // max(surfaces, 1) // BYTES_PER_TRIANGLE, MOST_TRIANGLES)
    return max(share, _FEWEST_TRIANGLES) if page_bytes >= BYTES_PER_TRIANGLE else 0


def copied(
    surface: Surface, most: int, colour: Colour | None = None, values: npt.NDArray[Any] | None = None
) -> Copy | None:
    """A copy with at most `most` triangles. values: (v,) what its vertices are coloured by.

    None where there is nothing to draw, where the box is longer than a double can say, or where memory is too short.
    """
    if not most or not len(surface.triangles):
        return None
    try:
        kept, triangles = _fewer(surface.vertices, surface.triangles, most)
        # Where triangles are few, those tell better than single gradients how light falls on them.
        normals = surface.normals if triangles is surface.triangles else None
        copy = _packed(surface.vertices[kept], triangles, normals, surface.offset, colour)
        if copy is None or values is None:
            return copy
        steps, limits = _in_steps(values[kept])
        return copy if limits is None else replace(copy, values=steps.tobytes(), value_range=limits)
    except MemoryError:
        return None


def _fewer(
    vertices: npt.NDArray[Any], triangles: npt.NDArray[np.int32], most: int
) -> tuple[npt.NDArray[np.int32] | slice, npt.NDArray[np.int32]]:
    """Which of the vertices are left, and the triangles of these."""
    return (slice(None), triangles) if len(triangles) <= most else _kernels.cluster(vertices, triangles, most)


def _in_steps(values: npt.NDArray[Any]) -> tuple[npt.NDArray[np.uint16], tuple[float, float] | None]:
    """Values as a copy has them, and the range of the steps; None where none is a number."""
    finite = np.isfinite(values)
    if not finite.any():
        return np.empty(0, "<u2"), None
    low, high = float(values[finite].min()), float(values[finite].max())
    with np.errstate(over="ignore", invalid="ignore"):
        share = np.where(finite, (values / 2.0 - low / 2) / ((high / 2 - low / 2) or 1.0), 0.0)
    return np.where(finite, np.rint(share * (_NO_VALUE - 1)), _NO_VALUE).astype("<u2"), (low, high)


def _packed(
    vertices: npt.NDArray[Any],
    triangles: npt.NDArray[np.int32],
    normals: npt.NDArray[np.float32] | None,
    offset: Point | None,
    colour: Colour | None,
) -> Copy | None:
    if not len(triangles):
        return None
    low, high = vertices.min(axis=0).astype(float), vertices.max(axis=0).astype(float)
    with np.errstate(over="ignore"):
        sides = high - low
    if not np.isfinite(sides).all():
        return None
    steps = np.rint((vertices - low) / np.where(sides > 0, sides, 1) * 65535).astype("<u2")
    away = np.zeros(3) if offset is None else np.array(offset)
    low, high = low + away, high + away
    return Copy(
        low=(float(low[0]), float(low[1]), float(low[2])),
        high=(float(high[0]), float(high[1]), float(high[2])),
        vertices=steps.tobytes(),
        triangles=triangles.astype("<u2" if len(vertices) < 65536 else "<u4").tobytes(),
        normals=None if normals is None else np.rint(normals * 127).astype(np.int8).tobytes(),
        count=len(triangles),
        colour=colour,
    )
