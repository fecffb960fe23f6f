"""The worlds our tests speak of: fields with known area, volume and topology, and the real data where it lies."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest

from isocore.volume import Volume

Floats = npt.NDArray[np.float64]

SHARED = Path(__file__).resolve().parent.parent.parent / "shared" / "data"
SAMPLES = Path(__file__).resolve().parent.parent / "sample_volumes"


@dataclass(frozen=True)
class Shape:
    """A volume whose surface at `isovalue` is known. `area`, `volume`: None where no closed form is at hand."""

    name: str
    volume: Volume
    isovalue: float
    euler: int
    components: int
    area: float | None = None
    enclosed: float | None = None


def volume_of(samples: npt.ArrayLike, **kwargs: object) -> Volume:
    """A Volume with these samples, copied into Fortran order."""
    return Volume(np.array(samples, order="F"), **kwargs)  # type: ignore[arg-type]  # the fields by name


def _sampled(function: Callable[..., Floats], n: int, half: float) -> Volume:
    step = 2 * half / (n - 1)
    axis = np.linspace(-half, half, n)
    x, y, z = np.meshgrid(axis, axis, axis, indexing="ij")
    affine = np.diag([step, step, step, 1.0])
    affine[:3, 3] = -half
    return volume_of(function(x, y, z).astype(np.float32), affine=affine)


def sphere(n: int = 24) -> Shape:
    """A ball of radius 1."""
    field = _sampled(lambda x, y, z: 1 - np.sqrt(x * x + y * y + z * z), n, 1.5)
    return Shape("sphere", field, 0.0, 2, 1, 4 * math.pi, 4 / 3 * math.pi)


def torus(n: int = 32) -> Shape:
    """A ring of radius 1 with a tube of radius 0.4."""
    field = _sampled(lambda x, y, z: 0.4 - np.hypot(np.hypot(x, y) - 1, z), n, 1.7)
    return Shape("torus", field, 0.0, 0, 1, 4 * math.pi**2 * 0.4, 2 * math.pi**2 * 0.16)


def two_spheres(n: int = 32) -> Shape:
    """Two balls of radius 0.5 that do not touch."""

    def field(x: Floats, y: Floats, z: Floats) -> Floats:
        return 0.5 - np.sqrt((np.abs(x) - 0.7) ** 2 + y * y + z * z)

    return Shape("two spheres", _sampled(field, n, 1.5), 0.0, 4, 2, 2 * math.pi, 2 * 4 / 3 * math.pi * 0.125)


def shell(n: int = 32) -> Shape:
    """The space between two balls of radii 0.5 and 1."""
    field = _sampled(lambda x, y, z: 0.25 - np.abs(np.sqrt(x * x + y * y + z * z) - 0.75), n, 1.5)
    return Shape("shell", field, 0.0, 4, 2, 4 * math.pi * 1.25, 4 / 3 * math.pi * 0.875)


def padded_shapes() -> list[Shape]:
    """Shapes that do not reach the border of their volume."""
    return [sphere(), torus(), two_spheres(), shell()]


def integer_noise(n: int, levels: int, seed: int = 0) -> Volume:
    """n^3 samples with values 0 .. levels - 1, so that every isovalue up to there is among the samples."""
    return volume_of(np.random.default_rng(seed).integers(0, levels, (n, n, n)).astype(np.uint8))


def shared(path: str) -> Path:
    """A file of the shared real data; skips the test where the data is not at hand."""
    found = SHARED / path
    if not found.exists():
        pytest.skip(f"the shared data set ({path}) lies beside the repository only on the project's own machines")
    return found
