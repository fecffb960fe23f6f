"""Samples of a type no kernel reads, brought into one that it does, in as few bits as hold them."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from isocore.arrays import contourable as contourable
from isocore.errors import FieldError


def from_float128(samples: npt.NDArray[np.void], order: str) -> tuple[npt.NDArray[np.float64], tuple[str, ...]]:
    """samples: 16 bytes each, IEEE binary128 or x87 extended, in byte order "<" or ">".

    x87 leaves its upper six bytes zero; a binary128 that has those zero is smaller than any scan's.
    """
    words = samples.reshape(-1, order="F").view(f"{order}u8").astype(np.uint64).reshape(-1, 2)
    low, high = words.T if order == "<" else words.T[::-1]
    if (high >> np.uint64(16)).any():
        head = high >> np.uint64(48)
        fraction = (high << np.uint64(16)) | (low >> np.uint64(48))
    else:
        head, fraction = high, low << np.uint64(1)
    exponent = (head & np.uint64(0x7FFF)).astype(np.int32)
    with np.errstate(over="ignore"):
        values = np.ldexp(1.0 + fraction.astype(np.float64) * 2.0**-64, exponent - 16383)
    values[exponent == 0] = 0.0
    values[(exponent == 0x7FFF) & (fraction != 0)] = np.nan
    values[(head >> np.uint64(15)) != 0] *= -1.0
    warning = "float128 samples are contoured as float64, which keeps 16 of their digits"
    return values.reshape(samples.shape, order="F"), (warning,)


def refuse(name: str, instead: str) -> FieldError:
    """An error for samples that are not numbers on a line."""
    return FieldError(f"samples are {name}, which have no isosurface; {instead}")
