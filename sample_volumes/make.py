"""Make the synthetic samples in this folder again: `make samples`.

Everything here is computed from formulas and fixed seeds; nothing is measured. Needs only what isocore itself needs.
"""

from __future__ import annotations

import gzip
import hashlib
import json
import sys
import zlib
from pathlib import Path

import nibabel
import numpy as np
import numpy.typing as npt
from knot import knot_field

HERE = Path(__file__).parent
Floats = npt.NDArray[np.float64]


def landscape(shape: tuple[int, int, int]) -> npt.NDArray[np.int16]:
    """Depth below the ground of a fractal landscape (spectrum to the -1.9th power), 12 a sample, at most 120."""
    nx, ny, nz = shape
    rng = np.random.default_rng(1998)
    frequency = np.hypot(np.fft.fftfreq(nx)[:, None], np.fft.fftfreq(ny)[None, :])
    frequency[0, 0] = np.inf
    phases = np.exp(2j * np.pi * rng.random((nx, ny)))
    heights = np.real(np.fft.ifft2(phases / frequency**1.9))
    heights = (heights - heights.min()) / np.ptp(heights) * (nz - 8) + 3
    return np.rint(np.clip(12 * (heights[:, :, None] - np.arange(nz)), -120, 120)).astype(np.int16)


def head(shape: tuple[int, int, int]) -> npt.NDArray[np.uint8]:
    """A head-like phantom: skin 60, skull 200, brain 110, ventricles 40, two eyes 90; its edges are soft."""
    x, y, z = (np.linspace(-1, 1, n).reshape([-1 if a == b else 1 for b in range(3)]) for a, n in enumerate(shape))
    parts = [  # centre, radii, value
        ((0, 0, 0), (0.80, 0.92, 0.90), 60),
        ((0, 0, 0.02), (0.74, 0.86, 0.84), 200),
        ((0, 0, 0.03), (0.62, 0.74, 0.72), 110),
        ((-0.17, 0.05, 0.08), (0.10, 0.34, 0.16), 40),
        ((0.17, 0.05, 0.08), (0.10, 0.34, 0.16), 40),
        ((-0.28, 0.80, -0.12), (0.15, 0.13, 0.13), 90),
        ((0.28, 0.80, -0.12), (0.15, 0.13, 0.13), 90),
    ]
    value = np.zeros(shape)
    for (cx, cy, cz), (rx, ry, rz), inside in parts:
        radius = np.sqrt(((x - cx) / rx) ** 2 + ((y - cy) / ry) ** 2 + ((z - cz) / rz) ** 2)
        share = np.clip((1 - radius) * min(rx, ry, rz) * min(shape) / 4 + 0.5, 0, 1)
        value += share * (inside - value)
    return np.rint(value).astype(np.uint8)


def vessels(samples_per_axis: int) -> npt.NDArray[np.uint8]:
    """A tree of vessels that fork and thin out; 255 on the axis, falling to 0 at 2.2 radii: the wall is at 140."""
    rng = np.random.default_rng(2001)
    axis = np.arange(samples_per_axis, dtype=np.float64)
    grid = np.stack(np.meshgrid(axis, axis, axis, indexing="ij"), axis=-1)
    value = np.zeros((samples_per_axis,) * 3)
    middle = samples_per_axis / 2
    open_ends = [(np.array([middle, middle, 4.0]), np.array([0.0, 0.0, 1.0]), samples_per_axis * 0.24, 3.6)]
    for _ in range(31):
        start, direction, length, radius = open_ends.pop(0)
        end = start + direction * length
        along = np.clip(((grid - start) @ (end - start)) / length**2, 0, 1)
        distance = np.linalg.norm(grid - start - along[..., None] * (end - start), axis=-1)
        value = np.maximum(value, 255 * np.clip(1 - distance / (2.2 * radius), 0, 1))
        side = np.cross(direction, rng.standard_normal(3))
        side /= np.linalg.norm(side)
        for turn in (0.62, -0.62):
            branch = np.cos(turn) * direction + np.sin(turn) * side
            open_ends.append((end, branch, length * 0.80, radius * 0.78))
    return np.rint(value).astype(np.uint8)


