"""Marching cubes: a volume's full scan, and the place of a volume's surfaces in its world.

Lorensen, Cline 1987; ambiguous faces by Nielson, Hamann 1991. Of a mesh, marching_cells.py scans the cells.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy.typing as npt

from isocore import _kernels
from isocore.cell_mesh import CellMesh
from isocore.choices import TOPOLOGIES
from isocore.errors import OptionError
from isocore.extraction import Ambiguous, Extract, Extraction, Field, Findings, Outlook
from isocore.job import Options
from isocore.methods.normals import Mesh, volume_normals
from isocore.placing import placing_in
from isocore.surface import place_fresh
from isocore.volume import Volume

if TYPE_CHECKING:
    from isocore.methods.simplifying import Simplifier


def prepare_marching_cubes(field: Field, options: Options, outlook: Outlook) -> Extract:
    """Scan the whole field for every isovalue, whatever the outlook."""
    trilinear = options.topology == "trilinear"
    if options.topology not in (None, *TOPOLOGIES):
        raise OptionError(f"--topology {options.topology}: must be {' or '.join(TOPOLOGIES)}")
    if isinstance(field, CellMesh):
        if options.smooth:
            raise OptionError("--smooth: is for volumes; leave it out for meshes")
        if trilinear:
            raise OptionError("--topology trilinear: is for volumes; leave it out for meshes")
        from isocore.methods.marching_cells import prepare_marching_cells  # late: volumes have none

        return prepare_marching_cells(field, options)
    volume, simplify = field, None
    if options.simplify is not None or options.triangles is not None:
        from isocore.methods.simplifying import volume_simplifier  # late: not done by default

        simplify = volume_simplifier(volume, options)

    def extract(isovalue: float) -> Extraction:
        stored = volume.stored_isovalue(isovalue)
        marched = _kernels.marching_cubes(
            volume.samples, stored, volume.inside_is_below, options.cap, options.threads, trilinear
        )
        if options.smooth:
            _kernels.smooth_isosurface(marched.vertices, marched.triangles, options.smooth, options.threads)
        tubes = marched.tubes if trilinear else None
        ambiguous = Ambiguous(faces=marched.ambiguous_faces, cells=marched.ambiguous_cells, tubes=tubes)
        mesh = (marched.vertices, marched.triangles)
        return drawn(volume, mesh, options, Findings(ambiguous=ambiguous), simplify=simplify)

    return extract


def drawn(
    volume: Volume,
    mesh: Mesh,
    options: Options,
    findings: Findings,
    *,
    simplify: Simplifier | None,
    reference: Callable[[], Mesh] | None = None,
    warnings: tuple[str, ...] = (),
) -> Extraction:
    """What becomes of a kernel's index-space mesh: simplified where that is asked for, then placed in the world.

    reference: makes the surface that the mesh stands for, where it is not that itself.
    """
    if simplify is not None:
        placing = placing_in(_kernels.bounds(mesh[0]), mesh[0].dtype.type, volume.affine) if len(mesh[0]) else None
        fewer = simplify(mesh, reference, placing)
        mesh, warnings = (fewer.vertices, fewer.triangles), (*warnings, *fewer.warnings)
        findings = replace(findings, error=fewer.error, simplification=fewer.facts)
    return placed(volume, mesh, options, findings, warnings)


def placed(
    volume: Volume, mesh: Mesh, options: Options, findings: Findings, warnings: tuple[str, ...] = ()
) -> Extraction:
    """A kernel's index-space mesh as a surface in the volume's world, with the normals and angles that belong to it."""
    error = findings.error
    normals = volume_normals(volume, mesh, options, measured=options.angles and error is not None)
    if error is not None:
        findings = replace(findings, error=replace(error, normal_degrees=normals.degrees))
    fields = _carried(volume, mesh) if volume.carried else {}
    surface = place_fresh(
        *mesh, normals.vertices, volume.affine, space=volume.space, unit=volume.unit, threads=options.threads
    )
    surface = replace(surface, fields=fields) if fields else surface
    return Extraction(surface, findings, warnings, normals.seconds, normals.seconds_degrees)


def _carried(volume: Volume, mesh: Mesh) -> dict[str, npt.NDArray[Any]]:
    """What the vertices have of each carried field, while they are where the kernel put them."""
    from isocore.methods.carrying import volume_fields  # late: few volumes carry others

    return volume_fields(volume, mesh[0])
