"""A volume: samples on a grid, and where that grid lies in the world.

The conventions of the whole program stand here and nowhere else:

* Index (i, j, k), i fastest in memory. Nothing is transposed.
* Inside means ``sample >= isovalue``, on the scaled value ``slope * stored + intercept``. A non-finite
  sample is outside.
* Samples stay in the file's type; slope and intercept move the isovalue instead (`stored_isovalue`).
* Triangles turn counter-clockwise seen from outside; outside is the lower side.
* A crossed grid edge carries one vertex, at least 2^-10 of the edge away from both ends.
* Voxel centres are the samples: index (0, 0, 0) is the centre of the first voxel.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal, cast, get_args

import numpy as np
import numpy.typing as npt

from isocore.arrays import samples_of
from isocore.carried import CarriedField
from isocore.digits import exact
from isocore.errors import FieldError, OptionError, printable

Space = Literal["ras", "lps", "las", "index", "native"]

#: Signs that take RAS coordinates to each space with named axes.
_SIGNS: dict[str, tuple[int, int, int]] = {"ras": (1, 1, 1), "lps": (-1, -1, 1), "las": (-1, 1, 1)}

#: The sample types the kernels read as stored; every other type is converted by its reader.
SAMPLE_TYPES = ("uint8", "int8", "uint16", "int16", "uint32", "int32", "float32", "float64")


#: How many more values along each axis than samples a carried field has.
_GRIDS = {"points": 0, "cells": -1, "corners": 1}

#: A volume is a product of three lengths, and has to be a number.
FARTHEST = 1e100


@dataclass(frozen=True, slots=True, eq=False)
class Volume:
    """Samples on a grid, and where that grid lies.

    samples: (nx, ny, nz), one of SAMPLE_TYPES, native byte order, Fortran order (i fastest).
    slope, intercept: value = slope * stored + intercept; slope is finite and not zero.
    affine: (4, 4) float64, index (i, j, k, 1) to world.
    space: what world means: "ras", "lps", "las", or "native" where the file does not say.
    unit: of the world, "mm", or "" where the file does not say.
    warnings: what the reader wants its user to know.
    ignored: how many samples are NaN because they were named as such.
    field_name: of the samples, in a file that names its fields.
    carried: further fields on this grid, which surfaces get the values of.
    """

    samples: npt.NDArray[Any]
    slope: float = 1.0
    intercept: float = 0.0
    affine: npt.NDArray[np.float64] = None  # type: ignore[assignment]  # replaced by the identity below
    space: Space = "native"
    unit: str = ""
    warnings: tuple[str, ...] = ()
    ignored: int = 0
    field_name: str = ""
    carried: tuple[CarriedField, ...] = ()

    @classmethod
    def from_array(
        cls,
        samples: npt.ArrayLike,
        *,
        spacing: float | Sequence[float] | None = None,
        origin: Sequence[float] | None = None,
        affine: npt.ArrayLike | None = None,
        space: str = "native",
        unit: str = "",
    ) -> Volume:
        """A volume of an array indexed [i, j, k] = [x, y, z]; of one indexed [z, y, x] pass `array.T`.

        samples: (nx, ny, nz), real numbers or bool of any width, order and byte order. In Fortran order (which a
            transposed C array has) and one of SAMPLE_TYPES or bool they are not copied: the volume sees the array's
            memory, which stays writeable for others. Else it holds a copy, int64 as int32 where it fits. What a
            masked array masks is outside, as NaN is.
        spacing: world units between samples, one number or one per axis; 1 by default.
        origin: world coordinates (x, y, z) of the centre of sample [0, 0, 0]; 0 by default.
        affine: (4, 4), index to world, in place of both.
        space: what world means: ras, lps, las, index or native, in any case; unit: of the world, such as mm.

        Raises FieldError for samples that cannot be contoured, OptionError for a place that makes no sense; the
        message begins with the argument's name.
        """
        known = space.lower()
        if known not in get_args(Space):
            raise OptionError(f"space: {space!r} is none of {', '.join(get_args(Space))}")
        if not unit.isprintable():
            raise OptionError(f"unit: {unit!r} is no unit; pass mm or another word")
        if affine is not None and (spacing is not None or origin is not None):
            raise OptionError("affine: holds spacing and origin already; pass it alone")
        taken, warnings = samples_of(samples)
        place = _placed(spacing, origin) if affine is None else _matrix(affine)
        return cls(taken, affine=place, space=cast(Space, known), unit=unit, warnings=warnings)

    def __repr__(self) -> str:
        """Its size and type, and where it lies."""
        steps = f"{' x '.join(f'{step:.6g}' for step in self.spacing)} {self.unit}".rstrip()
        scale = "" if (self.slope, self.intercept) == (1, 0) else f", x {self.slope:g} + {self.intercept:g}"
        return f"Volume({_times(self.shape)} {self.samples.dtype}{scale}, {steps}, {self.space})"

    def __post_init__(self) -> None:
        samples = self.samples
        if samples.ndim != 3:
            raise FieldError(f"a volume needs three axes, this one has {samples.ndim}")
        if min(samples.shape) < 2:
            raise FieldError(f"a volume needs two samples per axis, this one has {_times(samples.shape)}")
        if samples.dtype.name not in SAMPLE_TYPES or not samples.dtype.isnative:
            known = ", ".join(SAMPLE_TYPES)
            raise FieldError(f"samples of type {samples.dtype} cannot be contoured; use one of {known}")
        if not samples.flags.f_contiguous:
            raise FieldError("samples must be in Fortran order (i fastest)")
        if not (math.isfinite(self.slope) and math.isfinite(self.intercept) and self.slope != 0):
            scale = f"slope {exact(self.slope)} and intercept {exact(self.intercept)}"
            raise FieldError(f"{scale} do not scale the samples")
        affine = np.eye(4) if self.affine is None else np.array(self.affine, dtype=np.float64)
        if affine.shape != (4, 4) or not np.isfinite(affine).all():
            raise FieldError("the affine must be a finite 4x4 matrix")
        if np.abs(affine).max() > FARTHEST:
            raise FieldError(f"the affine is too large to reckon with: places lie beyond {FARTHEST:g}")
        with np.errstate(all="ignore"):  # of numbers so small that they are none
            voxel = abs(np.linalg.det(affine[:3, :3]))
        if not voxel >= 1e-30:
            raise FieldError("the affine is singular: an axis has no length or two axes coincide")
        sizes = {of: math.prod(n + more for n in samples.shape) for of, more in _GRIDS.items()}
        for field in self.carried:
            field.check(sizes)
        affine.flags.writeable = False
        samples.flags.writeable = False
        object.__setattr__(self, "affine", affine)
        object.__setattr__(self, "warnings", tuple(map(printable, self.warnings)))

    @property
    def shape(self) -> tuple[int, int, int]:
        """Samples per axis (nx, ny, nz)."""
        nx, ny, nz = self.samples.shape
        return nx, ny, nz

    @property
    def spacing(self) -> tuple[float, float, float]:
        """Length of one index step along each axis, in world units."""
        x, y, z = (math.hypot(*column) for column in self.affine[:3, :3].T.tolist())
        return x, y, z

    def in_space(self, space: Space) -> Volume:
        """This volume with its world measured in `space`; "native" leaves it as it is, "index" forgets the affine."""
        if space in ("native", self.space):
            return self
        if space == "index":
            return replace(self, affine=np.eye(4), space="index", unit="")
        if self.space not in _SIGNS:
            raise FieldError(f"does not say which way its axes point, so not {space} either; use --space native")
        affine = self.affine.copy()
        for row, (there, here) in enumerate(zip(_SIGNS[space], _SIGNS[self.space], strict=True)):
            affine[row] *= there * here
        return replace(self, affine=affine, space=space)

    @property
    def inside_is_below(self) -> bool:
        """True where a negative slope makes a low stored sample a high value."""
        return self.slope < 0

    def stored_isovalue(self, isovalue: float) -> float:
        """The isovalue in the samples' stored scale.

        A stored integer whose scaled value is the isovalue exactly is returned exactly, so that rounding in the
        division cannot move a sample to the other side.
        """
        stored = (isovalue - self.intercept) / self.slope
        nearest = float(round(stored)) if math.isfinite(stored) else stored
        if self.slope * nearest + self.intercept == isovalue:
            return nearest
        return stored

    def scaled(self, stored: float) -> float:
        """A stored sample's value."""
        return self.slope * stored + self.intercept


