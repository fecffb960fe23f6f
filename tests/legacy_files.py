"""A small writer of legacy VTK files of our own, in every version and both ways, as text and in bytes."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from vtu_files import Mesh

NAMES = {"f4": "float", "f8": "double", "i4": "int", "i8": "vtktypeint64", "u1": "unsigned_char", "i2": "short"}
WAYS = [("4.2", "ASCII"), ("4.2", "BINARY"), ("5.1", "ASCII"), ("5.1", "BINARY")]


class Writer:
    """Lines and arrays of one file."""

    def __init__(self, version: str, mode: str) -> None:
        self.binary = mode == "BINARY"
        self.bytes = f"# vtk DataFile Version {version}\na title\n{mode}\n".encode()

    def line(self, text: str) -> None:
        self.bytes += text.encode() + b"\n"

    def array(self, values: Any, dtype: str) -> None:
        flat = np.asarray(values).astype(np.dtype(dtype).newbyteorder(">")).ravel()
        if self.binary:
            self.bytes += flat.tobytes() + b"\n"
        else:
            words = [repr(number) for number in flat.tolist()]
            self.bytes += "\n".join(" ".join(words[n : n + 9]) for n in range(0, len(words), 9)).encode() + b"\n"

    def fields(self, where: str, count: int, arrays: dict[str, Any]) -> None:
        """The first as SCALARS, the others in a FIELD, with what VTK writes between them."""
        if not arrays:
            return
        self.line(f"{where} {count}")
        (name, first), *others = arrays.items()
        kind = first.dtype.str[1:]
        self.line(f"SCALARS {name} {NAMES[kind]} {first.shape[1] if first.ndim == 2 else 1}\nLOOKUP_TABLE default")
        self.array(first, kind)
        self.line(f"FIELD FieldData {len(others)}")
        for name, values in others:
            kind = values.dtype.str[1:]
            components = values.shape[1] if values.ndim == 2 else 1
            self.line(f"{name.replace(' ', '%20')} {components} {len(values)} {NAMES[kind]}")
            self.array(values, kind)
            self.line("METADATA\nINFORMATION 1\nNAME L2_NORM_RANGE LOCATION vtkDataArray\nDATA 2 0 1\n")


def write_grid(path: Path, mesh: Mesh, version: str = "4.2", mode: str = "ASCII", **arrays: Any) -> Path:
    """An unstructured grid. arrays: of_cells, faces (the stream of polyhedra by cell)."""
    out = Writer(version, mode)
    streams = arrays.get("faces", {})
    cells = [streams.get(n, ids) for n, (_, ids) in enumerate(mesh.cells)]
    out.line("DATASET UNSTRUCTURED_GRID")
    out.line("FIELD FieldData 1\nTIME 1 1 double")
    out.array([2.5], "f8")
    out.line(f"POINTS {len(mesh.points)} double")
    out.array(mesh.points, "f8")
    if version == "5.1":
        out.line(f"CELLS {len(cells) + 1} {sum(map(len, cells))}\nOFFSETS vtktypeint64")
        out.array(np.cumsum([0, *map(len, cells)]), "i8")
        out.line("CONNECTIVITY vtktypeint64")
        out.array(np.concatenate(cells), "i8")
    else:
        out.line(f"CELLS {len(cells)} {sum(map(len, cells)) + len(cells)}")
        out.array(np.concatenate([[len(ids), *ids] for ids in cells]), "i4")
    out.line(f"CELL_TYPES {len(cells)}")
    out.array([number for number, _ in mesh.cells], "i4")
    out.fields("CELL_DATA", len(cells), mesh.cell_fields)
    out.fields("POINT_DATA", len(mesh.points), mesh.point_fields)
    path.write_bytes(out.bytes)
    return path


def structured(kind: str, mode: str, dimensions: tuple[int, int, int], points: Any, cells: Any) -> bytes:
    """One of the grids whose cells are implied, around the same box."""
    nx, ny, nz = dimensions
    axes = [np.linspace(0, 1, n) for n in dimensions]
    out = Writer("3.0", mode)
    out.line(f"DATASET {kind}\nDIMENSIONS {nx} {ny} {nz}")
    if kind == "STRUCTURED_POINTS":
        out.line(f"SPACING {1 / (nx - 1)!r} {1 / (ny - 1)!r} {1 / (nz - 1)!r}\nORIGIN 0 0 0")
    elif kind == "RECTILINEAR_GRID":
        for letter, axis in zip("XYZ", axes, strict=True):
            out.line(f"{letter}_COORDINATES {len(axis)} double")
            out.array(axis, "f8")
    else:
        z, y, x = np.meshgrid(*reversed(axes), indexing="ij")
        out.line(f"POINTS {x.size} double")
        out.array(np.stack((x.ravel(), y.ravel(), z.ravel()), axis=1), "f8")
    out.fields("POINT_DATA", nx * ny * nz, points)
    out.fields("CELL_DATA", (nx - 1) * (ny - 1) * (nz - 1), cells)
    return out.bytes
