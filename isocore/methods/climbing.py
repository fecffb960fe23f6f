"""Adaptive skeleton climbing on volumes: what a user may ask of it, checked, and what it found.

The method is that of Poston, Wong, Heng, "Multiresolution Isosurface Extraction with Adaptive Skeleton Climbing",
Computer Graphics Forum 17(3), 1998; kernels/climbing/README.md says where ours departs from it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from isocore import _kernels
from isocore.choices import BLOCK_SIZES, MILLIMETRES, MaxError, Unbounded, Voxels
from isocore.errors import OptionError
from isocore.extraction import Ambiguous, Climbing, Deviation, Extract, Extraction, Findings, Outlook
from isocore.job import Options
from isocore.methods.marching_cubes import placed_surface
from isocore.volume import Volume

DEFAULT_BLOCK_SIZE = 16
DEFAULT_MAX_ERROR = Voxels(0.5, "0.5")


@dataclass(frozen=True, slots=True)
class Bound:
    """How far marching cubes' vertices may lie from the surface.

    distance: at most this; in voxels, or with `in_world` in the volume's unit once each index axis is stretched by
        its spacing. Infinite without a bound.
    text: as the user would write it.
    """

    distance: float
    in_world: bool
    text: str


def prepare_climbing(volume: Volume, options: Options, outlook: Outlook) -> Extract:
    """Check what is asked; before several isovalues, look once at the range of each part of the volume."""
    block_size = check_block_size(options.block_size)
    bound = bound_for(volume, options.max_error or DEFAULT_MAX_ERROR)
    # One more pass over the samples: worth it only where several isovalues then read no more than they cross.
    ranges = _kernels.sample_ranges(volume.samples, options.threads) if outlook.isovalues > 1 else None

    def extract(isovalue: float) -> Extraction:
        climbed = _kernels.climb(
            volume.samples,
            volume.stored_isovalue(isovalue),
            volume.inside_is_below,
            options.cap,
            options.threads,
            block_size,
            bound.distance,
            bound.in_world,
            volume.spacing,
            ranges=ranges,
        )
        surface, seconds = placed_surface(volume, climbed.vertices, climbed.triangles, options)
        return Extraction(surface, climbing_findings(climbed.facts, bound, volume.unit), seconds_normals=seconds)

    return extract


def check_block_size(size: int | None) -> int:
    """The block size asked for, or the default."""
    if size is None:
        return DEFAULT_BLOCK_SIZE
    if size not in BLOCK_SIZES:
        raise OptionError(f"--block-size {size}: must be one of {', '.join(map(str, BLOCK_SIZES))}")
    return size


def bound_for(volume: Volume, asked: MaxError) -> Bound:
    """The bound on the surface's error in index space. Raises OptionError where the volume lacks the bound's unit.

    Voxels are counted along the index axes, whatever their spacing. World units are measured in the world: each axis
    is stretched by its spacing, and where the axes are not at right angles the bound shrinks so that it still holds.
    """
    if isinstance(asked, Unbounded):
        return Bound(math.inf, False, asked.text)
    if isinstance(asked, Voxels):
        return Bound(asked.distance, False, asked.text)
    if not volume.unit:
        raise OptionError(
            f"--max-error {asked}: the volume does not say its unit; give the error in voxels, or the volume a spacing"
        )
    if volume.unit not in MILLIMETRES:
        raise OptionError(f"--max-error {asked}: the volume is in {volume.unit}; give the error in voxels")
    directions = np.asarray(volume.affine)[:3, :3] / np.asarray(volume.spacing)
    stretch = max(1.0, float(np.linalg.norm(directions, 2)) * (1 - 1e-12))
    distance = asked.distance * MILLIMETRES[asked.unit] / MILLIMETRES[volume.unit]
    return Bound(distance / stretch, True, asked.text)


def climbing_findings(facts: _kernels.ClimbingFacts, bound: Bound, unit: str) -> Findings:
    """The kernel's facts by the report's keys."""
    voxels, world = facts.error_voxels, facts.error_world
    return Findings(
        error=Deviation(
            max=voxels.max,
            mean=voxels.mean,
            rms=voxels.rms,
            max_world=world.max,
            mean_world=world.mean,
            rms_world=world.rms,
            unit=unit,
            bound=bound.text,
        ),
        ambiguous=Ambiguous(faces=facts.ambiguous_faces, cells=facts.ambiguous_cells),
        climbing=Climbing(
            highrices=facts.highrices,
            split_again=facts.split_again,
            blocks=facts.blocks,
            blocks_visited=facts.blocks_visited,
            blocks_skipped=facts.blocks - facts.blocks_visited,
        ),
    )
