"""Marching cubes: a volume's full scan, and the place of a volume's surfaces in its world.

Lorensen, Cline 1987; ambiguous faces by Nielson, Hamann 1991. Of a mesh, marching_cells.py scans the cells.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from time import perf_counter
from typing import Any

import numpy as np
import numpy.typing as npt

from isocore import _kernels
from isocore.cell_mesh import CellMesh
from isocore.choices import TOPOLOGIES
from isocore.errors import OptionError
from isocore.extraction import Ambiguous, Extract, Extraction, Field, Findings, Outlook
from isocore.job import Options
from isocore.methods.marching_cells import prepare_marching_cells
from isocore.methods.simplifying import Mesh, Simplifier, volume_simplifier
from isocore.surface import Surface, place_fresh
from isocore.volume import Volume


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
        return prepare_marching_cells(field, options)
    volume, simplify = field, volume_simplifier(field, options)

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
        fewer = simplify(mesh, reference)
        mesh, warnings = (fewer.vertices, fewer.triangles), (*warnings, *fewer.warnings)
        findings = replace(findings, error=fewer.error, simplification=fewer.facts)
    surface, seconds = placed_surface(volume, *mesh, options)
    return Extraction(surface, findings, warnings, seconds)


def placed_surface(
    volume: Volume, vertices: npt.NDArray[Any], triangles: npt.NDArray[np.int32], options: Options
) -> tuple[Surface, float]:
    """A kernel's index-space mesh as a Surface in the volume's world; normals where asked for, and their seconds."""
    normals, start = None, perf_counter()
    if options.normals:
        below = volume.inside_is_below
        normals = _kernels.gradient_normals(volume.samples, vertices, triangles, below, options.threads)
    seconds = perf_counter() - start
    surface = place_fresh(
        vertices, triangles, normals, volume.affine, space=volume.space, unit=volume.unit, threads=options.threads
    )
    return surface, seconds
