"""Read a legacy VTK file: an unstructured, structured or rectilinear grid as a CellMesh, structured points as a Volume.

"VTK File Formats", section "Simple Legacy Formats", in versions 1 to 5.1, as text or in bytes. Only the arrays that
are needed are decoded.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterator, Sequence
from mmap import ACCESS_READ, mmap
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from isocore.cell_mesh import CellMesh
from isocore.errors import InputError, reading
from isocore.readers.options import ReadOptions
from isocore.readers.vtk_carried import carried_fields
from isocore.readers.vtk_fields import FieldInfo, choose, component_of
from isocore.readers.vtk_ghosts import GHOST_TYPE, OF_CELLS
from isocore.readers.vtk_images import Image, Samples, image_volume, with_fields
from isocore.readers.vtk_legacy_arrays import TYPES, Cursor
from isocore.readers.vtk_legacy_cells import cells_of, grid_cells, refuse_flat
from isocore.readers.vtk_legacy_sections import Sections, sections
from isocore.readers.vtk_mesh import assembled
from isocore.readers.vtk_pieces import PieceData
from isocore.readers.vtk_polyhedra import FaceLists
from isocore.volume import Volume

_HEADER = re.compile(
    rb"# vtk datafile version\s*(\d{1,4})\.(\d{1,4})[^\n]*\n[^\n]*\n\s*(ascii|binary)[^\n]*\n", re.IGNORECASE
)


class LegacyFile:
    """A mapped file whose sections are known and whose numbers are not read yet."""

    def __init__(self, path: Path) -> None:
        self.path = os.fspath(path)
        with path.open("rb") as file:
            data = mmap(file.fileno(), 0, access=ACCESS_READ)
        header = _HEADER.match(data)
        if header is None:
            raise InputError(f"{path}: does not start as a legacy VTK file does; check that it is what its suffix says")
        self.version = int(header[1]), int(header[2])
        self.cursor = Cursor(self.path, data, header.end(), binary=header[3].lower() == b"binary")
        self.parts: Sections = sections(self.cursor)

    @property
    def fields(self) -> tuple[FieldInfo, ...]:
        """Numbers of points, then of cells."""
        found: dict[tuple[str, str], FieldInfo] = {}
        for of, arrays in (("points", self.parts.of_points), ("cells", self.parts.of_cells)):
            for name, (array, components) in arrays.items():
                if array.kind in TYPES:
                    side: Any = of
                    found[of, name] = FieldInfo(name, components, side, array.dtype.name)
        return tuple(found.values())

    def values(self, field: FieldInfo) -> npt.NDArray[Any]:
        """Flat, the components of each tuple together."""
        arrays = self.parts.of_points if field.of == "points" else self.parts.of_cells
        return self.cursor.read(arrays[field.name][0])

    def piece(self, field: FieldInfo, carried: Sequence[FieldInfo] = ()) -> PieceData:
        """The mesh, with the values of `field` and of `carried`."""
        parts, read = self.parts, self.cursor.read
        if parts.kind == "UNSTRUCTURED_GRID":
            cells = cells_of(self.cursor, parts)
            types, offsets, connectivity, faces = cells.types, cells.offsets, cells.connectivity, cells.faces
        else:
            refuse_flat(self.path, parts.dimensions)
            types, offsets, connectivity = grid_cells(parts.dimensions)
            faces = FaceLists()
        return PieceData(
            self._points(),
            types,
            offsets,
            connectivity,
            self.values(field),
            ghosts=tuple((name, read(parts.of_cells[name][0])) for name in OF_CELLS if name in parts.of_cells),
            hidden=read(parts.of_points[GHOST_TYPE][0]) if GHOST_TYPE in parts.of_points else None,
            faces=faces,
            degrees=self._degrees(),
            weights=read(parts.of_points["RationalWeights"][0]) if "RationalWeights" in parts.of_points else None,
            old=self.version < (5, 1),
            carried=tuple(self.values(one) for one in carried),
        )

    def _degrees(self) -> npt.NDArray[Any] | None:
        array, components = self.parts.of_cells.get("HigherOrderDegrees", (None, 0))
        return None if array is None or components != 3 else self.cursor.read(array).reshape(-1, 3)

    def _points(self) -> npt.NDArray[Any]:
        """(n, 3); of a rectilinear grid made of its axes, x fastest."""
        parts = self.parts
        if parts.axes:
            axes = [self.cursor.read(axis).astype(np.float64) for axis in parts.axes]
            z, y, x = np.meshgrid(axes[2], axes[1], axes[0], indexing="ij")
            return np.stack((x.ravel(), y.ravel(), z.ravel()), axis=1)
        assert parts.points is not None
        return self.cursor.read(parts.points).reshape(-1, 3)

    def samples(self, field: FieldInfo) -> Iterator[Samples]:
        """The whole image, as one part."""
        arrays = self.parts.of_points if field.of == "points" else self.parts.of_cells
        marks = self.cursor.read(arrays[GHOST_TYPE][0]) if GHOST_TYPE in arrays else None
        yield Samples(self.image.extent, self.values(field), marks)

    @property
    def image(self) -> Image:
        """Where structured points lie."""
        nx, ny, nz = self.parts.dimensions
        return Image((0, nx - 1, 0, ny - 1, 0, nz - 1), self.parts.origin, self.parts.spacing)


def read_legacy(path: Path, options: ReadOptions) -> Volume | CellMesh:
    """The mesh, or the volume, with the field that `options` choose."""
    with reading(path):
        file = LegacyFile(path)
        field = choose(file.path, file.fields, options)
        component = component_of(file.path, field, options.component)
        is_image = file.parts.kind == "STRUCTURED_POINTS"
        carried = carried_fields(file.path, file.fields, field, options.carry, files=is_image)
        if is_image:
            volume = image_volume(file.path, file.image, file.samples(field), field, component)
            return with_fields(file.path, volume, file.image, field, [(one, file.samples(one)) for one in carried])
        pieces = [file.piece(field, carried)]
        return assembled(file.path, pieces, field, component, options.mesh, options.ignore, carried)


def legacy_fields(path: Path) -> tuple[FieldInfo, ...]:
    """The fields the file offers, those of points first."""
    with reading(path):
        return LegacyFile(path).fields