def to_ras(space: Space) -> npt.NDArray[np.float64] | None:
    """What takes coordinates of `space` to RAS, (4, 4); None where they are in RAS, or nobody knows."""
    return None if space == "ras" or space not in _SIGNS else np.diag([*_SIGNS[space], 1.0])


def _placed(spacing: float | Sequence[float] | None, origin: Sequence[float] | None) -> npt.NDArray[np.float64]:
    """The affine of these steps and this place. Raises OptionError for what are none."""
    affine = np.eye(4)
    for name, given, default in (("spacing", spacing, 1.0), ("origin", origin, 0.0)):
        try:
            numbers = np.asarray((default,) * 3 if given is None else given, dtype=np.float64)
            numbers = np.broadcast_to(numbers, (3,)) if name == "spacing" else numbers.reshape(3)
        except (TypeError, ValueError):
            numbers = np.full(3, np.nan)
        if not np.isfinite(numbers).all() or (name == "spacing" and not (numbers > 0).all()):
            kind = "above 0, or one for all axes" if name == "spacing" else "x, y and z"
            raise OptionError(f"{name}: {given!r} are not three numbers {kind}")
        affine[(range(3), range(3)) if name == "spacing" else (range(3), 3)] = numbers
    return affine


def _matrix(affine: npt.ArrayLike) -> npt.NDArray[np.float64]:
    try:
        matrix = np.array(affine, dtype=np.float64)
    except (TypeError, ValueError):
        matrix = np.empty(0)
    if matrix.shape != (4, 4):
        raise OptionError("affine: needs four rows of four numbers, which take index (i, j, k, 1) to the world")
    return matrix


def _times(shape: tuple[int, ...]) -> str:
    return "x".join(str(n) for n in shape)
