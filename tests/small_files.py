"""Tiny inputs that tests write where they need them, without any of our own code."""

from __future__ import annotations

import gzip
import struct
from pathlib import Path

import numpy as np
import numpy.typing as npt


def ball(n: int = 12, *, radius: float = 4.0, dtype: str = "float32") -> npt.NDArray[np.generic]:
    """(n, n, n): 50 on a sphere in the middle, more inside, less outside."""
    axis = np.arange(n) - (n - 1) / 2
    distance = np.sqrt(axis[:, None, None] ** 2 + axis[None, :, None] ** 2 + axis[None, None, :] ** 2)
    return (50 + 10 * (radius - distance)).clip(0, 255).astype(dtype)


def write_nifti(path: Path, samples: npt.NDArray[np.generic], *, slope: float = 1.0, intercept: float = 0.0) -> Path:
    """A NIfTI-1 file of these samples, 1 mm apart, RAS; packed where the name ends in .gz."""
    codes = {"uint8": (2, 8), "int16": (4, 16), "int32": (8, 32), "float32": (16, 32), "float64": (64, 64)}
    code, bits = codes[samples.dtype.name]
    dims = (samples.ndim, *samples.shape, *(1,) * (7 - samples.ndim))
    header = bytearray(352)
    struct.pack_into("<i", header, 0, 348)
    struct.pack_into("<8h", header, 40, *dims)
    struct.pack_into("<2h", header, 70, code, bits)
    struct.pack_into("<8f", header, 76, 1, *(1.0,) * 7)
    struct.pack_into("<3f", header, 108, 352, slope, intercept)
    header[123] = 2
    struct.pack_into("<2h", header, 252, 0, 1)
    for row in range(3):
        struct.pack_into("<4f", header, 280 + 16 * row, *(1.0 if column == row else 0.0 for column in range(4)))
    header[344:348] = b"n+1\0"
    data = bytes(header) + samples.tobytes(order="F")
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(gzip.compress(data, mtime=0) if path.suffix == ".gz" else data)
    return path
