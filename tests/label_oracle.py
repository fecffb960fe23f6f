"""What simplification promises of label maps, told by brute force: sheet by sheet, curve by curve, label by label."""

from __future__ import annotations

from collections import defaultdict
from typing import Any

import numpy as np
import numpy.typing as npt

from isocore import _kernels
from tests.simplification_oracle import ROUNDING, Mesh, Points, broken_promises, corners, distances, meeting_pairs

Labels = npt.NDArray[Any]
Pair = tuple[int, int]


def surfaces_of(labels: Labels, threads: int = 1) -> _kernels.LabelSurfaces:
    """All values are labels, 0 is background."""
    values = np.arange(256, dtype=np.float64)
    return _kernels.label_surfaces(np.asfortranarray(labels), values, values.astype(np.uint32), threads)


def regions(random: np.random.Generator, shape: tuple[int, ...], labels: int) -> Labels:
    """A map of blobs: each sample has the label of the nearest of some seeds, and a few have any."""
    places = np.stack(np.indices(shape), -1).reshape(-1, 3).astype(float)
    seeds = random.uniform(0, max(shape), (3 * labels, 3))
    nearest = np.linalg.norm(places[:, None] - seeds, axis=2).argmin(1) % labels
    noise = random.random(len(places)) < random.choice([0, 0.02, 0.2])
    return np.where(noise, random.integers(0, labels, len(places)), nearest).reshape(shape).astype(np.uint8)


def broken_label_promises(
    labels: Labels, bound: float, *, rounds: int = 0, stretch: tuple[float, ...] = (1, 1, 1)
) -> list[str]:
    """What the simplified surfaces of a map break, in words."""
    surfaces = surfaces_of(labels)
    surfaces.smooth(rounds)
    before, solids_before = surfaces.shared(), _solids(labels, surfaces)
    surfaces.simplify(bound, stretch=stretch)
    after, solids = surfaces.shared(), _solids(labels, surfaces)
    broken = []
    for label, solid in solids.items():
        own = broken_promises(solid[:2], solids_before[label][:2], bound, stretch=stretch, meetings=False)
        measured = _kernels.measure(*solid[:2], 1)
        flaws = ("boundary_edges", "nonmanifold_edges", "nonmanifold_vertices", "misoriented_edges", "degenerate")
        own += [f"{getattr(measured, flaw)} {flaw}" for flaw in flaws if getattr(measured, flaw)]
        broken += [f"label {label}: {what}" for what in own]
    if meeting := meeting_pairs(after.vertices, after.triangles):
        broken.append(f"{len(meeting)} pairs of triangles meet")
    broken += _sheets(before, after, bound, stretch) + _curves(before, after, bound, stretch)
    if not _is_shared(solids, surfaces.solid(0)):
        broken.append("neighbours do not share their border")
    return broken


def _solids(labels: Labels, surfaces: _kernels.LabelSurfaces) -> dict[int, _kernels.LabelSolid]:
    return {int(label): surfaces.solid(int(label)) for label in np.unique(labels) if label}


def _is_shared(solids: dict[int, _kernels.LabelSolid], background: _kernels.LabelSolid) -> bool:
    """All triangles of all labels and of the background cancel: each is there once each way round."""
    turned: dict[tuple[int, ...], int] = defaultdict(int)
    for solid in [*solids.values(), background]:
        for t in solid.shared[solid.triangles].tolist():
            least = t.index(min(t))
            a, b, c = t[least:] + t[:least]
            turned[(a, *sorted((b, c)))] += 1 if b < c else -1
    return not any(turned.values())


def _by_sheet(mesh: _kernels.LabelMesh) -> dict[Pair, Mesh]:
    pairs, which = np.unique(mesh.sides, axis=0, return_inverse=True)
    return {(int(a), int(b)): (mesh.vertices, mesh.triangles[which == n]) for n, (a, b) in enumerate(pairs)}


def _sheets(
    before: _kernels.LabelMesh, after: _kernels.LabelMesh, bound: float, stretch: tuple[float, ...]
) -> list[str]:
    broken = []
    was, is_ = _by_sheet(before), _by_sheet(after)
    if was.keys() != is_.keys():
        return ["a sheet is gone"]
    for pair, (vertices, triangles) in was.items():
        mine = corners(is_[pair], stretch)
        there = distances(vertices[np.unique(triangles)] * np.array(stretch), mine).max()
        back = distances(_points(mine), corners((vertices, triangles), stretch)).max()
        if max(there, back) > bound + ROUNDING:
            broken.append(f"sheet {pair}: {there} there, {back} back")
    return broken


def _points(shapes: Points, steps: int = 4) -> Points:
    """(n, 3): places on triangles, or on sides, of all corners' shares of some steps."""
    n = shapes.shape[1]
    shares = np.array([s for s in np.ndindex(*[steps + 1] * n) if sum(s) == steps]) / steps
    return np.einsum("sc,tcd->tsd", shares, shapes).reshape(-1, 3)


def _by_curve(mesh: _kernels.LabelMesh, stretch: tuple[float, ...]) -> dict[frozenset[int], Points]:
    """The sides at which three labels and more meet, by which labels."""
    sheets: dict[tuple[int, ...], list[int]] = defaultdict(list)
    count: dict[tuple[int, ...], int] = defaultdict(int)
    for triangle, sides in zip(mesh.triangles.tolist(), mesh.sides.tolist(), strict=True):
        for n in range(3):
            side = tuple(sorted((triangle[n], triangle[n - 1])))
            sheets[side] += sides
            count[side] += 1
    curves: dict[frozenset[int], list[Any]] = defaultdict(list)
    for side, labels in sheets.items():
        if count[side] > 2:
            curves[frozenset(labels)].append(mesh.vertices[list(side)].astype(np.float64) * stretch)
    return {labels: np.array(sides) for labels, sides in curves.items()}


def _curves(
    before: _kernels.LabelMesh, after: _kernels.LabelMesh, bound: float, stretch: tuple[float, ...]
) -> list[str]:
    was, is_ = _by_curve(before, stretch), _by_curve(after, stretch)
    if was.keys() != is_.keys():
        return ["a curve is gone"]
    broken = []
    for labels, sides in was.items():
        there = distances(_points(sides), _flat(is_[labels])).max()
        back = distances(_points(is_[labels]), _flat(sides)).max()
        if max(there, back) > bound + ROUNDING:
            broken.append(f"curve of {sorted(labels)}: {there} there, {back} back")
    return broken


def _flat(sides: Points) -> Points:
    """Sides as triangles without an area."""
    return np.concatenate([sides, sides[:, 1:]], axis=1)
