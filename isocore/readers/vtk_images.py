"""From the arrays of VTK's images to a Volume: samples at points, or in the middles of cells."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from math import isfinite, prod
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from isocore.carried import CarriedField, distinct_names
from isocore.errors import FieldError, InputError
from isocore.readers.sample_types import contourable
from isocore.readers.vtk_fields import FieldInfo, magnitudes
from isocore.readers.vtk_ghosts import HIDDEN_CELL, HIDDEN_POINT
from isocore.readers.vtu_layout import Extent
from isocore.volume import Volume

#: Where carried values lie among the samples, by what they and the samples are of.
_PLACES: dict[tuple[str, str], Literal["points", "cells", "corners"]] = {
    ("points", "points"): "points",
    ("cells", "points"): "cells",
    ("cells", "cells"): "points",
    ("points", "cells"): "corners",
}


@dataclass(frozen=True, slots=True)
class Image:
    """extent: of all points. origin: where index (0, 0, 0) lies; spacing; direction: (3, 3), an axis in each column."""

    extent: Extent
    origin: tuple[float, ...] = (0.0, 0.0, 0.0)
    spacing: tuple[float, ...] = (1.0, 1.0, 1.0)
    direction: tuple[float, ...] = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)


@dataclass(frozen=True, slots=True)
class Samples:
    """A part of an image. values: flat, the components of each point or cell together, i fastest.

    marks: `vtkGhostType` of what the field is of, or None.
    """

    extent: Extent
    values: npt.NDArray[Any]
    marks: npt.NDArray[Any] | None = None


def sizes(extent: Extent, *, cells: bool) -> tuple[int, int, int]:
    """How many points, or cells, lie along each axis."""
    nx, ny, nz = (high - low + (not cells) for low, high in zip(extent[::2], extent[1::2], strict=True))
    return nx, ny, nz


def image_volume(
    path: str, image: Image, parts: Iterable[Samples], field: FieldInfo, component: int | None
) -> Volume:
    """The volume of one component of `field`, or of its magnitude where that is None.

    Raises InputError where parts leave gaps or numbers make no sense, FieldError where it has no surface.
    """
    cells = field.of == "cells"
    shape = sizes(image.extent, cells=cells)
    if min(shape) < 2:
        held = "x".join(map(str, shape))
        raise FieldError(f"{path}: holds {held} samples; a surface needs at least two along each of three axes")
    found = [_part(path, part, field, component) for part in parts]
    samples = _whole(path, image, found, shape, cells)
    samples, warnings = contourable(samples)
    if count := sum(int(np.count_nonzero(part.hidden)) for part in found):
        warnings += (f"{count:,} samples are marked as hidden; they count as outside, as NaN does",)
    return Volume(samples, affine=_affine(path, image, cells), warnings=warnings, field_name=field.name)


def with_fields(
    path: str, volume: Volume, image: Image, field: FieldInfo, carried: Iterable[tuple[FieldInfo, Iterable[Samples]]]
) -> Volume:
    """The volume of `field`, which carries these fields, each with all its parts. Raises as image_volume does."""
    found = []
    for info, parts in carried:
        several, cells = list(parts), info.of == "cells"
        shape = sizes(image.extent, cells=cells)
        columns = []
        for component in range(info.components):
            whole = _whole(path, image, [_part(path, part, info, component) for part in several], shape, cells)
            columns.append(whole.reshape(-1, order="F"))
        values = columns[0] if info.components == 1 else np.stack(columns, axis=1)
        found.append(CarriedField(info.name, values, _PLACES[info.of, field.of]))
    return replace(volume, carried=distinct_names(found)) if found else volume


@dataclass(frozen=True, slots=True)
class _Part:
    extent: Extent
    values: npt.NDArray[Any]
    hidden: npt.NDArray[np.bool_]


def _part(path: str, part: Samples, field: FieldInfo, component: int | None) -> _Part:
    """One value of each sample, native, NaN where it is hidden."""
    tuples = part.values.reshape(-1, field.components)
    values: npt.NDArray[Any]
    if component is None:
        values = magnitudes(tuples, np.float32 if part.values.dtype.itemsize == 4 else np.float64)
    else:
        values = np.ascontiguousarray(tuples[:, component])
    if not values.dtype.isnative:
        values = values.astype(values.dtype.newbyteorder("="))
    hidden = np.zeros(0, np.bool_)
    if part.marks is not None:
        if part.marks.dtype.kind not in "iu":
            raise InputError(f"{path}: array 'vtkGhostType' holds {part.marks.dtype.name} numbers, not bits")
        bit = HIDDEN_CELL if field.of == "cells" else HIDDEN_POINT
        hidden = (part.marks & part.marks.dtype.type(bit)) != 0
        if hidden.any():
            exact = values.dtype.kind == "f" or values.dtype.itemsize < 4
            values = values.astype(np.float32 if exact and values.dtype.itemsize < 8 else np.float64)
            values[hidden] = np.nan
    return _Part(part.extent, values, hidden)


def _whole(
    path: str, image: Image, parts: list[_Part], shape: tuple[int, int, int], cells: bool
) -> npt.NDArray[Any]:
    """(nx, ny, nz) of all parts, in Fortran order."""
    for part in parts:
        if len(part.values) != prod(sizes(part.extent, cells=cells)):
            raise InputError(f"{path}: a piece holds {len(part.values):,} samples, not as many as its extent says")
    if len(parts) == 1 and parts[0].extent == image.extent:
        values = parts[0].values
        own = values if values.flags.owndata and values.flags.writeable else values.copy()
        return own.reshape(shape, order="F")
    if sum(len(part.values) for part in parts) < prod(shape):
        raise InputError(f"{path}: its pieces leave samples out; write it again")
    samples = np.empty(shape, np.result_type(*(part.values.dtype for part in parts)), order="F")
    filled = np.zeros(shape, np.bool_, order="F")
    for part in parts:
        place = []
        for n, size in enumerate(sizes(part.extent, cells=cells)):
            first = part.extent[2 * n] - image.extent[2 * n]
            if first < 0 or first + size > shape[n]:
                raise InputError(f"{path}: a piece reaches beyond the whole extent; write it again")
            place.append(slice(first, first + size))
        where = tuple(place)
        samples[where] = part.values.reshape(sizes(part.extent, cells=cells), order="F")
        filled[where] = True
    if not filled.all():
        raise InputError(f"{path}: its pieces leave {np.count_nonzero(~filled):,} samples out; write it again")
    return samples


def _affine(path: str, image: Image, cells: bool) -> npt.NDArray[np.float64]:
    """Index to world. The first sample of a field of cells lies in the middle of the first cell."""
    numbers = (*image.origin, *image.spacing, *image.direction)
    if len(numbers) != 15 or not all(map(isfinite, numbers)) or 0 in image.spacing:
        raise InputError(f"{path}: its origin, spacing or direction makes no sense; write it again")
    affine = np.eye(4)
    with np.errstate(over="ignore", invalid="ignore"):
        affine[:3, :3] = np.reshape(image.direction, (3, 3)) * image.spacing
        first = np.array(image.extent[::2]) + (0.5 if cells else 0.0)
        affine[:3, 3] = np.array(image.origin) + affine[:3, :3] @ first
    if not np.isfinite(affine).all():
        raise InputError(f"{path}: its origin, spacing or direction is too large; write it again")
    return affine
