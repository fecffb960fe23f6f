"""Volume thinning and isosurface propagation: thin a mesh once, contour it many times.

Follows Itoh, Yamaguchi, Koyamada, "Volume Thinning for Automatic Isosurface Propagation", IEEE Visualization 1996,
and "Fast Isosurface Generation Using the Volume Thinning Algorithm", IEEE TVCG 7(1), 2001; isocore/kernels/thinning
says where it departs.
"""

from __future__ import annotations

from pathlib import Path

from isocore import _kernels
from isocore.cell_mesh import CellMesh
from isocore.errors import InputError, IsocoreError
from isocore.extraction import Extract, Extraction, Field, Findings, Outlook, Search
from isocore.job import Options
from isocore.methods.grid_thinning import NOISE, prepare_grid_thinning
from isocore.methods.index_file import AGAIN, is_of, load_index
from isocore.methods.marching_cells import mesh_surface, mesh_warnings, needs_edges, single_precision
from isocore.methods.mesh_index import IndexPart, MeshIndex
from isocore.methods.simplifying import mesh_simplifier


def build_index(mesh: CellMesh, threads: int = 1, *, cells_per_block: int = 0) -> MeshIndex:
    """Thin the mesh; linear in its cells, and the same for any number of threads.

    cells_per_block: blocks of cells are thinned apart, then what remains of them; this changes the skeleton only. 0 for
    as many as is best.
    """
    built = _kernels.build_index(mesh.points, mesh.tets, mesh.hexes, mesh.values, threads, cells_per_block)
    return MeshIndex(IndexPart(*built.tets), IndexPart(*built.hexes), built.original)


def prepare_thinning(field: Field, options: Options, outlook: Outlook) -> Extract:
    """Thin the field once, then walk for every isovalue."""
    if isinstance(field, CellMesh):
        return _prepare_mesh(field, options, outlook)
    return prepare_grid_thinning(field, options)


def _prepare_mesh(mesh: CellMesh, options: Options, outlook: Outlook) -> Extract:
    """Take the index from `outlook.index` if it matches, else thin now; then walk for every isovalue."""
    index, ready, warnings = _index_of(mesh, outlook, options.threads)
    simplify = mesh_simplifier(mesh, options)
    with_edges, single = needs_edges(mesh, options, simplify), single_precision(mesh)
    told = (*mesh_warnings(options), *warnings, *_oddities(index))
    extrema, skeleton = index.extrema, index.skeleton_cells

    def extract(isovalue: float) -> Extraction:
        walked = ready.propagate(isovalue, options.threads, single, with_edges)
        search = Search(
            cells=mesh.cells,
            extrema=extrema,
            skeleton=skeleton,
            seeds=walked.seeds,
            visited=walked.visited,
            intersected=walked.visited,
        )
        return mesh_surface(
            mesh, walked, isovalue, options, Findings(search=search), simplify=simplify, warnings=told
        )

    return extract


def _index_of(
    mesh: CellMesh, outlook: Outlook, threads: int
) -> tuple[MeshIndex, _kernels.Index, tuple[str, ...]]:
    """The index beside the mesh if it matches, else a new one; and what to tell the user about that choice."""
    warnings = []
    if outlook.index is not None:
        try:
            index = load_index(outlook.index, mesh)
            return index, _checked(outlook.index, mesh, index, threads), ()
        except IsocoreError as error:
            warnings.append(f"{error}; thinned anew")
    index = build_index(mesh, threads)
    if not outlook.named:
        return index, ready_index(mesh, index, threads, built=True), tuple(warnings)
    if outlook.isovalues == 1:
        warnings.append("one isovalue does not repay thinning: choose -b mc, or keep the index with `isocore index`")
    if index.extrema > NOISE * len(mesh.points):
        share = 100 * index.extrema / len(mesh.points)
        warnings.append(
            f"{share:.0f} % of the points are extrema, so the field is noise to thinning and its skeleton holds "
            f"{index.skeleton_cells:,} of {mesh.cells:,} cells: -b mc may be faster"
        )
    return index, ready_index(mesh, index, threads, built=True), tuple(warnings)


def _checked(path: Path, mesh: CellMesh, index: MeshIndex, threads: int) -> _kernels.Index:
    """A loaded index, ready. Raises InputError where it names what is not there, whatever its checksum says."""
    try:
        ready = ready_index(mesh, index, threads)
        if not is_of(index, mesh):
            raise ValueError("it has other cells or values than the mesh")
        return ready
    except ValueError as error:
        raise InputError(f"{path}: is damaged ({error}); {AGAIN}") from error


def _oddities(index: MeshIndex) -> tuple[str, ...]:
    """One line per kind of cell that is not glued to its neighbours, naming the first offender."""
    warnings = []
    for kind, part in (("tetrahedra", index.tets), ("hexahedra", index.hexes)):
        if part.crowded_faces:
            cells = ", ".join(str(cell) for cell in part.crowded_cells)
            warnings.append(
                f"{part.crowded_faces:,} faces are shared by more than two {kind}, the first by {cells}: "
                "contoured, but each side for itself"
            )
        if part.collapsed_cells:
            warnings.append(
                f"{part.collapsed_cells:,} {kind} name a point twice, the first is {part.collapsed_cell}: "
                "contoured, but each for itself"
            )
    return tuple(warnings)


def ready_index(mesh: CellMesh, index: MeshIndex, threads: int = 1, *, built: bool = False) -> _kernels.Index:
    """The mesh and its index as the kernel takes them: checked here once, then ready for any isovalue.

    `propagate` draws the isosurface as a full scan finds it; `walk` is its search alone, in the index's numbers.
    Raises ValueError if the index names what is not there. built: it is of this mesh and this process, and not checked.
    """
    tets, hexes = ((part.records, part.skeleton, part.low, part.high) for part in index.parts)
    points, values = _kernels.in_order(mesh.points, mesh.values, index.original, threads)
    return _kernels.Index(
        points=points,
        values=values,
        tets=tets,
        hexes=hexes,
        original=index.original,
        built=built,
    )
