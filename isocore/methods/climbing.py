"""Adaptive skeleton climbing on volumes: what a user may ask of it, checked, and what it found.

The method is that of Poston, Wong, Heng, "Multiresolution Isosurface Extraction with Adaptive Skeleton Climbing",
Computer Graphics Forum 17(3), 1998; kernels/climbing/README.md says where ours departs from it.
"""

from __future__ import annotations

from isocore import _kernels
from isocore.choices import BLOCK_SIZES
from isocore.errors import OptionError
from isocore.extraction import Ambiguous, Climbing, Deviation, Extract, Extraction, Findings, Outlook
from isocore.job import Options
from isocore.methods.bounds import DEFAULT_MAX_ERROR, Bound, bound_for
from isocore.methods.marching_cubes import drawn
from isocore.methods.simplifying import Mesh, volume_simplifier
from isocore.volume import Volume

DEFAULT_BLOCK_SIZE = 16


def prepare_climbing(volume: Volume, options: Options, outlook: Outlook) -> Extract:
    """Check what is asked; before several isovalues, look once at the range of each part of the volume."""
    block_size = check_block_size(options.block_size)
    bound = bound_for(volume, options.max_error or DEFAULT_MAX_ERROR)
    # One more pass over the samples: worth it only where several isovalues then read no more than they cross.
    ranges = _kernels.sample_ranges(volume.samples, options.threads) if outlook.isovalues > 1 else None

    simplify = volume_simplifier(volume, options, default=True)

    def extract(isovalue: float) -> Extraction:
        asked = (volume.stored_isovalue(isovalue), volume.inside_is_below, options.cap, options.threads)
        climbed = _kernels.climb(
            volume.samples,
            *asked,
            block_size,
            bound.distance,
            bound.in_world,
            volume.spacing,
            measured=simplify is None,
            tilted=simplify is not None,
            ranges=ranges,
        )
        findings = climbing_findings(climbed.facts, bound, volume.unit)
        mesh = (climbed.vertices, climbed.triangles)

        def marched() -> Mesh:
            reference = _kernels.marching_cubes(volume.samples, *asked)
            return reference.vertices, reference.triangles

        return drawn(volume, mesh, options, findings, simplify=simplify, reference=marched)

    return extract


def check_block_size(size: int | None) -> int:
    """The block size asked for, or the default."""
    if size is None:
        return DEFAULT_BLOCK_SIZE
    if size not in BLOCK_SIZES:
        raise OptionError(f"--block-size {size}: must be one of {', '.join(map(str, BLOCK_SIZES))}")
    return size


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
