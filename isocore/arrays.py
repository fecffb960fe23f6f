"""Arrays as people and files hold them, brought into a form that kernels read, in as few bits as hold them."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from isocore.errors import FieldError

#: Types that convert below; all others of numpy's are kept or refused.
_NARROWED = ("int64", "uint64", "float16")
_WIDE = 2**53


def samples_of(array: npt.ArrayLike) -> tuple[npt.NDArray[Any], tuple[str, ...]]:
    """A view or a copy of `array` as a volume's samples: Fortran order, native bytes, a type that kernels read.

    A view shares the array's memory, which stays as writeable as it is. Second: what was lost on the way.
    Raises FieldError, whose message begins with "samples", for what are no numbers on a line.
    """
    given = np.asanyarray(array)
    if given.ndim != 3:
        advice = "; pass one of its volumes, as samples[..., 0]" if given.ndim > 3 else ""
        raise FieldError(f"samples: need three axes, not {given.ndim}{advice}")
    if given.dtype.kind not in "biuf":
        raise FieldError(f"samples: are of type {given.dtype}, which has no isosurface; pass real numbers")
    if isinstance(given, np.ma.MaskedArray):
        given = _unmasked(given)
    samples = np.asarray(given)
    if samples.dtype.kind == "b":
        samples = samples.view(np.uint8)
    if samples.dtype.itemsize > 8:
        samples = samples.astype(np.float64, order="F")
    native = samples.astype(samples.dtype.newbyteorder("="), order="F", copy=False)
    narrow, warnings = contourable(native)
    return narrow.view(), warnings


def _unmasked(array: np.ma.MaskedArray[Any, Any]) -> npt.NDArray[Any]:
    """What is masked is outside, as NaN is; whole numbers become floats for it."""
    if not np.ma.is_masked(array):
        return np.asarray(array.data)
    small = array.dtype.itemsize <= (4 if array.dtype.kind == "f" else 2)
    return np.asarray(np.ma.filled(array.astype(np.float32 if small else np.float64), np.nan))


def contourable(samples: npt.NDArray[Any]) -> tuple[npt.NDArray[Any], tuple[str, ...]]:
    """samples in a type that kernels read, and what was lost on the way."""
    name = samples.dtype.name
    if name not in _NARROWED:
        return samples, ()
    if name == "float16":
        return samples.astype(np.float32, order="F"), ()
    if not samples.size:
        return samples.astype(np.int32, order="F"), ()
    lowest, highest = int(samples.min()), int(samples.max())
    for narrow in (np.int32, np.uint32):
        bounds = np.iinfo(narrow)
        if bounds.min <= lowest and highest <= bounds.max:
            return samples.astype(narrow, order="F"), ()
    exact = max(-lowest, highest) <= _WIDE
    loss = "every one is kept exactly" if exact else "beyond 2^53 they are rounded; isovalues there are not exact"
    warning = f"{name} samples from {lowest:,} to {highest:,} are contoured as float64: {loss}"
    return samples.astype(np.float64, order="F"), (warning,)
