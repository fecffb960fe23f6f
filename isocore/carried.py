"""Fields that a volume or a mesh carries besides the one that is contoured: its surfaces get their values."""

from __future__ import annotations

from collections.abc import Collection, Iterable
from dataclasses import dataclass, replace
from typing import Any, Literal, NamedTuple

import numpy as np
import numpy.typing as npt

from isocore.errors import FieldError, OptionError, printable


@dataclass(frozen=True, slots=True, eq=False)
class CarriedField:
    """values: (n,) or (n, k) real numbers of any type, of n points or cells as the field that carries them has them.

    A volume's points are its samples, i fastest. of: "points"; "cells", which of a volume are the boxes between eight
    samples; "corners", of a volume whose samples lie in the middles of cells: the points around these.
    slope, intercept: value = slope * stored + intercept.
    """

    name: str
    values: npt.NDArray[Any]
    of: Literal["points", "cells", "corners"] = "points"
    slope: float = 1.0
    intercept: float = 0.0

    def __post_init__(self) -> None:
        if self.values.ndim not in (1, 2) or self.values.dtype.kind not in "biuf":
            raise FieldError(f"{self.name}: carried values must be (n,) or (n, k) real numbers")
        view = self.values.view()
        view.flags.writeable = False
        object.__setattr__(self, "values", view)
        object.__setattr__(self, "name", printable(self.name))

    @property
    def components(self) -> int:
        """1 for a scalar, else k."""
        return 1 if self.values.ndim == 1 else self.values.shape[1]

    @property
    def interpolated_type(self) -> type[np.float32] | type[np.float64]:
        """float32 where that holds every stored number, else float64."""
        return np.float32 if np.result_type(self.values.dtype, np.float32) == np.float32 else np.float64

    def check(self, sizes: dict[str, int]) -> None:
        """Raises FieldError where there are not as many values as places. sizes: how many there are, by `of`."""
        if len(self.values) != sizes.get(self.of, -1):
            raise FieldError(
                f"{self.name}: holds {len(self.values):,} values for {sizes.get(self.of, 0):,} {self.of}; "
                "a carried field needs one for each"
            )


class CellSources(NamedTuple):
    """Cells as the file has them, so that a vertex of a surface finds the value of its cell.

    nodes: (m, k) int32, points of the mesh that belong to each cell, those that dividing it added too.
    numbers: (m,) which row of the carried cell fields is its value. pairs: (e, 2) which two of a cell's nodes an edge
    may join; None: any.
    """

    nodes: npt.NDArray[np.int32]
    numbers: npt.NDArray[np.intp]
    pairs: npt.NDArray[np.intp] | None = None


def distinct_names(fields: Iterable[CarriedField], taken: Collection[str] = ()) -> tuple[CarriedField, ...]:
    """The fields, each with a name of its own: later ones of one name get a number behind it."""
    known, found = set(taken), []
    for field in fields:
        name, number = field.name, 1
        while name in known:
            number += 1
            name = f"{field.name}_{number}"
        known.add(name)
        found.append(field if name == field.name else replace(field, name=name))
    return tuple(found)


def chosen(carried: tuple[CarriedField, ...], names: Iterable[str]) -> tuple[CarriedField, ...]:
    """Those of these names, "all" of them too. Raises OptionError for a name that is not there."""
    found: dict[str, CarriedField] = {}
    for name in names:
        several = carried if name == "all" else tuple(field for field in carried if field.name == name)
        if not several and name != "all":
            have = ", ".join(field.name for field in carried) or "none"
            raise OptionError(f"carry: there is no field {name!r}; the field that is contoured carries {have}")
        found |= {field.name: field for field in several}
    return tuple(found.values())
