"""Samples that mean "nothing here", as `--ignore` names them, become NaN: outside whatever the isovalue, as NaN is.

Integers have no NaN. They become the narrowest floating-point type that holds every other sample exactly: float32 for
8 and 16 bits, and for 32 bits up to 2^24, else float64. Nothing is converted where no sample has such a value.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import numpy.typing as npt

from isocore.digits import exact
from isocore.volume import Volume

#: Whole numbers up to this one are exact in float32.
_WHOLE_IN_FLOAT32 = 2**24
#: An integer is meant by a scaled value that is as near to it as this, in steps of the integers.
_NEAR = 1e-3


def without_ignored(volume: Volume, ignore: Sequence[float]) -> Volume:
    """The volume with NaN in place of the scaled values in `ignore`; a warning for each that no sample has.

    The samples of a volume that was just read are changed in place where their type has NaN.
    """
    matches = [_Match(volume, value) for value in ignore]
    counts = [0] * len(matches)
    for slab in _slabs(volume.samples):
        for number, match in enumerate(matches):
            counts[number] += int(np.count_nonzero(match.where(slab)))
    warnings = tuple(
        f"no sample is {exact(match.value)}, which --ignore names; `isocore info` shows the range in full digits"
        for match, count in zip(matches, counts, strict=True)
        if not count
    )
    volume = replace(volume, warnings=volume.warnings + warnings)
    if not any(counts):
        return volume
    samples = _with_nan(volume.samples, matches)
    return replace(volume, samples=samples, ignored=sum(counts))


def values_without_ignored(
    pieces: Sequence[npt.NDArray[Any]], ignore: Sequence[float]
) -> tuple[list[npt.NDArray[Any]], list[float]]:
    """Values of a mesh's pieces, of floating point, with NaN in place of those in `ignore`; and those that none has."""
    found, missing = list(pieces), []
    for value in ignore:
        places = [values == _rounded(value, values.dtype) for values in pieces]
        if not any(place.any() for place in places):
            missing.append(value)
        pairs = zip(places, found, strict=True)
        found = [np.where(place, values.dtype.type(np.nan), values) for place, values in pairs]
    return found, missing


class _Match:
    """Finds the samples of one scaled value among those of a volume."""

    def __init__(self, volume: Volume, value: float) -> None:
        self.value = value
        self._slope, self._intercept = volume.slope, volume.intercept
        self._scaled = volume.samples.dtype.kind == "f" and (volume.slope, volume.intercept) != (1.0, 0.0)
        self._stored = self._stored_value(volume)

    def _stored_value(self, volume: Volume) -> np.generic | None:
        """The stored sample with this value, None for one that the type does not have."""
        kind = volume.samples.dtype
        stored = (self.value - volume.intercept) / volume.slope
        if kind.kind == "f":
            rounded = _rounded(stored, kind)
            return rounded if np.isfinite(rounded) else None
        ends = np.iinfo(kind)
        if not ends.min - _NEAR <= stored <= ends.max + _NEAR or abs(stored - round(stored)) > _NEAR:
            return None
        whole: np.generic = kind.type(round(stored))
        return whole

    def where(self, slab: npt.NDArray[Any]) -> npt.NDArray[np.bool_]:
        """Which samples have the value."""
        if self._stored is None:
            return np.zeros(slab.shape, np.bool_)
        found: npt.NDArray[np.bool_] = slab == self._stored
        if self._scaled:
            found |= self._slope * slab.astype(np.float64) + self._intercept == self.value
        return found


def _rounded(value: float, kind: np.dtype[Any]) -> np.generic:
    """The nearest number of the type."""
    with np.errstate(over="ignore"):
        rounded: np.generic = kind.type(value)
    return rounded


def _slabs(samples: npt.NDArray[Any]) -> list[npt.NDArray[Any]]:
    """Views of one layer each, so that no array of truth values is as long as the volume."""
    return [samples[:, :, layer] for layer in range(samples.shape[2])]


def _with_nan(samples: npt.NDArray[Any], matches: list[_Match]) -> npt.NDArray[Any]:
    """The samples with NaN where they match: the same array where that can be, else the narrowest type that will do."""
    if samples.dtype.kind == "f":
        target = samples if _made_writable(samples) else samples.copy(order="F")
        return _filled(target, samples, matches)
    if samples.dtype.itemsize < 4 or _fits_float32(samples, matches):
        return _filled(np.empty(samples.shape, np.float32, order="F"), samples, matches)
    return _filled(np.empty(samples.shape, np.float64, order="F"), samples, matches)


def _made_writable(samples: npt.NDArray[Any]) -> bool:
    try:
        samples.flags.writeable = True
    except ValueError:  # it lies in a file or in bytes
        return False
    return True


def _fits_float32(samples: npt.NDArray[Any], matches: list[_Match]) -> bool:
    """Whether all samples that are kept are whole numbers that float32 holds exactly."""
    for slab in _slabs(samples):
        large = (slab > _WHOLE_IN_FLOAT32) | (slab < -_WHOLE_IN_FLOAT32)
        for match in matches:
            large &= ~match.where(slab)
        if large.any():
            return False
    return True


def _filled(
    target: npt.NDArray[Any], samples: npt.NDArray[Any], matches: list[_Match]
) -> npt.NDArray[Any]:
    for into, slab in zip(_slabs(target), _slabs(samples), strict=True):
        found = np.logical_or.reduce([match.where(slab) for match in matches])
        if target is not samples:
            into[...] = slab
        into[found] = np.nan
    return target
