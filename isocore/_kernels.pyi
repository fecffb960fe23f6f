"""What the compiled module offers, by hand; kernels/python/bind_*.cpp are where it comes from."""

from typing import Any

import numpy as np
import numpy.typing as npt

_Int32 = npt.NDArray[np.int32]
_Float32 = npt.NDArray[np.float32]
_Float64 = npt.NDArray[np.float64]
_Bytes = npt.NDArray[np.uint8]
_Real = npt.NDArray[Any]  # float32 or float64
_Samples = npt.NDArray[Any]  # (nx, ny, nz) in Fortran order, one of volume.SAMPLE_TYPES
_Bounds = tuple[float, float, float, float, float, float]  # low x, y, z, then high

def supports_v3() -> bool: ...

# marching_cubes: (vertices in index space, triangles, ambiguous faces, ambiguous cells, tubes)
def marching_cubes(
    samples: _Samples,
    isovalue: float,
    below: bool = False,
    capped: bool = False,
    threads: int = 1,
    trilinear: bool = False,
) -> tuple[_Real, _Int32, int, int, int]: ...

# climbing: (vertices in index space, triangles, facts by name)
def climb(
    samples: _Samples,
    isovalue: float,
    below: bool = False,
    capped: bool = False,
    threads: int = 1,
    block_size: int = 16,
    max_error: float = ...,
    in_world: bool = False,
    spacing: tuple[float, float, float] = ...,
    measured: bool = True,
    ranges: npt.NDArray[Any] | None = None,
) -> tuple[_Real, _Int32, dict[str, Any]]: ...

# sample_ranges: the lowest and highest sample of blocks of 64 x 16 x 16, by turns, for climb's `ranges`
def sample_ranges(samples: _Samples, threads: int = 1) -> npt.NDArray[Any]: ...

# ambiguities: (places (n, 3) in index space, saddle distances (n,))
def ambiguities(
    samples: _Samples, isovalue: float, below: bool = False, threads: int = 1
) -> tuple[_Float64, _Float64]: ...

# surface: vertices (v, 3), triangles (t, 3), normals (v, 3), affine (3, 4); `out` and `flip` write in place
# measure: ((components, boundary edges, non-manifold edges, non-manifold vertices, misoriented edges, Euler
# number, degenerate triangles), area, signed volume, bounds)
def measure(
    vertices: _Real, triangles: _Int32, threads: int = 1
) -> tuple[tuple[int, int, int, int, int, int, int], float, float, _Bounds]: ...
def bounds(vertices: _Real) -> _Bounds: ...
def place(vertices: _Real, affine: _Float64, out: _Real, threads: int = 1) -> None: ...
def flip(triangles: _Int32, threads: int = 1) -> None: ...
def turn_normals(normals: _Float32, affine: _Float64, threads: int = 1) -> None: ...
def gradient_normals(
    samples: _Samples, vertices: _Real, triangles: _Int32, below: bool, threads: int = 1
) -> _Float32: ...
def triangle_normals(vertices: _Real, triangles: _Int32) -> _Float32: ...
def format_rows(tag: str, rows: _Real, threads: int = 1) -> bytes: ...
def format_faces(triangles: _Int32, with_normals: bool, threads: int = 1) -> bytes: ...
def stl_records(vertices: _Real, triangles: _Int32, threads: int = 1) -> _Bytes: ...
def ply_faces(triangles: _Int32, threads: int = 1) -> _Bytes: ...

# marching_cells: (vertices in the mesh's space, triangles, intersected cells); `single` makes vertices float32
def marching_cells(
    points: _Float64,
    tets: _Int32,
    hexes: _Int32,
    values: _Real,
    isovalue: float,
    threads: int = 1,
    single: bool = False,
) -> tuple[_Real, _Int32, int]: ...

# statistics: samples as a flat view in memory order; (minimum, maximum, non-finite) with minimum > maximum where no
# sample is finite, and counts in equal bins from low to high
def extent(samples: npt.NDArray[Any], threads: int) -> tuple[float, float, int]: ...
def histogram(
    samples: npt.NDArray[Any], low: float, high: float, bins: int, threads: int
) -> npt.NDArray[np.uint64]: ...

# thinning: records (m, 14) or (m, 26), skeleton (s,), low and high (s,); then as isocore.methods.mesh_index.IndexPart
_Part = tuple[
    _Int32, _Int32, _Float64, _Float64, int, tuple[int, ...], int, tuple[int, int, int], int, int
]

# build_index: (tetrahedra, hexahedra, the mesh's id of every point of the index, edge ids)
def build_index(
    points: _Float64, tets: _Int32, hexes: _Int32, values: _Real
) -> tuple[_Part, _Part, _Int32, int]: ...

# propagate: (vertices, triangles, seeds, visited cells); points and values as the index numbers them, `original` their
# ids in the mesh; `vertex_of_edge` is scratch, one per edge id
def propagate(
    points: _Float64,
    values: _Real,
    tets: _Int32,
    tet_skeleton: _Int32,
    tet_low: _Float64,
    tet_high: _Float64,
    hexes: _Int32,
    hex_skeleton: _Int32,
    hex_low: _Float64,
    hex_high: _Float64,
    original: _Int32,
    vertex_of_edge: _Int32,
    isovalue: float,
    threads: int = 1,
    single: bool = False,
) -> tuple[_Real, _Int32, int, int]: ...

# walk: the search of propagate alone: (tetrahedra, hexahedra, seeds)
def walk(
    points: _Float64,
    values: _Real,
    tets: _Int32,
    tet_skeleton: _Int32,
    tet_low: _Float64,
    tet_high: _Float64,
    hexes: _Int32,
    hex_skeleton: _Int32,
    hex_low: _Float64,
    hex_high: _Float64,
    original: _Int32,
    vertex_of_edge: _Int32,
    isovalue: float,
) -> tuple[_Int32, _Int32, int]: ...

# thin_grid: (skeleton cells, low, high, extrema)
def thin_grid(
    samples: _Samples, below: bool = False, capped: bool = False
) -> tuple[_Int32, _Float64, _Float64, int]: ...

# propagate_grid: (vertices in index space, triangles, seeds, visited cells, ambiguous faces, ambiguous cells)
def propagate_grid(
    samples: _Samples,
    skeleton: _Int32,
    low: _Float64,
    high: _Float64,
    place: _Int32,
    isovalue: float,
    below: bool = False,
    capped: bool = False,
    threads: int = 1,
) -> tuple[_Float64, _Int32, int, int, int, int]: ...

# extrema_graph: the cells that the rival of 1995 registers
def extrema_graph(records: _Int32, corners: int, faces: int, at_extremum: _Bytes) -> _Int32: ...
