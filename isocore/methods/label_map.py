"""Label maps: the surface of every label, from one mesh in which neighbours share their borders.

Multiple material marching cubes: Hege, Seebass, Stalling, Zoeckler 1997; Wu, Sullivan 2003. Smoothing: Taubin 1995.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from time import perf_counter

import numpy as np
import numpy.typing as npt

from isocore import _kernels
from isocore.errors import FieldError
from isocore.extraction import Extract, Extraction, Field, Findings, LabelFacts, Outlook
from isocore.job import Options
from isocore.labels import MOST_LABELS
from isocore.methods.carrying import volume_fields
from isocore.methods.label_simplifying import simplify_labels
from isocore.methods.simplifying import volume_simplifier
from isocore.placing import placing_in
from isocore.surface import place_fresh
from isocore.volume import Volume

#: A volume that is refused has its values counted up to so many.
_MOST_COUNTED = 10_000_000


def prepare_labels(field: Field, options: Options, outlook: Outlook) -> Extract:
    """Extract all labels at once; what is returned picks one, by its number.

    Raises FieldError where the samples are no labels: fractions, infinities, or more than MOST_LABELS values.
    """
    if not isinstance(field, Volume):
        raise FieldError("is a mesh, which holds no labels; leave out --labels")
    volume, background = field, options.background or 0
    simplifier = volume_simplifier(volume, options, default=options.max_error is not None)
    census = take_census(volume, background)
    ranks = label_ranks(census.values, background)
    surfaces = _kernels.label_surfaces(volume.samples, census.stored, ranks, options.threads)
    surfaces.trim()
    if options.smooth:
        surfaces.smooth(options.smooth, options.threads)
        surfaces.trim()
    # One layer of background lies around the volume. One type of coordinates for all labels: they share borders.
    placing = placing_in((-1, -1, -1, *volume.samples.shape), np.float32, volume.affine)
    fewer = None if simplifier is None else simplify_labels(surfaces, simplifier, placing)
    neighbours = _neighbours(surfaces, census.values, ranks, background)
    rank_of = {int(value): int(rank) for value, rank in zip(census.values, ranks, strict=True) if rank}
    count_of = {int(value): int(count) for value, count in zip(census.values, census.counts, strict=True)}
    voxel = abs(float(np.linalg.det(volume.affine[:3, :3])))
    warnings = census.warnings + (() if fewer is None else fewer.warnings)

    def extract(value: float) -> Extraction:
        label = int(value)
        rank = rank_of.get(label)
        vertices, triangles = _solid(surfaces, rank)
        start = perf_counter()
        normals = _kernels.triangle_normals(vertices, triangles) if options.normals else None
        seconds = perf_counter() - start
        fields = volume_fields(volume, vertices)
        surface = place_fresh(
            vertices,
            triangles,
            normals,
            volume.affine,
            space=volume.space,
            unit=volume.unit,
            threads=options.threads,
            dtype=placing.dtype,
        )
        surface = replace(surface, fields=fields) if fields else surface
        voxels = count_of.get(label, 0)
        facts = LabelFacts(
            value=label, voxels=voxels, voxel_volume=voxels * voxel, neighbours=neighbours.get(label, ())
        )
        error, simplification = (None, None) if fewer is None or rank is None else fewer.of(rank, len(triangles))
        findings = Findings(label=facts, error=error, simplification=simplification)
        return Extraction(surface, findings, warnings, seconds_normals=seconds)

    return extract


@dataclass(frozen=True, slots=True, eq=False)
class Census:
    """The labels of a volume in ascending order: their numbers, the samples' own, and how many samples have each."""

    values: npt.NDArray[np.float64]
    stored: npt.NDArray[np.float64]
    counts: npt.NDArray[np.uint64]
    warnings: tuple[str, ...]


def take_census(volume: Volume, background: int = 0) -> Census:
    """Raises FieldError where the samples are no labels."""
    flat = volume.samples.reshape(-1, order="F")
    found = _kernels.label_census(flat, MOST_LABELS + 1)
    if found.too_many:
        raise _too_many(_kernels.label_census(flat, _MOST_COUNTED))
    values = found.values * volume.slope + volume.intercept
    whole = np.rint(values)
    odd = found.not_whole or next(iter(values[np.abs(values - whole) > 1e-6].tolist()), None)
    if odd is not None:
        raise FieldError(f"holds {odd:.9g}, which is no label: labels are whole numbers; leave out --labels")
    if int((whole != background).sum()) > MOST_LABELS:
        raise _too_many(found)
    order = np.argsort(whole, kind="stable")
    nan = found.not_a_number - volume.ignored
    are = "sample is NaN and counts" if nan == 1 else "samples are NaN and count"
    warnings = (f"{nan:,} {are} as background",) if nan else ()
    return Census(whole[order], found.values[order], found.counts[order], warnings)


def _too_many(census: _kernels.LabelCensus) -> FieldError:
    """What to say of a volume with more values than labels may be."""
    number = f"more than {_MOST_COUNTED:,}" if census.too_many else f"{len(census.values):,}"
    return FieldError(
        f"holds {number} values, and a label map has at most {MOST_LABELS:,} labels; ask for an isovalue with -i, "
        "or leave out --labels"
    )


def label_ranks(values: npt.NDArray[np.float64], background: int) -> npt.NDArray[np.uint32]:
    """Of each value: 0 for background, then by number."""
    labels = values != background
    ranks = np.zeros(len(values), np.uint32)
    ranks[labels] = np.arange(1, int(labels.sum()) + 1)
    return ranks


def _solid(surfaces: _kernels.LabelSurfaces, rank: int | None) -> tuple[npt.NDArray[np.float32], npt.NDArray[np.int32]]:
    """One label's vertices (v, 3), index space, and triangles (t, 3); none for a label that is not there."""
    if rank is None:
        return np.empty((0, 3), np.float32), np.empty((0, 3), np.int32)
    solid = surfaces.solid(rank)
    return solid.vertices, solid.triangles


def _neighbours(
    surfaces: _kernels.LabelSurfaces,
    values: npt.NDArray[np.float64],
    ranks: npt.NDArray[np.uint32],
    background: int,
) -> dict[int, tuple[int, ...]]:
    """Of each label, those on the other side of its triangles, in ascending order."""
    number = {int(rank): int(value) for value, rank in zip(values, ranks, strict=True)} | {0: background}
    found: dict[int, list[int]] = {}
    for one, other in surfaces.neighbours().tolist():
        found.setdefault(number[one], []).append(number[other])
        found.setdefault(number[other], []).append(number[one])
    return {label: tuple(sorted(others)) for label, others in found.items()}
