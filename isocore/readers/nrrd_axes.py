"""What a NRRD header says about its axes: how samples lie in the file, and where they lie in the world.

Follows "Definition of NRRD File Format" (Kindlmann, Teem project): per-axis fields, space and orientation.
"""

from __future__ import annotations

import io
import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from isocore.errors import FieldError, InputError
from isocore.readers.layout import Layout, Placement, spatial
from isocore.readers.nrrd_header import Head
from isocore.readers.sample_types import refuse
from isocore.volume import Space

_SPACES: dict[str, Space] = {
    "right-anterior-superior": "ras", "ras": "ras", "right-anterior-superior-time": "ras", "rast": "ras",
    "left-anterior-superior": "las", "las": "las", "left-anterior-superior-time": "las", "last": "las",
    "left-posterior-superior": "lps", "lps": "lps", "left-posterior-superior-time": "lps", "lpst": "lps",
}  # fmt: skip

_MM_PER_UNIT = {
    **dict.fromkeys(("mm", "millimeter", "millimeters", "millimetre", "millimetres"), 1.0),
    **dict.fromkeys(("cm", "centimeter", "centimeters"), 10.0),
    **dict.fromkeys(("m", "meter", "meters", "metre", "metres"), 1000.0),
    **dict.fromkeys(("um", "µm", "μm", "micron", "microns", "micrometer", "micrometers"), 0.001),
    **dict.fromkeys(("nm", "nanometer", "nanometers"), 1e-6),
}


#: Encodings whose samples are written as text, without a byte order.
TEXT_ENCODINGS = ("ascii", "text", "txt")

#: As many axes as any NRRD file may have (NRRD_DIM_MAX).
_MOST_AXES = 16

#: Kinds of axis along which samples lie in space; every other kind tells volumes apart.
_SPATIAL_KINDS = ("domain", "space", "???", "none")
_COLOURS = {
    "rgb-color": "RGB colours",
    "rgba-color": "RGBA colours",
    "hsv-color": "HSV colours",
    "xyz-color": "XYZ colours",
}
_UNCONTOURABLE = {**_COLOURS, "complex": "complex numbers", "quaternion": "quaternions"}


@dataclass(frozen=True, slots=True)
class Axes:
    """layout: of the samples. spatial: the three axes of the file that lie in space."""

    layout: Layout
    spatial: tuple[int, ...]


def axes_of(head: Head) -> Axes:
    """Which axes lie in space, which one tells volumes apart, and what is stored."""
    dimension, sizes = head.need("dimension"), tuple(head.need("sizes").tolist())
    if not 1 <= dimension <= _MOST_AXES:
        raise InputError(f"header counts {dimension:,} axes, where 1 to {_MOST_AXES} are possible; it is damaged")
    listed = " ".join(map(str, sizes[: _MOST_AXES + 1]))[:60]
    if len(sizes) != dimension or min(sizes, default=-1) < 0:
        raise InputError(f"header gives {dimension} axes the sizes {listed}; it is damaged")
    in_space = _in_space(head, sizes)
    shape = spatial(tuple(sizes[axis] for axis in in_space[:3]))
    others = [axis for axis in range(len(sizes)) if axis not in in_space[:3] and sizes[axis] != 1]
    if len(others) > 1:
        raise FieldError(f"has {len(others)} axes beyond space ({listed}); one can be chosen from, not more")
    before = sum(axis < others[0] for axis in in_space[:3]) if others else 3
    volumes = sizes[others[0]] if others else 1
    return Axes(Layout(shape, _sample_type(head), volumes=volumes, axis=before), tuple(in_space[:3]))


def _in_space(head: Head, sizes: tuple[int, ...]) -> list[int]:
    """The axes that nothing says to lie elsewhere; more than three where the header leaves it open."""
    kinds = [kind.lower() for kind in head.fields.get("kinds", ())] or ["???"] * len(sizes)
    directions = _directions(head) or [None] * len(sizes)
    if len(kinds) != len(sizes) or len(directions) != len(sizes):
        raise InputError(f"header describes more or fewer than its {len(sizes)} axes; it is damaged")
    for kind in kinds:
        if kind in _UNCONTOURABLE:
            raise refuse(_UNCONTOURABLE[kind], "convert them to numbers first")
    directed = any(direction is not None for direction in directions)
    in_space = [
        axis
        for axis, kind in enumerate(kinds)
        if kind in _SPATIAL_KINDS and not (directed and directions[axis] is None)
    ]
    while len(in_space) > 3 and 1 in (sizes[in_space[0]], sizes[in_space[-1]]):
        in_space.remove(in_space[-1] if sizes[in_space[-1]] == 1 else in_space[0])
    return in_space


