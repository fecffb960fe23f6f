"""Choose the field of a VTK mesh that is contoured, and make one number per point of it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal, Protocol

import numpy as np
import numpy.typing as npt

from isocore.errors import FieldError, OptionError

#: What VTK's own filters leave behind to find their way; chosen by name only.
BOOKKEEPING = (
    "vtkGhostType", "vtkGhostLevels", "avtGhostZones", "vtkOriginalPointIds", "vtkOriginalCellIds",
    "vtkValidPointMask", "HigherOrderDegrees", "RationalWeights",
)  # fmt: skip
_EXACT_IN_FLOAT32 = 1 << 24


class FieldChoice(Protocol):
    """The reading options that matter here."""

    @property
    def field(self) -> str | None: ...
    @property
    def component(self) -> int | str | None: ...


@dataclass(frozen=True, slots=True)
class FieldInfo:
    """A field a file offers. of: "points" or "cells"."""

    name: str
    components: int
    of: Literal["points", "cells"]
    type: str

    def __str__(self) -> str:
        return self.name if self.components == 1 else f"{self.name} ({self.components} components)"


def choose(path: str, fields: Sequence[FieldInfo], options: FieldChoice) -> FieldInfo:
    """The field to read: the one asked for, else the only one there is."""
    if options.field is not None:
        chosen = [field for field in fields if field.name == options.field]
        if not chosen:
            raise OptionError(f"{path}: has no field {options.field!r}; {offer(fields)}")
        field = min(chosen, key=lambda found: found.of != "points")
    else:
        useful = [field for field in fields if field.name not in BOOKKEEPING]
        candidates = [f for f in useful if f.of == "points"] or useful
        if not candidates:
            raise FieldError(f"{path}: holds no point or cell field, so there is nothing to contour; add one")
        if len(candidates) > 1:
            others = [field.name for field in useful if field.of != candidates[0].of]
            more = f" and {len(others)} of cells ({', '.join(others)})" if others else ""
            raise OptionError(
                f"{path}: holds {len(candidates)} {candidates[0].of[:-1]} fields"
                f" ({', '.join(f.name for f in candidates)}){more}; choose one with --field"
            )
        field = candidates[0]
    return field


def offer(fields: Sequence[FieldInfo]) -> str:
    """What a file holds, for a message."""
    of_points = [f.name for f in fields if f.of == "points"]
    of_cells = [f.name for f in fields if f.of == "cells"]
    offers = [
        f"{kind}: {', '.join(names)}" for kind, names in (("points", of_points), ("cells", of_cells)) if names
    ]
    return f"it holds for {'; for '.join(offers)}" if offers else "it holds none"


def component_of(path: str, field: FieldInfo, asked: int | str | None) -> int | None:
    """Which component of `field` is meant; None is their magnitude."""
    last = field.components - 1
    if last == 0:
        if asked in (None, 0, "0"):
            return 0
        raise OptionError(f"{path}: field {field.name!r} has one component; leave out --component")
    if asked is None:
        raise OptionError(
            f"{path}: field {field.name!r} has {field.components} components;"
            f" choose --component 0 to {last}, or magnitude"
        )
    if asked == "magnitude":
        return None
    if str(asked) in map(str, range(last + 1)):
        return int(asked)
    raise OptionError(f"{path}: field {field.name!r} has no component {asked}; use 0 to {last}, or magnitude")


def scalar(values: npt.NDArray[Any], components: int, component: int | None) -> npt.NDArray[Any]:
    """One float32 or float64 per tuple of the flat `values`, which may lie in their memory.

    Integers become float32 where that holds each of them exactly, float64 otherwise.
    """
    tuples = values.reshape(-1, components)
    single = values.dtype.kind == "f" and values.dtype.itemsize == 4
    if component is None:
        return magnitudes(tuples, np.float32 if single else np.float64)
    column = tuples[:, component]
    if column.dtype.kind == "f":
        return np.require(column, column.dtype.newbyteorder("="), ("C", "A"))
    largest = max(int(column.max()), -int(column.min())) if len(column) else 0
    return column.astype(np.float32 if largest <= _EXACT_IN_FLOAT32 else np.float64)


def columns(values: npt.NDArray[Any], field: FieldInfo) -> npt.NDArray[Any]:
    """(n, k) of a file's flat values, native; those of points as floating point, since joining may average them."""
    if field.of == "cells":
        return values.reshape(-1, field.components).astype(values.dtype.newbyteorder("="))
    return np.stack([scalar(values, field.components, n) for n in range(field.components)], axis=1)


def magnitudes(tuples: npt.NDArray[Any], dtype: npt.DTypeLike) -> npt.NDArray[Any]:
    """(n,) the lengths of (n, k) vectors; infinite where `dtype` has no such number."""
    with np.errstate(over="ignore", under="ignore", invalid="ignore"):
        lengths = np.sqrt((tuples.astype(np.float64) ** 2).sum(axis=1))
        huge = np.flatnonzero(np.isinf(lengths))  # or their squares are
        if len(huge):
            lengths[huge] = np.hypot.reduce(tuples[huge].astype(np.float64), axis=1)
        return np.asarray(lengths, dtype)


def averaged(
    cell_values: npt.NDArray[Any],
    columns: Sequence[tuple[npt.NDArray[np.int32], npt.NDArray[Any]]],
    points: int,
) -> npt.NDArray[Any]:
    """Per point the mean of its cells; the mean of all cells where a point has none.

    cell_values: (c,) float. columns: points of some cells, one each, and the values of these cells.
    """
    total, count = np.zeros(points), np.zeros(points, np.int64)
    for column, values in columns:
        total += np.bincount(column, weights=values, minlength=points)
        count += np.bincount(column, minlength=points)
    lonely = count == 0
    total[lonely] = cell_values.mean() if len(cell_values) else 0.0
    count[lonely] = 1
    return np.asarray(total / count, cell_values.dtype)
