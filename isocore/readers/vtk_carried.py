"""Fields of a VTK mesh besides the contoured one: which are asked for, and what joining and dividing make of them.

A field of points goes the way of the contoured one: joined points get one value, points that dividing adds get the sum
that their place is. A field of cells stays as it is, and the cells are kept as the file has them.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache, partial
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from isocore.carried import CarriedField, CellSources, distinct_names
from isocore.errors import OptionError
from isocore.readers.vtk_centres import SplitFaces, split_at_centres
from isocore.readers.vtk_division import Divided, divided
from isocore.readers.vtk_fields import BOOKKEEPING, FieldInfo, offer
from isocore.readers.vtk_joining import Joining, joined_values
from isocore.readers.vtk_pieces import Part, used_points


def carried_fields(
    path: str, fields: Sequence[FieldInfo], field: FieldInfo, asked: Sequence[str], *, files: bool = False
) -> tuple[FieldInfo, ...]:
    """The fields of these names, each once; "all": every one but the contoured scalar and what VTK keeps for itself.

    files: a name that is no field's may be a file's, which is left out. Raises OptionError for any other.
    """
    found: dict[tuple[str, str], FieldInfo] = {}
    for name in asked:
        named = [one for one in fields if one.name == name]
        if not named and name == "all":
            several = [one for one in fields if one.name not in BOOKKEEPING and (one != field or one.components > 1)]
            found |= {(one.of, one.name): one for one in several}
        elif named:
            one = min(named, key=lambda info: info.of != "points")
            found[one.of, one.name] = one
        elif not (files and Path(name).is_file()):
            instead = " (a mesh carries fields of its own file)" if Path(name).is_file() else ""
            raise OptionError(f"{path}: has no field {name!r} to carry{instead}; {offer(fields)}")
    return tuple(found.values())


def joined_carried(part: Part, by: Joining) -> tuple[tuple[npt.NDArray[Any], ...], list[tuple[int, float]]]:
    """The carried fields with one row for each joined point; at how many points each differed, and by how much."""
    found, differing = [], []
    used = cache(partial(used_points, part))
    for rows, of_cells in zip(part.carried, part.of_cells, strict=True):
        each = [] if of_cells else [joined_values(by, np.ascontiguousarray(column), used) for column in rows.T]
        found.append(np.stack([one.values for one in each], axis=1) if each else rows)
        count = max((one.differing for one in each), default=0)
        differing.append((count, max((one.largest for one in each), default=0.0)))
    return tuple(found), differing


def discontinuities(fields: Sequence[FieldInfo], differing: Sequence[tuple[int, float]]) -> list[str]:
    """A warning for each carried field whose values differ where points were joined."""
    return [
        f"{field.name}, which is carried, is discontinuous: at {count:,} points the joined values differ, by up to "
        f"{largest:.3g}; their mean was taken, and --keep-duplicates leaves the cells apart"
        for field, (count, largest) in zip(fields, differing, strict=True)
        if count
    ]


def carried_by(
    path: str, part: Part, fields: Sequence[FieldInfo], shapes: Divided, centred: Sequence[SplitFaces]
) -> tuple[tuple[CarriedField, ...], tuple[CellSources, ...]]:
    """The fields as the finished mesh carries them; the cells as the file has them, where a field is theirs."""
    found = []
    for field, rows in zip(fields, part.carried, strict=True):
        if field.of == "points":
            rows = np.stack([_everywhere(path, part, column, shapes) for column in rows.T], axis=1)
        values = rows[:, 0] if field.components == 1 else rows
        found.append(CarriedField(field.name, np.ascontiguousarray(values), field.of))
    of_cells = any(field.of == "cells" for field in fields)
    return distinct_names(found), _sources(part, shapes, centred) if of_cells else ()


def _everywhere(path: str, part: Part, column: npt.NDArray[Any], shapes: Divided) -> npt.NDArray[Any]:
    """(n,) values of all points of the finished mesh, given those of the file's."""
    column = np.ascontiguousarray(column)
    if shapes.curved or len(shapes.points) > len(column):
        shapes = divided(path, shapes.blocks, part.points, column, part.weights)
        column = shapes.values
    centres = [split_at_centres(path, faces, shapes.points, column, 0).values for faces in part.faces]
    return np.concatenate([column, *centres])


def _sources(part: Part, shapes: Divided, centred: Sequence[SplitFaces]) -> tuple[CellSources, ...]:
    found = [CellSources(nodes, _listed(numbers), pairs) for nodes, numbers, pairs in shapes.sources]
    first = len(shapes.points)
    for split, cells in zip(centred, part.ragged, strict=True):
        found.append(CellSources(split.tets, cells.numbers[split.tets[:, 0] - first]))
        first += len(split.centres)
    return tuple(found)


def _listed(numbers: npt.NDArray[np.intp] | slice) -> npt.NDArray[np.intp]:
    return np.arange(numbers.start, numbers.stop) if isinstance(numbers, slice) else numbers