def torus_body(around: int, across: int) -> tuple[Floats, npt.NDArray[np.int32], npt.NDArray[np.float32]]:
    """Points, tetrahedra and field of a solid torus: a disk of squares swept round a circle, six tetrahedra a brick."""
    u = np.linspace(-1, 1, across + 1)
    a, b = np.meshgrid(u, u, indexing="ij")
    disk_x, disk_y = a * np.sqrt(1 - b**2 / 2), b * np.sqrt(1 - a**2 / 2)
    phi = 2 * np.pi * np.arange(around) / around
    radius = 2 + 0.8 * disk_x[None]
    points = np.stack([radius * np.cos(phi)[:, None, None], radius * np.sin(phi)[:, None, None],
                       np.broadcast_to(0.8 * disk_y, (around, *disk_y.shape))], axis=-1).reshape(-1, 3)
    ring, row, column = np.meshgrid(np.arange(around), np.arange(across), np.arange(across), indexing="ij")

    def point(step: tuple[int, int, int]) -> npt.NDArray[np.int64]:
        at = ((ring + step[0]) % around * (across + 1) + row + step[1]) * (across + 1) + column + step[2]
        return at.ravel()

    steps = {0: (1, 0, 0), 1: (0, 1, 0), 2: (0, 0, 1)}
    tets = []
    for first in range(3):  # Kuhn: one tetrahedron for each order in which the three steps can be taken
        for second in set(range(3)) - {first}:
            middle = tuple(np.add(steps[first], steps[second]).tolist())
            tets.append(np.stack([point((0, 0, 0)), point(steps[first]), point(middle), point((1, 1, 1))], axis=1))
    angle = np.arctan2(points[:, 1], points[:, 0])
    field = np.cos(3 * angle) + 0.6 * np.sin(5 * angle + 2 * points[:, 2]) + 0.4 * points[:, 2] + 0.15 * points[:, 0]
    return points, np.concatenate(tets).astype(np.int32), field.astype(np.float32)


def body_with_void(cells: int, hollow: int) -> tuple[Floats, npt.NDArray[np.int32], npt.NDArray[np.float64]]:
    """Points, hexahedra and field (two warm spots) of a rounded block whose middle cells are missing."""
    n = cells + 1
    i, j, k = (axis.ravel() for axis in np.meshgrid(*[np.arange(cells)] * 3, indexing="ij"))
    low, high = (cells - hollow) // 2, (cells + hollow) // 2
    solid = ~((i >= low) & (i < high) & (j >= low) & (j < high) & (k >= low) & (k < high))
    corners = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
    hexes = np.stack([((i + a) * n + j + b) * n + k + c for a, b, c in corners], axis=1)[solid]
    u = np.linspace(-1, 1, n)
    x, y, z = (axis.ravel() for axis in np.meshgrid(u, u, u, indexing="ij"))
    points = 50 * np.stack([x * np.sqrt(1 - y**2 / 4 - z**2 / 4), y * np.sqrt(1 - x**2 / 4 - z**2 / 4),
                            z * np.sqrt(1 - x**2 / 4 - y**2 / 4)], axis=1)
    used, hexes = np.unique(hexes, return_inverse=True)
    points = points[used]
    spots = [(np.array([30.0, 20.0, 10.0]), 80.0), (np.array([-25.0, -10.0, -30.0]), 60.0)]
    field = 20 + sum(heat * np.exp(-((points - spot) ** 2).sum(axis=1) / 900) for spot, heat in spots)
    return points, hexes.reshape(-1, 8).astype(np.int32), np.asarray(field)


