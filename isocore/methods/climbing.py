"""Adaptive skeleton climbing on volumes: what a user may ask of it, checked, and what it found.

The method is that of Poston, Wong, Heng, "Multiresolution Isosurface Extraction with Adaptive Skeleton Climbing",
Computer Graphics Forum 17(3), 1998; kernels/climbing/README.md says where ours departs from it.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from typing import Any

import numpy as np

from isocore import _kernels
from isocore.errors import OptionError
from isocore.extraction import Extract, Extraction, Options
from isocore.methods.marching_cubes import placed_surface
from isocore.volume import Volume

BLOCK_SIZES = (1, 2, 4, 8, 16, 32)
DEFAULT_BLOCK_SIZE = 16
DEFAULT_MAX_ERROR = "0.5"

_LENGTH = re.compile(r"(?P<number>[^a-zµ]+?)\s*(?P<unit>[a-zµ]*)", re.IGNORECASE)
_MILLIMETRES = {"mm": 1.0, "um": 1e-3, "µm": 1e-3, "m": 1e3}


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


def prepare_climbing(volume: Volume, options: Options) -> Extract:
    """Check what is asked; before several isovalues, look once at the range of each part of the volume."""
    block_size = check_block_size(options.block_size)
    bound = bound_for(volume, options.max_error)
    # One more pass over the samples: worth it only where several isovalues then read no more than they cross.
    ranges = _kernels.sample_ranges(volume.samples, options.threads) if options.isovalues > 1 else None

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
        surface = placed_surface(volume, climbed.vertices, climbed.triangles, options)
        return Extraction(surface, climbing_facts(climbed.facts, bound, volume.unit))

    return extract


def check_block_size(size: int | None) -> int:
    """The block size asked for, or the default."""
    if size is None:
        return DEFAULT_BLOCK_SIZE
    if size not in BLOCK_SIZES:
        raise OptionError(f"--block-size {size}: must be one of {', '.join(map(str, BLOCK_SIZES))}")
    return size


def parse_max_error(text: str | None) -> tuple[float, str]:
    """The number and the unit ("" for voxels) of an error bound; infinity for "none". Checks all but the volume."""
    text = DEFAULT_MAX_ERROR if text is None else text.strip()
    if text.lower() == "none":
        return math.inf, ""
    match = _LENGTH.fullmatch(text)
    wrong = OptionError(f"--max-error {text}: is no length; write voxels (0.5), world units (0.3mm), or none")
    if match is None:
        raise wrong
    unit = match["unit"].lower()
    if unit not in ("", "voxel", "voxels", *_MILLIMETRES):
        raise OptionError(f"--max-error {text}: {match['unit']} is no unit known here; write voxels (0.5) or 0.3mm")
    try:
        number = float(match["number"])
    except ValueError:
        raise wrong from None
    if not math.isfinite(number) or number < 0:
        raise OptionError(f"--max-error {text}: must be a finite length, not negative; none lifts the bound")
    return number, unit if unit in _MILLIMETRES else ""


def bound_for(volume: Volume, text: str | None) -> Bound:
    """The bound on the surface's error in index space.

    Voxels are counted along the index axes, whatever their spacing. World units are measured in the world: each axis
    is stretched by its spacing, and where the axes are not at right angles the bound shrinks so that it still holds.
    """
    number, unit = parse_max_error(text)
    said = DEFAULT_MAX_ERROR if text is None else text.strip()
    if not unit:
        return Bound(number, False, said)
    if not volume.unit:
        raise OptionError(
            f"--max-error {said}: the volume does not say its unit; give the error in voxels, or the volume a spacing"
        )
    if volume.unit not in _MILLIMETRES:
        raise OptionError(f"--max-error {said}: the volume is in {volume.unit}; give the error in voxels")
    directions = np.asarray(volume.affine)[:3, :3] / np.asarray(volume.spacing)
    stretch = max(1.0, float(np.linalg.norm(directions, 2)) * (1 - 1e-12))
    distance = number * _MILLIMETRES[unit] / _MILLIMETRES[volume.unit]
    return Bound(distance / stretch, True, said)


def climbing_facts(facts: _kernels.ClimbingFacts, bound: Bound, unit: str) -> dict[str, Any]:
    """The kernel's facts by the report's keys."""
    error: dict[str, Any] = facts.error_voxels._asdict()
    error |= {f"{name}_world": value for name, value in facts.error_world._asdict().items()}
    return {
        "error": error | {"unit": unit, "bound": bound.text},
        "ambiguous": {"faces": facts.ambiguous_faces, "cells": facts.ambiguous_cells},
        "climbing": {
            "highrices": facts.highrices,
            "split_again": facts.split_again,
            "blocks": facts.blocks,
            "blocks_visited": facts.blocks_visited,
            "blocks_skipped": facts.blocks - facts.blocks_visited,
        },
    }
