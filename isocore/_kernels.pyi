"""What the compiled module offers, by hand; kernels/python/bind_*.cpp are where it comes from."""

from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

_Int32 = npt.NDArray[np.int32]
_Float32 = npt.NDArray[np.float32]
_Float64 = npt.NDArray[np.float64]
_Bytes = npt.NDArray[np.uint8]
_Real = npt.NDArray[np.float32] | npt.NDArray[np.float64]
_Samples = npt.NDArray[Any]  # (nx, ny, nz) in Fortran order, one of volume.SAMPLE_TYPES
_Bounds = tuple[float, float, float, float, float, float]  # low x, y, z, then high

BUILD: str  # "v3" or "base": which of the compiled modules these names come from

# Whatever returns several things returns a named tuple. Vertices are (v, 3), triangles (t, 3).

class MarchedVolume(NamedTuple):
    vertices: _Real  # index space
    triangles: _Int32
    ambiguous_faces: int
    ambiguous_cells: int
    tubes: int

def marching_cubes(
    samples: _Samples,
    isovalue: float,
    below: bool = False,
    capped: bool = False,
    threads: int = 1,
    trilinear: bool = False,
) -> MarchedVolume: ...

class Deviation(NamedTuple):
    max: float
    mean: float
    rms: float

class ClimbingFacts(NamedTuple):
    highrices: int
    blocks: int
    blocks_visited: int
    ambiguous_faces: int
    ambiguous_cells: int
    split_again: int
    error_voxels: Deviation  # in index space
    error_world: Deviation  # with every index axis stretched by `spacing`

class ClimbedVolume(NamedTuple):
    vertices: _Real  # index space
    triangles: _Int32
    facts: ClimbingFacts

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
    tilted: bool = False,
) -> ClimbedVolume: ...

# sample_ranges: the lowest and highest sample of blocks of 64 x 16 x 16, by turns, for climb's `ranges`
def sample_ranges(samples: _Samples, threads: int = 1) -> npt.NDArray[Any]: ...

# simplify: every distance is in coordinates times `stretch`; cell: the side of a cell, in coordinates
class SimplifiedMesh(NamedTuple):
    vertices: _Real  # some of those that came in, in their order
    triangles: _Int32
    kept: _Int32  # of each vertex: its number among those that came in
    collapses: int
    refused: tuple[int, int, int, int, int]  # by link, shape, outward, back, crossing
    unproved: int  # triangles that may lie further from the reference than the bound
    error: tuple[float, float, float]  # from the reference's vertices to the surface: largest, mean, root mean square
    error_other: tuple[float, float, float]  # the same, in coordinates times `other`
    back_max: float  # no point of the surface, but for those triangles, lies further from the reference

# How vertices are written: through affine (3, 4), rounded to float32 or float64. rounding: how far that moves one along
# each axis at most, once it is brought back.
class Writing:
    def __init__(self, affine: _Float64, is_single: bool, rounding: float) -> None: ...

def simplify(
    vertices: _Real,
    triangles: _Int32,
    reference_vertices: _Real,
    reference_triangles: _Int32,
    max_error: float,
    stretch: tuple[float, float, float] = ...,
    other: tuple[float, float, float] = ...,
    cell: float = 1.0,
    most_triangles: int = 0,
    writing: Writing | None = None,
    threads: int = 1,
) -> SimplifiedMesh: ...

# a coarser mesh to look at: which vertices are left, and the triangles of these
def cluster(vertices: _Real, triangles: _Int32, most: int) -> tuple[_Int32, _Int32]: ...

class AmbiguousFaces(NamedTuple):
    places: _Float64  # (n, 3), index space: the saddle of each face
    distances: _Float64  # (n,), of the saddle's value from the isovalue

def ambiguities(samples: _Samples, isovalue: float, below: bool = False, threads: int = 1) -> AmbiguousFaces: ...

# surface: vertices (v, 3), triangles (t, 3), normals (v, 3), affine (3, 4); `out` and `flip` write in place
class Measured(NamedTuple):
    components: int
    boundary_edges: int
    nonmanifold_edges: int
    nonmanifold_vertices: int
    misoriented_edges: int
    euler: int
    degenerate: int
    area: float
    volume: float  # signed; means something only when the surface is closed
    bounds: _Bounds

