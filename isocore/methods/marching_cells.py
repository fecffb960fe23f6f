"""Marching tetrahedra, and marching cubes on hexahedra: a mesh's full scan, and its surfaces' coordinates.

Doi, Koide 1991; Lorensen, Cline 1987; ambiguous faces by Nielson, Hamann 1991.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from isocore import _kernels
from isocore.cell_mesh import CellMesh
from isocore.extraction import Extract, Extraction, Findings, Search
from isocore.job import Options
from isocore.methods.bending import Curved, bend
from isocore.methods.carrying import mesh_fields
from isocore.methods.normals import mesh_normals
from isocore.methods.simplifying import Simplifier, mesh_simplifier
from isocore.surface import Point, Surface

# float32 is enough while its steps are below this part of a cell: some cells are smaller than the mean one, and
# vertices keep 2^-10 of an edge away from its ends.
_COARSEST_STEP = 2.0**-14

_CAP = "--cap closes volumes only: a mesh's surface stays open where it meets the mesh's boundary"


def prepare_marching_cells(mesh: CellMesh, options: Options) -> Extract:
    """Scan all cells for every isovalue."""
    warnings, single, simplify = mesh_warnings(options), single_precision(mesh), mesh_simplifier(mesh, options)
    edges = needs_edges(mesh, options, simplify)

    def extract(isovalue: float) -> Extraction:
        marched = _kernels.marching_cells(
            mesh.points, mesh.tets, mesh.hexes, mesh.values, isovalue, options.threads, single, edges
        )
        search = Search(cells=mesh.cells, visited=mesh.cells, intersected=marched.intersected)
        findings = Findings(search=search)
        return mesh_surface(mesh, marched, isovalue, options, findings, simplify=simplify, warnings=warnings)

    return extract


def needs_edges(mesh: CellMesh, options: Options, simplify: Simplifier | None) -> bool:
    """Is each vertex' edge asked of the kernel? For normals, angles, carried fields, and to follow curved cells."""
    return bool(options.normals or mesh.curved or mesh.carried or simplify)


def mesh_warnings(options: Options) -> tuple[str, ...]:
    """What an option does not do for meshes."""
    return (_CAP,) if options.cap else ()


def single_precision(mesh: CellMesh, offset: Point = (0.0, 0.0, 0.0)) -> bool:
    """Are the steps of float32 fine enough for the mesh's mean cell, wherever a surface lies? Paid once per mesh.

    The mean cell is the cube as large as the cells would be on average, were the mesh's box full of them. offset: the
    point that coordinates are measured from.
    """
    box = np.array(_kernels.bounds(mesh.points)).reshape(2, 3)  # numpy takes ten times as long for it
    extents, farthest = box[1] - box[0], np.abs(box - offset).max()
    if not farthest < np.finfo(np.float32).max:
        return False
    cell = np.cbrt(np.prod(np.maximum(extents, extents.max() * 1e-6)) / mesh.cells)
    return bool(np.spacing(np.float32(farthest)) <= _COARSEST_STEP * cell)


def mesh_surface(
    mesh: CellMesh,
    found: _kernels.MarchedMesh | _kernels.WalkedMesh,
    isovalue: float,
    options: Options,
    findings: Findings,
    *,
    simplify: Simplifier | None,
    warnings: tuple[str, ...],
) -> Extraction:
    """What becomes of a kernel's mesh, which lies in the world already: bent, and simplified if that is asked for."""
    vertices, triangles, edges = found.vertices, found.triangles, found.edges
    curved: Curved = {}
    if mesh.curved:
        vertices, curved = bend(mesh, edges, vertices, triangles, isovalue)
    fields = mesh_fields(mesh, edges, triangles, len(vertices), isovalue, curved) if mesh.carried else {}
    if simplify is not None:
        fewer = simplify((vertices, triangles))
        vertices, triangles, warnings = fewer.vertices, fewer.triangles, (*warnings, *fewer.warnings)
        edges = edges[fewer.kept[fewer.kept < len(edges)]]  # vertices without an edge come last, and keep their order
        fields = {name: values[fewer.kept] for name, values in fields.items()}
        findings = replace(findings, error=fewer.error, simplification=fewer.facts)
    surface = (vertices, triangles)
    error = findings.error
    normals = mesh_normals(mesh, isovalue, edges, surface, options, measured=options.angles and error is not None)
    if error is not None:
        findings = replace(findings, error=replace(error, normal_degrees=normals.degrees))
    drawn = Surface(*surface, normals.vertices, unit=mesh.unit, fields=fields)
    return Extraction(drawn, findings, warnings, normals.seconds, normals.seconds_degrees)
