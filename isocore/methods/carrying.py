"""The values of carried fields at a surface's vertices.

Every vertex lies on an edge of the grid or of a cell, and a field runs along that edge as the place of the vertex does:
with the same parameter, so that what is linear in space stays so. Vertices amid a cell (the middles of loops, those
that smoothing or a label map put there) lie in a volume between eight samples, and in a mesh amid their loop.
A value that is not finite has no say where another end of the edge has one.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import numpy.typing as npt

from isocore.carried import CarriedField
from isocore.cell_mesh import CellMesh
from isocore.methods.cell_values import Loops, cells_of
from isocore.volume import Volume

_CLAMP = 2.0**-10  # as in kernels/common/crossing.hpp
_VERTICES = 1 << 18  # at a time: what is worked with stays small

Fields = dict[str, npt.NDArray[Any]]


def volume_fields(volume: Volume, vertices: npt.NDArray[Any]) -> Fields:
    """(v,) or (v, k) of each carried field at vertices (v, 3) in index space.

    A cap's vertices lie a thousandth of a step beyond the border: there a field goes on as it was.
    """
    return {field.name: _of_volume(volume, field, vertices) for field in volume.carried}


def _of_volume(volume: Volume, field: CarriedField, vertices: npt.NDArray[Any]) -> npt.NDArray[Any]:
    shape = np.array(volume.shape) + {"points": 0, "cells": -1, "corners": 1}[field.of]
    result = np.empty((len(vertices), field.components), field.interpolated_type)
    for first in range(0, len(vertices), _VERTICES):
        places = vertices[first : first + _VERTICES].astype(np.float64)
        if field.of == "cells":
            cells = np.clip(np.ceil(places) - 1, 0, shape - 1).astype(np.int64)
            found = _stored(field, cells, shape)
        else:
            found = _between(field, places + (0.5 if field.of == "corners" else 0.0), shape)
        result[first : first + len(places)] = field.slope * found + field.intercept
    return result[:, 0] if field.values.ndim == 1 else result


def _between(
    field: CarriedField, places: npt.NDArray[np.float64], shape: npt.NDArray[Any]
) -> npt.NDArray[np.float64]:
    """(v, k) stored values between the samples around each place; on an edge only its two ends have a weight."""
    low = np.clip(np.floor(places), 0, shape - 2).astype(np.int64)
    share = places - low
    total, weights = np.zeros((len(places), field.components)), np.zeros((len(places), field.components))
    for corner in np.ndindex(2, 2, 2):
        weight = np.prod(np.where(corner, share, 1 - share), axis=1)
        rows = np.flatnonzero(weight)
        _add(total, weights, rows, _stored(field, low[rows] + np.array(corner), shape), weight[rows])
    with np.errstate(invalid="ignore"):
        return np.asarray(total / weights)


def _add(
    total: npt.NDArray[np.float64],
    weights: npt.NDArray[np.float64],
    rows: npt.NDArray[np.intp],
    values: npt.NDArray[np.float64],
    weight: npt.NDArray[np.float64],
) -> None:
    """Weighted values to `total` at `rows`, but for those that are not finite."""
    finite = np.isfinite(values)
    total[rows] += np.where(finite, values, 0.0) * weight[:, None]
    weights[rows] += finite * weight[:, None]


def _stored(field: CarriedField, index: npt.NDArray[np.int64], shape: npt.NDArray[Any]) -> npt.NDArray[np.float64]:
    """(v, k) at indices (v, 3)."""
    flat = index[:, 0] + shape[0] * (index[:, 1] + shape[1] * index[:, 2])
    return np.asarray(field.values[flat].reshape(len(flat), field.components), np.float64)


def mesh_fields(
    mesh: CellMesh,
    edges: npt.NDArray[np.int32],
    triangles: npt.NDArray[np.int32],
    count: int,
    isovalue: float,
    curved: Mapping[str, tuple[npt.NDArray[np.intp], npt.NDArray[np.float64]]],
) -> Fields:
    """(v,) or (v, k) of each carried field at `count` vertices.

    edges: (e, 2) points of the mesh, ascending, of the first e vertices; those behind lie in the middle of a loop of
    `triangles` (t, 3). curved: by name, vertices whose edge is curved, and the values there.
    """
    share, loops = _shares(mesh, edges, isovalue), _loops(triangles, len(edges), count)
    cells = np.full(count, -1)
    if any(field.of == "cells" for field in mesh.carried):
        cells = cells_of(mesh.sources, edges, len(mesh.points), loops)
    found: Fields = {}
    for field in mesh.carried:
        result = np.full((count, field.components), np.nan)
        if field.of == "cells":
            known = cells >= 0
            result[known] = field.values[cells[known]].reshape(int(known.sum()), field.components)
        else:
            result[: len(edges)] = _along(field, edges, share)
            if field.name in curved:
                vertices, values = curved[field.name]
                result[vertices] = values
            _average(result, loops)
        result = (field.slope * result + field.intercept).astype(field.interpolated_type)
        found[field.name] = result[:, 0] if field.values.ndim == 1 else result
    return found


def _shares(mesh: CellMesh, edges: npt.NDArray[np.int32], isovalue: float) -> npt.NDArray[np.float64]:
    """(e,) how far along its edge each vertex lies, as kernels/common/crossing.hpp reckons it."""
    with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
        a, b = (mesh.values[edges[:, n]].astype(np.float64) for n in (0, 1))
        share = np.where(np.isfinite(b - a), (isovalue - a) / (b - a), (isovalue / 4 - a / 4) / (b / 4 - a / 4))
        share = np.where(np.isfinite(a) & np.isfinite(b), share, 0.5)
    return np.clip(share, _CLAMP, 1 - _CLAMP)


def _along(
    field: CarriedField, edges: npt.NDArray[np.int32], share: npt.NDArray[np.float64]
) -> npt.NDArray[np.float64]:
    """(e, k) values between the ends of edges."""
    result = np.empty((len(edges), field.components))
    for first in range(0, len(edges), _VERTICES):
        some, weight = edges[first : first + _VERTICES], share[first : first + _VERTICES]
        total, weights = np.zeros((len(some), field.components)), np.zeros((len(some), field.components))
        rows = np.arange(len(some))
        for end, part in ((some[:, 0], 1 - weight), (some[:, 1], weight)):
            _add(total, weights, rows, field.values[end].reshape(len(end), field.components).astype(np.float64), part)
        with np.errstate(invalid="ignore"):
            result[first : first + len(some)] = total / weights
    return result


def _loops(triangles: npt.NDArray[np.int32], edges: int, count: int) -> Loops:
    """The loops around the vertices that lie on no edge: the corners of the triangles that they are corners of."""
    around = triangles[(triangles >= edges).any(axis=1)] if count > edges else triangles[:0]
    pairs = [np.empty((0, 2), np.int64)]
    for a, b in ((0, 1), (0, 2), (1, 0), (1, 2), (2, 0), (2, 1)):
        some = around[(around[:, a] >= edges) & (around[:, b] < edges)]
        pairs.append(np.column_stack((some[:, a] - edges, some[:, b])))
    middles, beside = np.unique(np.concatenate(pairs), axis=0).T
    return Loops(count - edges, middles, beside)


def _average(values: npt.NDArray[np.float64], loops: Loops) -> None:
    """Vertices in the middle of a loop get its mean, as their place is."""
    if not loops.count:
        return
    total, count = np.zeros((loops.count, values.shape[1])), np.zeros(loops.count)
    np.add.at(total, loops.middles, values[loops.edges])
    np.add.at(count, loops.middles, 1)
    with np.errstate(invalid="ignore"):
        values[-loops.count :] = total / count[:, None]
