"""Where samples lie, in the file and in the world, and how they get into memory.

A file's axes are counted fastest first, as ours are, so samples go straight to their place: nothing is
transposed. At most one axis tells volumes (times, components) apart: the last, the first, or one between.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from isocore.errors import FieldError, OptionError
from isocore.readers.packed import Source
from isocore.volume import Space

#: Interleaved samples are taken apart in pieces of about this many bytes.
_PIECE = 1 << 20


class Layout(NamedTuple):
    """The samples of one file.

    shape: (nx, ny, nz) of each volume.
    dtype: as stored, with its byte order.
    volumes: how many there are.
    axis: which of the file's axes tells them apart, 0 to 3; 3 is one volume after the other.
    """

    shape: tuple[int, int, int]
    dtype: np.dtype[Any]
    volumes: int = 1
    axis: int = 3

    @property
    def volume_bytes(self) -> int:
        """Bytes of one volume."""
        return math.prod(self.shape) * self.dtype.itemsize

    def ends_with(self, volume: int) -> bool:
        """Whether nothing of the file is left once `volume` is read."""
        return self.axis < 3 or volume == self.volumes - 1

    @property
    def total_bytes(self) -> int:
        """Bytes of all volumes."""
        return self.volume_bytes * self.volumes


class Placement(NamedTuple):
    """affine: (4, 4) float64, index to world, in `unit`: "mm", or "" where the file does not say."""

    affine: npt.NDArray[np.float64]
    space: Space
    unit: str
    warnings: tuple[str, ...] = ()


def spatial(sizes: tuple[int, ...]) -> tuple[int, int, int]:
    """The sizes of three axes, or why they cannot be contoured."""
    if len(sizes) == 3 and min(sizes) >= 2:
        return sizes[0], sizes[1], sizes[2]
    held = "x".join(map(str, sizes))
    raise FieldError(f"holds {held} samples; a surface needs at least two along each of three axes")


def chosen(layout: Layout, volume: int | None) -> int:
    """The volume asked for, where the file has it."""
    held = layout.volumes
    if held == 0:
        raise FieldError("holds 0 volumes: an axis beyond space has no entries, so there is nothing to contour")
    if volume is None and held > 1:
        raise OptionError(f"holds {held} volumes (0 to {held - 1}); choose one with --volume, or --volume all")
    if volume is not None and not 0 <= volume < held:
        there = f"volumes 0 to {held - 1}" if held > 1 else "one volume, 0"
        raise OptionError(f"has no volume {volume}; it holds {there}")
    return volume or 0


def load(source: Source, layout: Layout, volume: int) -> npt.NDArray[Any]:
    """One volume's samples in Fortran order and native byte order, read into memory once."""
    samples = np.empty(layout.shape, layout.dtype, order="F")
    flat = samples.reshape(-1, order="F")
    inner = math.prod(layout.shape[: layout.axis])
    step_bytes = inner * layout.dtype.itemsize
    if layout.volumes == 1:
        source.fill(_bytes_of(flat))
    elif layout.axis < 3 and step_bytes * layout.volumes < _PIECE:
        _gather(source, layout, flat.reshape(-1, inner), volume)
    else:
        for run in flat.reshape(-1, inner):
            source.skip(step_bytes * volume)
            source.fill(_bytes_of(run))
            if layout.axis < 3:
                source.skip(step_bytes * (layout.volumes - 1 - volume))
    if not samples.dtype.isnative:
        samples = samples.byteswap(inplace=True).view(samples.dtype.newbyteorder("="))
    return samples


def _gather(source: Source, layout: Layout, runs: npt.NDArray[Any], volume: int) -> None:
    """Fill runs (r, inner) from r interleaved groups of `layout.volumes` runs each."""
    group = layout.volumes * runs.shape[1]
    groups = max(1, _PIECE // (group * runs.itemsize))
    piece = np.empty((min(groups, len(runs)), layout.volumes, runs.shape[1]), runs.dtype)
    for first in range(0, len(runs), groups):
        part = piece[: len(runs) - first]
        source.fill(_bytes_of(part.reshape(-1)))
        runs[first : first + groups] = part[:, volume]


def _bytes_of(flat: npt.NDArray[Any]) -> memoryview:
    return memoryview(flat.view(np.uint8))  # type: ignore[arg-type]  # numpy's stubs know no buffers