def vtu(
    points: Floats, cells: npt.NDArray[np.int32], field: npt.NDArray[np.generic], *, vtk_type: int, name: str
) -> bytes:
    """A VTU file: appended raw blocks, zlib, 64-bit headers."""
    offsets = np.arange(1, len(cells) + 1, dtype=np.int32) * cells.shape[1]
    arrays = [("Points", points, 3), ("connectivity", cells.ravel(), 1), ("offsets", offsets, 1),
              ("types", np.full(len(cells), vtk_type, np.uint8), 1), (name, field, 1)]
    blocks, entries = b"", {}
    for label, values, components in arrays:
        raw = np.ascontiguousarray(values).tobytes()
        packed = zlib.compress(raw, 9)
        kind = {"f": "Float", "i": "Int", "u": "UInt"}[values.dtype.kind] + str(8 * values.dtype.itemsize)
        entries[label] = (f'<DataArray type="{kind}" Name="{label}" NumberOfComponents="{components}" '
                          f'format="appended" offset="{len(blocks)}"/>')
        blocks += np.array([1, len(raw), 0, len(packed)], np.uint64).tobytes() + packed
    head = (
        '<?xml version="1.0"?>\n<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian" '
        'header_type="UInt64" compressor="vtkZLibDataCompressor">\n<UnstructuredGrid>\n'
        f'<Piece NumberOfPoints="{len(points)}" NumberOfCells="{len(cells)}">\n<PointData Scalars="{name}">'
        f'{entries[name]}</PointData>\n<Points>{entries["Points"]}</Points>\n<Cells>{entries["connectivity"]}'
        f'{entries["offsets"]}{entries["types"]}</Cells>\n</Piece>\n</UnstructuredGrid>\n'
        '<AppendedData encoding="raw">\n_'
    )
    return head.encode() + blocks + b"\n</AppendedData>\n</VTKFile>\n"


def files() -> dict[str, bytes]:
    """Every sample's name and content."""
    affine = np.diag([2.0, 2.0, 2.0, 1.0])
    affine[:3, 3] = -64
    knotted = nibabel.Nifti1Image(np.trunc(knot_field(64)).astype(np.uint8), affine)
    knotted.header.set_xyzt_units("mm")
    heights = landscape((90, 90, 40))
    nrrd = (b"NRRD0004\ntype: int16\ndimension: 3\nspace: right-anterior-superior\nsizes: 90 90 40\n"
            b"space directions: (10,0,0) (0,10,0) (0,0,10)\nspace origin: (0,0,0)\nendian: little\nencoding: gzip\n\n")
    skull = head((48, 60, 56))
    sidecar = {"shape": [48, 60, 56], "dtype": "uint8", "spacing": [3.5, 3.5, 3.5], "origin": [0, 0, 0]}
    tree = vessels(80)
    nhdr = (b"NRRD0004\ntype: uint8\ndimension: 3\nspace: left-posterior-superior\nsizes: 80 80 80\n"
            b"space directions: (0.5,0,0) (0,0.5,0) (0,0,0.5)\nspace origin: (-20,-20,-20)\n"
            b'space units: "mm" "mm" "mm"\nencoding: gzip\ndata file: vessels.raw.gz\n')
    return {
        "knot.nii.gz": gzip.compress(knotted.to_bytes(), 9, mtime=0),
        "landscape.nrrd": nrrd + gzip.compress(heights.tobytes(order="F"), 9, mtime=0),
        "head.raw": skull.tobytes(order="F"),
        "head.raw.json": (json.dumps(sidecar) + "\n").encode(),
        "vessels.nhdr": nhdr,
        "vessels.raw.gz": gzip.compress(tree.tobytes(order="F"), 9, mtime=0),
        "torus.vtu": vtu(*torus_body(60, 7), vtk_type=10, name="wave"),
        "void.vtu": vtu(*body_with_void(16, 6), vtk_type=12, name="temperature"),
    }


def main() -> None:
    """Write the samples into the folder named on the command line, or beside this script."""
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else HERE
    folder.mkdir(parents=True, exist_ok=True)
    for name, content in files().items():
        (folder / name).write_bytes(content)
        print(f"{name:16} {len(content):>9,} bytes  sha256 {hashlib.sha256(content).hexdigest()[:16]}")


if __name__ == "__main__":
    main()