def measure(vertices: _Real, triangles: _Int32, threads: int = 1) -> Measured: ...
def self_intersections(vertices: _Real, triangles: _Int32, threads: int = 1) -> int: ...  # pairs of triangles
def bounds(vertices: _Real) -> _Bounds: ...
def place(vertices: _Real, affine: _Float64, out: _Real, threads: int = 1) -> None: ...
def flip(triangles: _Int32, threads: int = 1) -> None: ...
def turn_normals(normals: _Float32, affine: _Float64, threads: int = 1) -> None: ...
def gradient_normals(
    samples: _Samples, vertices: _Real, triangles: _Int32, below: bool, threads: int = 1, complete: bool = True
) -> _Float32: ...
def complete_normals(vertices: _Real, triangles: _Int32, normals: _Float32) -> None: ...
def tilt(
    vertices: _Real, triangles: _Int32, normals: _Float32, affine: _Float64, threads: int = 1
) -> tuple[float, float, float, int]: ...
def triangle_normals(vertices: _Real, triangles: _Int32) -> _Float32: ...
def mesh_normals(
    points: _Float64,
    tets: _Int32,
    hexes: _Int32,
    values: _Real,
    isovalue: float,
    edges: _Int32,
    vertices: _Real,
    triangles: _Int32,
    threads: int = 1,
    complete: bool = True,
) -> _Float32: ...
def format_rows(tag: str, rows: _Real, threads: int = 1) -> bytes: ...
def distances_to(
    vertices: _Float64, triangles: _Int32, points: _Float64, threads: int = 1
) -> tuple[float, float, float]: ...  # of points to the nearest triangle: largest, mean, root mean square
def nine_digits(rows: _Float64, threads: int = 1) -> _Float64: ...  # (n, 3), as the text of format_rows is read
def weld(vertices: _Real, threads: int = 1) -> _Int32: ...  # the earliest vertex of each place; (0,): all differ
def format_faces(triangles: _Int32, with_normals: bool, threads: int = 1) -> bytes: ...
def stl_records(vertices: _Real, triangles: _Int32, threads: int = 1) -> _Bytes: ...
def ply_faces(triangles: _Int32, threads: int = 1) -> _Bytes: ...

# shells: the parts of a mesh that share no vertex, in the order of their first vertices
class Shells(NamedTuple):
    of_vertex: _Int32  # (v,): the number of its shell; -1 for a vertex that no triangle uses
    triangles: npt.NDArray[np.int64]  # (s,), as all below: how many
    areas: _Float64
    volumes: _Float64  # signed; means something only where closed
    closed: _Bytes  # 1 or 0
    around: _Int32  # the smallest closed shell around it that faces the other way, or -1
    piece: _Int32  # the outer shell of its piece: itself, unless it is a bubble

def shells(vertices: _Real, triangles: _Int32, threads: int = 1) -> Shells: ...

class MarchedMesh(NamedTuple):
    vertices: _Real  # the mesh's space; float32 if `single`
    triangles: _Int32
    intersected: int  # cells
    edges: _Int32  # (v, 2) point ids, or (0, 2)

def marching_cells(
    points: _Float64,
    tets: _Int32,
    hexes: _Int32,
    values: _Real,
    isovalue: float,
    threads: int = 1,
    single: bool = False,
    with_edges: bool = False,
) -> MarchedMesh: ...

# statistics: samples as a flat view in memory order
class Extent(NamedTuple):
    minimum: float  # above maximum where no sample is finite
    maximum: float
    nonfinite: int  # samples

def extent(samples: npt.NDArray[Any], threads: int) -> Extent: ...

class Within(NamedTuple):
    minimum: float  # inf, and maximum -inf, where there is no such sample
    maximum: float
    samples: int

# extent_between: of the samples from low to high, both included
def extent_between(samples: npt.NDArray[Any], low: float, high: float, threads: int) -> Within: ...

class Ranked(NamedTuple):
    value: float
    below: int  # samples smaller than it
    equal: int  # samples like it, itself included

# sample_of_rank: the sample with `rank` others before it, of the samples from low to high
def sample_of_rank(samples: npt.NDArray[Any], low: float, high: float, rank: int, threads: int) -> Ranked: ...

# histogram: counts in equal bins from low to high
def histogram(
    samples: npt.NDArray[Any], low: float, high: float, bins: int, threads: int
) -> npt.NDArray[np.uint64]: ...

# thinning: as isocore.methods.mesh_index.IndexPart and MeshIndex explain them
class IndexPart(NamedTuple):
    records: _Int32
    skeleton: _Int32
    low: _Float64
    high: _Float64
    extrema: int
    classes: tuple[int, ...]
    crowded_faces: int
    crowded_cells: tuple[int, int, int]
    collapsed_cells: int
    collapsed_cell: int

class BuiltIndex(NamedTuple):
    tets: IndexPart
    hexes: IndexPart
    original: _Int32

def build_index(
    points: _Float64,
    tets: _Int32,
    hexes: _Int32,
    values: _Real,
    threads: int = 1,
    cells_per_block: int = 0,  # as many as is best
) -> BuiltIndex: ...

# in_order: places and values of the points that `original` names
class OrderedField(NamedTuple):
    points: _Float64
    values: _Real

def in_order(points: _Float64, values: _Real, original: _Int32, threads: int = 1) -> OrderedField: ...

class WalkedMesh(NamedTuple):
    vertices: _Real  # the mesh's space; float32 if `single`
    triangles: _Int32
    seeds: int  # skeleton cells that the isosurface meets
    visited: int  # all cells that it meets
    edges: _Int32  # (v, 2) point ids, or (0, 2)

class VisitedCells(NamedTuple):
    tets: _Int32  # in the index's numbers
    hexes: _Int32
    seeds: int

_PartArrays = tuple[_Int32, _Int32, _Float64, _Float64]  # records, skeleton, low, high

