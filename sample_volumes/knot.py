"""The knot of Poston, Wong, Heng 1998, figure 1: for the sample, the tests and the bench."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt


def knot_field(samples_per_axis: int) -> npt.NDArray[np.float64]:
    """The field on [-5, 5)^3 before it is truncated to integers; the surface is at 200."""
    half = samples_per_axis / 2
    a = (np.arange(samples_per_axis) - half) / half * 5
    x, y, z = a[:, None, None], a[None, :, None], a[None, None, :]
    m = 1 + x * x + y * y + z * z
    p, q, w, s = 2 * x / m, 2 * y / m, 2 * z / m, (m - 2) / m
    k1 = p**2 - q**2 + w**3 - 3 * w * s**2
    k2 = 2 * p * q - 3 * w**2 * s + s**3
    return np.asarray(255 * (np.sin(np.pi * (k1**2 + k2**2) ** (1 / 6)) + 1) / 2)