def _directions(head: Head) -> list[list[float] | None]:
    """Each axis' vector; None where it has none, which pynrrd writes as NaN or as None. Empty without the field."""
    rows = head.fields.get("space directions", ())
    return [None if row is None or np.isnan(row).all() else row.tolist() for row in rows]


def _sample_type(head: Head) -> np.dtype[Any]:
    head.need("type")
    name, endian = head.word("type"), head.word("endian")
    if name == "block":
        raise refuse("blocks of bytes", "write them as numbers first")
    stored = _stored_type(name)
    if endian in ("little", "big"):
        return stored.newbyteorder("<" if endian == "little" else ">")
    if stored.itemsize > 1 and head.word("encoding") not in TEXT_ENCODINGS:
        raise InputError(f"header gives no byte order for its {name} samples; add endian: little or endian: big")
    return stored


def _stored_type(name: str) -> np.dtype[Any]:
    """pynrrd's type of that name. It has no public list of them, so a sample is read to see its type."""
    import nrrd

    one = {"type": name, "endian": "little", "encoding": "raw", "dimension": 1, "sizes": np.ones(1, np.intp)}
    try:
        stored: np.dtype[Any] = nrrd.read_data(one, io.BytesIO(bytes(8))).dtype
    except KeyError:
        raise InputError(
            f"header names the sample type {name[:20]!a}, which NRRD does not know; it is damaged"
        ) from None
    return stored


def placement(head: Head, axes: Axes) -> Placement:
    """Where the samples lie: by space directions, else spacings, else the axes' ends."""
    affine = np.eye(4)
    directions = _directions(head)
    stated = [directions[axis] for axis in axes.spatial] if directions else []
    if stated and None not in stated:
        for column, direction in enumerate(stated):
            affine[:3, column] = _three(direction, "space directions")
    else:
        steps, firsts = _steps(head, axes)
        affine[:3, :3], affine[:3, 3] = np.diag(steps), firsts
    if "space origin" in head.fields:
        affine[:3, 3] = _three(head.fields["space origin"].tolist(), "space origin")
    space = _SPACES.get(head.word("space"), "native")
    units = head.fields.get("space units", [])[:3]
    if not units and len(each := head.fields.get("units", [])) > max(axes.spatial):
        units = [each[axis] for axis in axes.spatial]
    factors = [_MM_PER_UNIT.get(unit.lower()) for unit in units]
    known = [factor for factor in factors if factor is not None]
    if len(known) != 3:
        return Placement(affine, space, "")
    affine[:3] *= np.array(known)[:, None]
    return Placement(affine, space, "mm")


def _three(vector: list[float] | None, field: str) -> list[float]:
    if vector is None or len(vector) < 3 or not all(map(math.isfinite, vector[:3])):
        raise InputError(f"header field {field} has no three numbers per vector; it is damaged")
    return vector[:3]


def _steps(head: Head, axes: Axes) -> tuple[list[float], list[float]]:
    """Spacing of each spatial axis and position of its first sample, 1 and 0 where nothing says more."""
    spacings, lows, highs, centerings = (
        list(head.fields.get(name, ())) for name in ("spacings", "axis mins", "axis maxs", "centerings")
    )
    steps, firsts = [], []
    for axis, samples in zip(axes.spatial, axes.layout.shape, strict=True):
        cell = _at(centerings, axis) == "cell"
        low, high, step = _number(lows, axis), _number(highs, axis), _number(spacings, axis)
        if step is None and low is not None and high is not None:
            step = (high - low) / (samples if cell else samples - 1)
        steps.append(1.0 if step is None else step)
        firsts.append(0.0 if low is None else low + (steps[-1] / 2 if cell else 0.0))
    return steps, firsts


def _number(numbers: list[Any], axis: int) -> float | None:
    number = _at(numbers, axis)
    return float(number) if number is not None and math.isfinite(number) else None


def _at(entries: list[Any], axis: int) -> Any:
    return entries[axis] if axis < len(entries) else None
