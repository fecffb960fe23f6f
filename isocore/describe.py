"""What a file holds, and which isovalues make sense: the facts behind `isocore info`."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from isocore.cell_mesh import CellMesh
from isocore.extrema import count_extrema
from isocore.field_facts import FieldFacts
from isocore.histogram import Histogram, histogram
from isocore.isovalue import Chosen, is_two_valued, suggestions
from isocore.readers import ReadOptions, count_volumes, offered_fields, read, times_of
from isocore.segmentation import label_count
from isocore.volume import Volume

if TYPE_CHECKING:
    from isocore.readers.vtk_fields import FieldInfo

_RAS_LETTERS = (("L", "R"), ("P", "A"), ("I", "S"))
_NOT_ALONG_AN_AXIS = 1e-3


@dataclass(frozen=True, slots=True, eq=False)
class Description:
    """Facts by heading, in the order they are shown; the histogram; isovalues worth trying."""

    facts: dict[str, Any]
    spread: Histogram
    isovalues: tuple[Chosen, ...]


def describe(path: Path, options: ReadOptions, *, threads: int = 1) -> Description:
    """Read the file and look at it. Where it holds several steps, volumes or fields and none is chosen, the first."""
    facts: dict[str, Any] = {}
    if times := times_of(path):
        options = replace(options, step=options.step or 0)
        facts |= {"steps": len(times), "times": times, "step": options.step}
    if offered := offered_fields(path):
        options = _choose_field(offered, options, facts)
    volumes = count_volumes(path, options)
    if volumes > 1:
        options = replace(options, volume=options.volume or 0)
        facts |= {"volumes": volumes, "volume": options.volume}
    source = read(path, options)
    spread = histogram(source, threads=threads)
    known = FieldFacts.of(source, spread)
    facts |= _volume_facts(source, known) if isinstance(source, Volume) else _mesh_facts(source, known)
    facts |= {"range": known.range, "nonfinite": known.nonfinite}
    if options.ignore:
        facts["ignored"] = known.ignored
    if labels := label_count(source, spread):
        facts["labels"] = labels
    if isinstance(source, Volume) and is_two_valued(spread):
        facts["mask"] = spread.kept_range
    isovalues = suggestions(spread)
    facts["warnings"] = [*source.warnings, *(warning for chosen in isovalues[:1] for warning in chosen.warnings)]
    return Description(facts, spread, isovalues)


def _choose_field(offered: tuple[FieldInfo, ...], options: ReadOptions, facts: dict[str, Any]) -> ReadOptions:
    facts["point fields"] = [str(field) for field in offered if field.of == "points"]
    facts["cell fields"] = [str(field) for field in offered if field.of == "cells"]
    if options.field is None:
        options = replace(options, field=offered[0].name)
    chosen = next((field for field in offered if field.name == options.field), None)
    if chosen is not None and chosen.components > 1 and options.component is None:
        options = replace(options, component="magnitude")
    if options.component is not None:
        facts["component"] = options.component
    return options


def _volume_facts(volume: Volume, known: FieldFacts) -> dict[str, Any]:
    letters, oblique = orientation(volume)
    return {
        "kind": known.kind,
        "shape": known.shape,
        "dtype": known.dtype,
        "slope": volume.slope,
        "intercept": volume.intercept,
        "spacing": known.spacing,
        "unit": known.unit,
        "space": known.space,
        "orientation": letters,
        "oblique": oblique,
    }


def _mesh_facts(mesh: CellMesh, known: FieldFacts) -> dict[str, Any]:
    minima, maxima = count_extrema(mesh)
    return {
        "kind": known.kind,
        "points": len(mesh.points),
        "cells": mesh.cell_counts,
        "field": known.field,
        "dtype": known.dtype,
        "unit": known.unit,
        "bounds": [mesh.points.min(axis=0).tolist(), mesh.points.max(axis=0).tolist()],
        "minima": minima,
        "maxima": maxima,
    }


def orientation(volume: Volume) -> tuple[str, bool]:
    """Towards which side of the body each index axis grows, as RAS; "" where the space is not known.

    Second: whether an axis lies between two sides.
    """
    if volume.space not in ("ras", "lps", "las"):
        return "", False
    columns: npt.NDArray[np.float64] = volume.in_space("ras").affine[:3, :3] / volume.spacing
    letters = [""] * 3
    left = columns.copy()
    for _ in range(3):
        row, column = np.unravel_index(np.argmax(np.abs(left)), left.shape)
        letters[int(column)] = _RAS_LETTERS[int(row)][int(columns[row, column] > 0)]
        left[row, :] = left[:, column] = 0
    return "".join(letters), bool((np.abs(columns).max(axis=0) < 1 - _NOT_ALONG_AN_AXIS).any())
