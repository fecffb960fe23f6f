"""The error of a surface whose vertices its format has moved: measured again, from the reference to what is written.

A method measures the error of what it draws. Where rounding changes nothing that is the error of the file, too.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from isocore import _kernels
from isocore.extraction import Field, Findings
from isocore.job import Options
from isocore.methods.normals import volume_normals
from isocore.surface import Surface
from isocore.volume import Volume


def remeasured(findings: Findings, field: Field, isovalue: float, surface: Surface, options: Options) -> Findings:
    """The findings with the distance of marching cubes' vertices to `surface`, in voxels and in the world, and angles.

    surface: as it is written, in the world of `field`. Nothing is measured where the method measured nothing, nor of
    label maps, whose reference is not kept.
    """
    if findings.error is None or findings.label is not None:
        return findings
    if not isinstance(field, Volume) or not len(surface.triangles):
        return findings
    threads = options.threads
    stored = field.stored_isovalue(isovalue)
    reference = _kernels.marching_cubes(field.samples, stored, field.inside_is_below, options.cap, threads)
    points = reference.vertices.astype(np.float64)
    vertices = np.empty(surface.vertices.shape)
    _kernels.place(surface.vertices, np.ascontiguousarray(np.linalg.inv(field.affine)[:3]), vertices, threads)
    voxels = _kernels.distances_to(vertices, surface.triangles, points, threads)
    spacing = np.array(field.spacing)
    world = _kernels.distances_to(vertices * spacing, surface.triangles, points * spacing, threads)
    triangles = surface.triangles
    if np.linalg.det(field.affine[:3, :3]) < 0:  # in index space they turn the other way
        triangles = np.ascontiguousarray(triangles[:, ::-1])
    asked = replace(options, normals=False)
    error = replace(
        findings.error,
        normal_degrees=volume_normals(field, (vertices, triangles), asked, measured=True).degrees,
        max=voxels[0],
        mean=voxels[1],
        rms=voxels[2],
        max_world=world[0],
        mean_world=world[1],
        rms_world=world[2],
    )
    return replace(findings, error=error)
