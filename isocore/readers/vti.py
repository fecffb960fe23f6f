"""Read a VTI file, an image in VTK's XML format, as a Volume; and a PVTI file, which lists those of its pieces."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

from isocore.errors import FieldError, InputError, reading
from isocore.readers.listing import beside, elements, refuse_missing
from isocore.readers.options import ReadOptions
from isocore.readers.vtk_carried import carried_fields
from isocore.readers.vtk_fields import FieldInfo, choose, component_of
from isocore.readers.vtk_ghosts import GHOST_TYPE
from isocore.readers.vtk_images import Image, Samples, image_volume, with_fields
from isocore.readers.vtu_arrays import DTYPES
from isocore.readers.vtu_layout import IMAGE, extent_of
from isocore.readers.vtu_opening import opened
from isocore.volume import Volume


class ImageFile:
    """One .vti: its place in the world, its fields, and the samples of its pieces."""

    def __init__(self, path: Path) -> None:
        self.path = os.fspath(path)
        self.arrays = opened(self.path, IMAGE)
        layout = self.arrays.layout
        self.pieces = layout.pieces
        self.image = _image(self.path, layout.grid)
        if not self.pieces:
            raise FieldError(f"{path}: holds no samples, so there is nothing to contour")

    @property
    def fields(self) -> tuple[FieldInfo, ...]:
        """Of the first piece; the others have to hold the one that is chosen."""
        arrays = self.pieces[0].arrays
        found = [FieldInfo(tag.name, tag.components, "points", tag.type) for tag in arrays["PointData"]]
        found += [FieldInfo(tag.name, tag.components, "cells", tag.type) for tag in arrays["CellData"]]
        return tuple({(f.of, f.name): f for f in found if f.type in DTYPES and f.components}.values())

    def samples(self, field: FieldInfo) -> Iterator[Samples]:
        """Of every piece."""
        section = "PointData" if field.of == "points" else "CellData"
        for number, piece in enumerate(self.pieces, 1):
            tuples = piece.points if field.of == "points" else piece.cells
            tag = next(iter(piece.named(section, field.name)), None)
            if tag is None or tag.components != field.components:
                raise InputError(
                    f"{self.path}: has no array {field.name!r} in <{section}> of piece {number} as in the first;"
                    " write the file again"
                )
            values = self.arrays.read(tag, tuples * field.components)
            marks = next((self.arrays.read(tag, tuples) for tag in piece.named(section, GHOST_TYPE)), None)
            yield Samples(piece.extent, values, marks)


def read_vti(path: Path, options: ReadOptions) -> Volume:
    """The volume of the field that `options` choose."""
    with reading(path):
        file = ImageFile(path)
        field = choose(file.path, file.fields, options)
        component = component_of(file.path, field, options.component)
        carried = carried_fields(file.path, file.fields, field, options.carry, files=True)
        volume = image_volume(file.path, file.image, file.samples(field), field, component)
        return with_fields(file.path, volume, file.image, field, [(one, file.samples(one)) for one in carried])


def vti_fields(path: Path) -> tuple[FieldInfo, ...]:
    """The fields of an image, those of points first."""
    with reading(path):
        return tuple(sorted(ImageFile(path).fields, key=lambda field: field.of != "points"))


def read_pvti(path: Path, options: ReadOptions) -> Volume:
    """The same of an image in several files."""
    name = os.fspath(path)
    with reading(path):
        image, files = _pieces(path)
        refuse_missing(name, files, "pieces")
        fields = ImageFile(files[0]).fields
        field = choose(name, fields, options)
        component = component_of(name, field, options.component)
        carried = carried_fields(name, fields, field, options.carry, files=True)

        def parts(one: FieldInfo) -> Iterator[Samples]:
            return (part for file in files for part in ImageFile(file).samples(one))

        volume = image_volume(name, image, parts(field), field, component)
        return with_fields(name, volume, image, field, [(one, parts(one)) for one in carried])


def pvti_fields(path: Path) -> tuple[FieldInfo, ...]:
    """The fields of its first piece."""
    with reading(path):
        files = _pieces(path)[1]
        refuse_missing(os.fspath(path), files, "pieces")
        return vti_fields(files[0])


def pvti_files(path: Path) -> tuple[Path, ...]:
    """The pieces that are there."""
    return tuple(file for file in _pieces(path)[1] if file.is_file())


def _pieces(path: Path) -> tuple[Image, list[Path]]:
    tags = elements(path, "PImageData", "lists the pieces of an image")
    grid = next((attributes for tag, attributes in tags if tag == "PImageData"), {})
    files = [beside(path, attributes.get("Source", "").strip()) for tag, attributes in tags if tag == "Piece"]
    if not files:
        raise FieldError(f"{path}: names no pieces, so there is nothing to contour")
    return _image(os.fspath(path), grid), files


def _image(path: str, grid: dict[str, str]) -> Image:
    numbers = {}
    for name in ("Origin", "Spacing", "Direction"):
        if name in grid:
            try:
                numbers[name.lower()] = tuple(map(float, grid[name].split()))
            except ValueError:
                raise InputError(f"{path}: its {name} is {grid[name][:60]!r}, not numbers; write it again") from None
    return Image(extent_of(path, grid.get("WholeExtent", "")), **numbers)
