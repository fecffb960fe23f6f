"""From the arrays of VTK's unstructured grid to a CellMesh, whatever file they come from.

The arrays are those of VTK's data model: points, cells as types, offsets and connectivity, and one field. Ghosts are
left out first, then points that coincide are joined, then cells are split.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
import numpy.typing as npt

from isocore.cell_mesh import CellMesh, Connectivity
from isocore.digits import exact
from isocore.errors import FieldError
from isocore.readers.cell_splitting import SplitCells, split_cells
from isocore.readers.ignored import values_without_ignored
from isocore.readers.options import MeshOptions
from isocore.readers.vtk_carried import carried_by, discontinuities, joined_carried
from isocore.readers.vtk_cells import by_corners
from isocore.readers.vtk_centres import SplitFaces, split_at_centres
from isocore.readers.vtk_division import Divided, divided
from isocore.readers.vtk_fields import FieldInfo, averaged
from isocore.readers.vtk_joining import Joining, joined_values, joining, repeated
from isocore.readers.vtk_pieces import Part, PieceData, checked, renumbered, together, used_points
from isocore.readers.vtk_types import CORNERS
from isocore.readers.vtk_warnings import cell_warnings, corner_warnings, joining_warnings, named, splitting_warnings


def assembled(
    path: str,
    pieces: Iterable[PieceData],
    field: FieldInfo,
    component: int | None,
    options: MeshOptions = MeshOptions(),  # noqa: B008
    ignore: tuple[float, ...] = (),
    carried: Sequence[FieldInfo] = (),
) -> CellMesh:
    """One mesh of all pieces, with one value per point; component None is the magnitude of `field`.

    ignore: values that become NaN before anything is averaged. carried: the fields that each piece has besides.

    Raises InputError where the arrays contradict each other, FieldError where they cannot be contoured; each
    message starts with `path`.
    """
    parts = [checked(path, piece, field, component, carried) for piece in pieces]
    before = sum(_not_finite(part.values) for part in parts)
    kept, missing = values_without_ignored([part.values for part in parts], ignore)
    parts = [replace(part, values=values) for part, values in zip(parts, kept, strict=True)]
    counts = sum((Counter(part.counts) for part in parts), Counter[int]())
    ghosts = sum(part.ghosts for part in parts)
    warnings = cell_warnings(path, counts, ghosts)
    whole, found, differing = _hung_together(together(path, parts), field, options, (ghosts, len(parts)))
    blocks = [by_corners(block) for block in whole.blocks] if options.corners else whole.blocks
    shapes = divided(path, blocks, whole.points, whole.values, whole.weights)
    points, values, split, centred = _split(path, whole, shapes)
    turned = sum(each.turned for each in centred), next((each.first for each in centred if each.turned), -1)
    warnings += corner_warnings(whole.blocks, shapes.left, options.corners)
    warnings += splitting_warnings(counts, split, turned)
    if not len(split.tets) and not len(split.hexes):
        raise FieldError(f"{path}: each of its {split.collapsed:,} cells is collapsed to nothing; write it again")
    found = replace(found, divided_cells=sum(len(cells.nodes) for cells in shapes.curved))
    warnings += joining_warnings(found, field, options.merge_points)
    warnings += discontinuities(carried, differing)
    fields, sources = carried_by(path, whole, carried, shapes, centred)
    if len(parts) > 1 and options.keep_duplicates:
        warnings.append(f"the points of {len(parts)} pieces were not joined: the surface has seams there")
    if field.of == "cells":
        warnings.append(f"{field.name} is a cell field; each point got the mean of its cells, which blurs it")
    warnings += [f"no value of {field.name} is {exact(value)}, which --ignore names" for value in missing]
    infinite = _not_finite(values)
    ignored = max(0, infinite - before) if ignore else 0
    infinite -= ignored
    if infinite:
        warnings.append(f"{infinite:,} of {values.size:,} values of {field.name} are not finite and outside")
    return CellMesh(
        points,
        split.tets,
        split.hexes,
        values,
        field_name=field.name,
        cell_counts=named(counts),
        warnings=tuple(warnings),
        connectivity=found,
        curved=tuple(shapes.curved),
        ignored=ignored,
        carried=fields,
        sources=sources,
    )


def _not_finite(values: npt.NDArray[Any]) -> int:
    return values.size - int(np.count_nonzero(np.isfinite(values)))


def _hung_together(
    part: Part, field: FieldInfo, options: MeshOptions, counts: tuple[int, int]
) -> tuple[Part, Connectivity, list[tuple[int, float]]]:
    """Points that coincide are joined, and each has one value; of carried fields how many differed there, how much.

    counts: ghosts, and pieces, which may share cells.
    """
    of_cells = field.of == "cells"
    by = None if options.keep_duplicates else joining(part.points, options.merge_points or 0.0)
    joined, differing, largest, twice = 0, 0, 0.0, 0
    apart = [(0, 0.0)] * len(part.carried)
    if by is not None:
        joined = by.joined
        values = part.values
        if not of_cells:
            found = joined_values(by, part.values, partial(used_points, part))
            values, differing, largest = found.values, found.differing, found.largest
        weights = None if part.weights is None else part.weights[by.first]
        carried, apart = joined_carried(part, by)
        part = replace(renumbered(part, by.number), points=part.points[by.first], values=values, weights=weights)
        part = replace(part, carried=carried)
        if counts[1] > 1:
            part, twice = _once(part, by)
    if of_cells:
        part = replace(part, values=_at_points(part))
    part = replace(part, points=_own(part.points), values=_own(part.values))
    hung = Connectivity(
        ghost_cells=counts[0],
        repeated_cells=twice,
        joined_points=joined,
        averaged_points=differing,
        largest_difference=largest,
    )
    return part, hung, apart


def _own(array: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """In memory of its own, without the file that it was read from."""
    return array if array.flags.owndata else array.copy()


def _once(part: Part, by: Joining) -> tuple[Part, int]:
    """Without the cells that an earlier piece has too, and how many there were."""
    masks = repeated(part.blocks, by)
    count = sum(int(np.count_nonzero(mask)) for mask in masks)
    if not count:
        return part, 0
    blocks = []
    for block, mask in zip(part.blocks, masks, strict=True):
        numbers = block.numbers
        if isinstance(numbers, slice):
            numbers = np.arange(numbers.start, numbers.stop)
        blocks.append(replace(block, cells=block.cells[~mask], numbers=numbers[~mask]))
    return replace(part, blocks=blocks), count


def _at_points(part: Part) -> npt.NDArray[Any]:
    """(n,) values of the cells, averaged."""
    columns = [
        (column, part.values[block.numbers]) for block in part.blocks for column in block.cells.T
    ]
    columns += [(one.corners, np.repeat(part.values[one.numbers], one.counts)) for one in part.ragged]
    return averaged(part.values, columns, len(part.points))


def _split(
    path: str, part: Part, shapes: Divided
) -> tuple[npt.NDArray[np.float64], npt.NDArray[Any], SplitCells, list[SplitFaces]]:
    """Points, values, and cells as tetrahedra and hexahedra; what became of those that are split at their centre."""
    centred: list[SplitFaces] = []
    count = len(shapes.points)
    for faces in part.faces:
        centred.append(split_at_centres(path, faces, shapes.points, shapes.values, count))
        count += len(faces.counts)
    if count > np.iinfo(np.int32).max:
        raise FieldError(f"{path}: holds more than 2,147,483,647 points; cut it into several files")
    tets, hexes, wedges, pyramids = (
        _one([*shapes.cells[shape]] or [np.empty((0, corners), np.int32)]) for shape, corners in CORNERS.items()
    )
    tets = _one([tets, *(split.tets for split in centred)])
    quads = _one([np.empty((0, 4), np.int32), *(split.quads for split in centred)])
    return (
        _one([shapes.points, *(split.centres for split in centred)]),
        _one([shapes.values, *(split.values for split in centred)]),
        split_cells(tets, hexes, wedges, pyramids, quads),
        centred,
    )


def _one(arrays: list[npt.NDArray[Any]]) -> npt.NDArray[Any]:
    """The arrays behind each other; a single one as it is."""
    return arrays[0] if len(arrays) == 1 else np.concatenate(arrays)