class Index:
    """An index and its mesh, checked once (ValueError), then ready for one isovalue after the other.

    points (p, 3) and values (p,) as the index numbers them; original (p,): their ids in the mesh. Keeps the arrays
    alive and copies none.
    built: the arrays are build_index's own and are taken unchecked; others lead out of bounds.
    """

    def __init__(
        self,
        points: _Float64,
        values: _Real,
        tets: _PartArrays,
        hexes: _PartArrays,
        original: _Int32,
        built: bool = False,
    ) -> None: ...
    def propagate(
        self, isovalue: float, threads: int = 1, single: bool = False, with_edges: bool = False
    ) -> WalkedMesh: ...
    def walk(self, isovalue: float) -> VisitedCells: ...

class WalkedVolume(NamedTuple):
    vertices: _Real  # index space
    triangles: _Int32
    seeds: int
    visited: int
    ambiguous_faces: int
    ambiguous_cells: int

class GridIndex:
    """A volume thinned once, then ready for one isovalue after the other; keeps the samples alive.

    Calls from several threads take turns.
    """

    def __init__(self, samples: _Samples, below: bool = False, capped: bool = False) -> None: ...
    @property
    def cells(self) -> int: ...  # of the volume, those of the cap included
    @property
    def extrema(self) -> int: ...
    @property
    def skeleton_cells(self) -> int: ...
    def propagate(self, isovalue: float, threads: int = 1) -> WalkedVolume: ...

# extrema_graph: the cells that the rival of 1995 registers
def extrema_graph(records: _Int32, corners: int, faces: int, at_extremum: _Bytes) -> _Int32: ...

# joining
class JoinedPoints(NamedTuple):
    number: _Int32  # (n,) of each point, which of those that are left it became
    first: _Int32  # (k,) of each that is left, the lowest point that became it

def join_points(points: _Float64, distance: float = 0.0) -> JoinedPoints: ...

# renumbered: the new number of each corner
def renumbered(corners: _Int32, number: _Int32) -> _Int32: ...

# values_agree: has each point the value of the one it became?
def values_agree(values: _Real, number: _Int32, joined: _Real) -> bool: ...

class LabelCensus(NamedTuple):
    values: _Float64  # ascending
    counts: npt.NDArray[np.uint64]  # samples of each
    not_a_number: int
    too_many: bool  # more than `most` values: the rest was not counted
    not_whole: float  # the first value that is no whole number; 0 if there is none

def label_census(samples: npt.NDArray[Any], most: int) -> LabelCensus: ...

class LabelSolid(NamedTuple):
    vertices: _Float32  # index space
    triangles: _Int32
    shared: _Int32  # of each vertex: its number in the shared mesh

class LabelMesh(NamedTuple):
    vertices: _Float32  # index space
    elements: _Bytes  # axes along which a vertex may move (1, 2, 4), and 8 where it stays
    triangles: _Int32  # counter-clockwise seen from the side of lower rank
    sides: npt.NDArray[np.uint32]  # two ranks per triangle, the higher first

# Of each sheet, the border between two labels: what became of it.
class SimplifiedLabels(NamedTuple):
    pairs: npt.NDArray[np.uint32]  # (s, 2) ranks, the higher first
    vertices_before: npt.NDArray[np.uint32]  # (s,)
    triangles_before: npt.NDArray[np.uint32]  # (s,)
    all_before: int  # triangles of the whole mesh
    all_after: int
    collapses: int  # of the whole mesh
    refused: npt.NDArray[np.uint64]  # (s, 5) by link, shape, outward, back, crossing
    unproved: npt.NDArray[np.uint64]  # (s,)
    error: _Float64  # (s, 3) distances from the sheet's vertices before to it: largest, sum, sum of squares
    error_other: _Float64  # (s, 3) the same, in coordinates times `other`
    back_max: _Float64  # (s,)

class LabelSurfaces:
    @property
    def vertices(self) -> int: ...
    @property
    def triangles(self) -> int: ...
    def smooth(self, rounds: int, threads: int = 1) -> None: ...
    def trim(self) -> None: ...  # gives back to the system what was freed while the mesh was made
    def solid(self, rank: int) -> LabelSolid: ...
    def simplify(
        self,
        max_error: float,
        stretch: tuple[float, float, float] = ...,
        other: tuple[float, float, float] = ...,
        most_triangles: int = 0,
        writing: Writing | None = None,
        threads: int = 1,
    ) -> SimplifiedLabels: ...
    def neighbours(self) -> npt.NDArray[np.uint32]: ...  # (n, 2) ranks that share a border, the higher first
    def shared(self) -> LabelMesh: ...

# From now on all threads of this process take memory from one heap, so that what one frees is there for the others.
def share_one_heap() -> None: ...

# Moves the vertices of marching cubes, in index space, where they lie.
def smooth_isosurface(vertices: _Real, triangles: _Int32, rounds: int, threads: int = 1) -> None: ...
def label_surfaces(
    samples: _Samples, values: _Float64, ranks: npt.NDArray[np.uint32], threads: int = 1
) -> LabelSurfaces: ...
