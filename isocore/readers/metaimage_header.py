"""The text at the head of a MetaImage: its fields, and where they put samples in the world.

Follows the MetaIO documentation of ITK (Aylward, Enquobahrie), and MetaIO itself where that says nothing. World is LPS,
in mm: the file's AnatomicalOrientation names the axes and moves nothing, as in ITK.
"""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path
from typing import IO

import numpy as np

from isocore.errors import FieldError, InputError
from isocore.readers.layout import Layout, Placement, spatial

#: Samples by their names; a name that ends in _ARRAY is the same with several to a voxel.
_TYPES = {
    "MET_CHAR": "i1", "MET_ASCII_CHAR": "i1", "MET_UCHAR": "u1", "MET_SHORT": "i2", "MET_USHORT": "u2",
    "MET_INT": "i4", "MET_UINT": "u4", "MET_LONG": "i4", "MET_ULONG": "u4", "MET_LONG_LONG": "i8",
    "MET_ULONG_LONG": "u8", "MET_FLOAT": "f4", "MET_DOUBLE": "f8",
}  # fmt: skip
#: Fields of one meaning, the one that counts first.
_PLACES = ("position", "origin", "offset")
_DIRECTIONS = ("orientation", "rotation", "transformmatrix")
_MILLIMETRES = {"um": 1e-3, "mm": 1.0, "cm": 10.0}
_LAST = "elementdatafile"
#: A header longer than this is none, nor is one of more axes.
_MOST_BYTES, _MOST_AXES = 1 << 20, 10
#: No file has more bytes.
_LARGEST = 1 << 48


@dataclass(frozen=True, slots=True)
class Head:
    """A header's text.

    fields: texts by their names in lower case. size: bytes of the head. files: the lines after ElementDataFile = LIST.
    """

    fields: dict[str, str]
    size: int
    files: tuple[str, ...] = ()

    def need(self, name: str) -> str:
        """A field without which there is nothing to read."""
        if name.lower() not in self.fields:
            raise InputError(f"header lacks the field {name}; it is damaged")
        return self.fields[name.lower()]

    def says(self, name: str, *others: str) -> bool:
        """Whether one of these fields says yes."""
        return any(self.fields.get(one.lower(), "").lower() in ("true", "1", "t") for one in (name, *others))

    def numbers(self, name: str, count: int, default: list[float] | None = None) -> list[float]:
        """So many finite numbers of a field."""
        text = self.fields.get(name.lower()) if default is not None else self.need(name)
        if text is None:
            return default or []
        try:
            found = [float(part) for part in text.split()[:count]]
        except ValueError:
            found = []
        if len(found) < count or not np.isfinite(found).all():
            raise InputError(f"header has no {count} numbers as {name} ({text[:40]!a}); it is damaged")
        return found

    def whole(self, name: str, count: int, default: list[float] | None = None) -> list[int]:
        """So many whole numbers, which may be written as 4.0."""
        found = self.numbers(name, count, default)
        if any(number != int(number) or abs(number) > _LARGEST for number in found):
            raise InputError(f"header has {name} {found}, which are no whole numbers of samples; it is damaged")
        return [int(number) for number in found]


def parsed(path: Path) -> Head:
    """The head of `path`, up to the line that says where the samples are."""
    fields: dict[str, str] = {}
    with path.open("rb") as file:
        while _LAST not in fields:
            line = file.readline(_MOST_BYTES)
            name, mark, text = os.fsdecode(line).partition("=")
            if not line or file.tell() > _MOST_BYTES or (line.strip() and not mark):
                what = "does not say where its samples are" if fields else "is no MetaImage"
                raise InputError(f"{what} (there is no field ElementDataFile); it is damaged")
            fields.setdefault(name.strip().lower(), text.strip())
        files = tuple(_lines(file)) if fields[_LAST].upper().startswith("LIST") else ()
        return Head(fields, file.tell(), files)


def _lines(file: IO[bytes]) -> list[str]:
    text = file.read(_MOST_BYTES)
    return [os.fsdecode(line.strip()) for line in text.splitlines() if line.strip()]


def layout_of(head: Head) -> Layout:
    """The samples, with values of several channels and volumes of a fourth axis as volumes."""
    axes = head.whole("NDims", 1)[0]
    if not 0 < axes <= _MOST_AXES:
        raise InputError(f"header has {axes} axes; it is damaged")
    sizes = head.whole("DimSize", axes)
    if min(sizes) < 0:
        raise InputError(f"header has an axis of {min(sizes)} samples; it is damaged")
    shape = spatial(tuple((*sizes, 1, 1)[:3]))
    name = head.need("ElementType").upper().removesuffix("_ARRAY")
    if name not in _TYPES:
        raise FieldError(f"samples are of type {name[:40]}, which have no isosurface; write them as numbers")
    order = ">" if head.says("BinaryDataByteOrderMSB", "ElementByteOrderMSB") else "<"
    stored = np.dtype(f"{order}{_TYPES[name]}")
    channels = head.whole("ElementNumberOfChannels", 1, [1.0])[0]
    times = int(np.prod(sizes[3:], dtype=object))
    if channels < 1 or (channels > 1 and times > 1):
        raise FieldError(f"holds {channels} values a voxel at {times} times; write one of them to a file")
    return Layout(shape, stored, channels, 0) if channels > 1 else Layout(shape, stored, times)


def placement(head: Head) -> Placement:
    """Where the first three axes lie. A row of the matrix is the direction of an axis, not a row of the affine."""
    axes = head.whole("NDims", 1)[0]
    size = head.numbers("ElementSize", axes, [1.0] * axes)
    spacing = head.numbers("ElementSpacing", axes, size)
    directions = np.eye(axes).ravel().tolist()
    origin = [0.0] * axes
    for name in reversed(_DIRECTIONS):
        directions = head.numbers(name, axes * axes, directions)
    for name in reversed(_PLACES):
        origin = head.numbers(name, axes, origin)
    affine = np.eye(4)
    with np.errstate(over="ignore"):  # a volume refuses what is not finite
        affine[:3, :3] = np.reshape(directions, (axes, axes))[:3, :3].T * spacing[:3]
        affine[:3, 3] = origin[:3]
        affine[:3] *= _MILLIMETRES.get(head.fields.get("distanceunits", "").lower(), 1.0)
    slope = head.numbers("ElementToIntensityFunctionSlope", 1, [1.0])[0]
    intercept = head.numbers("ElementToIntensityFunctionOffset", 1, [0.0])[0]
    scaled = f"its header would multiply its samples by {slope:g} and add {intercept:g}; as by ITK, they were left"
    return Placement(affine, "lps", "mm", (scaled,) if (slope, intercept) != (1.0, 0.0) else ())
