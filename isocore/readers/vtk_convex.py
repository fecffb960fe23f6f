"""The faces of convex point sets: planes through three points with all others on one side, tried for all triples."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import numpy.typing as npt

from isocore.errors import FieldError
from isocore.readers.vtk_cells import CellArrays
from isocore.readers.vtk_faces import Faces, ragged
from isocore.readers.vtk_types import FACETED

CONVEX_SET = 41
_MOST_POINTS = 32  # a plane is known by one bit for each point in it
_FLAT = 1e-6  # points this near to a plane lie in it, as a part of the cell's size
_NEARLY_FLAT = 16 * _FLAT  # and those that faces of one plane, as far as can be told, may have in common
_CHUNK = 1 << 21  # heights above planes that are computed at a time


def convex_sets(arrays: CellArrays, points: npt.NDArray[np.float64]) -> Faces:
    """The faces of the hull of each set, with all points of one plane in one face. Points inside it are left out."""
    numbers = np.arange(len(arrays.types))[arrays.where(CONVEX_SET)]
    corners, sizes = ragged(arrays, numbers, len(points), FACETED[CONVEX_SET])
    if (wrong := (sizes < 4) | (sizes > _MOST_POINTS)).any():
        raise FieldError(
            f"{arrays.path}: convex point set {numbers[int(np.argmax(wrong))]:,} has {sizes[wrong][0]:,} points, not 4"
            f" to {_MOST_POINTS}; split it into tetrahedra"
        )
    starts = np.cumsum(sizes) - sizes
    cell_of, rings, lengths = [], [], []
    for size in np.unique(sizes).tolist():
        cells = np.flatnonzero(sizes == size)
        step = max(1, _CHUNK // (size * size * size * size // 6))
        for first in range(0, len(cells), step):
            some = cells[first : first + step]
            ids = corners[starts[some][:, None] + np.arange(size)]
            owner, ring = _hulls(points[ids])
            cell_of.append(some[owner])
            lengths.append((ring >= 0).sum(axis=1))
            chosen = np.take_along_axis(ids[owner], np.maximum(ring, 0), axis=1)
            rings.append(chosen[ring >= 0])
    owners, every = np.concatenate(cell_of), np.concatenate(lengths)
    counts = np.bincount(owners, minlength=len(numbers))
    if (flat := counts < 4).any():
        raise FieldError(
            f"{arrays.path}: convex point set {numbers[int(np.argmax(flat))]:,} is flat; write it again without it"
        )
    order = np.argsort(owners, kind="stable")
    ends = np.cumsum(every)
    flat_rings = np.concatenate(rings)
    places = np.repeat((ends - every)[order] - (np.cumsum(every[order]) - every[order]), every[order])
    return Faces(
        FACETED[CONVEX_SET],
        numbers,
        counts,
        every[order],
        flat_rings[places + np.arange(len(flat_rings))],
    )


def _hulls(at: npt.NDArray[np.float64]) -> tuple[npt.NDArray[np.intp], npt.NDArray[np.intp]]:
    """(f,) which of the (m, n, 3) sets each face is of; (f, n) its points in turn, -1 behind the last."""
    n = at.shape[1]
    at = at - at.mean(axis=1, keepdims=True)
    size = np.abs(at).max(axis=(1, 2), keepdims=True)
    at = at / np.where(size > 0, size, 1)
    i, j, k = np.array(list(combinations(range(n), 3))).T
    normals = np.cross(at[:, j] - at[:, i], at[:, k] - at[:, i])
    lengths = np.linalg.norm(normals, axis=2)
    normals /= np.where(lengths > 0, lengths, 1)[..., None]
    heights = np.einsum("mtx,mnx->mtn", normals, at) - np.einsum("mtx,mtx->mt", normals, at[:, i])[..., None]
    inside, outside = (heights <= _FLAT).all(axis=2), (heights >= -_FLAT).all(axis=2)
    planes = (lengths > _FLAT) & (inside ^ outside)
    owner, triple = np.nonzero(planes)
    in_plane = np.abs(heights[owner, triple]) <= _FLAT
    codes = in_plane @ (np.uint64(1) << np.arange(n, dtype=np.uint64))
    _, first = np.unique(np.stack((owner.astype(np.uint64), codes)), axis=1, return_index=True)
    owner, triple = owner[first], triple[first]
    face, member = _whole(owner, in_plane[first], np.abs(heights[owner, triple]) <= _NEARLY_FLAT)
    owner, triple = owner[face], triple[face]
    return owner, _in_turn(at[owner], member, normals[owner, triple])


def _whole(
    owner: npt.NDArray[np.intp], member: npt.NDArray[np.bool_], near: npt.NDArray[np.bool_]
) -> tuple[npt.NDArray[np.intp], npt.NDArray[np.bool_]]:
    """Which faces are left, and their members, where those that three points and nearly a plane have in common are one.

    owner: (f,) ascending. member, near: (f, n) points in the plane of a face, and nearly in it. Of four points that lie
    nearly in one plane, that of one triple may be near enough to the fourth, and that of another one not.
    """
    place = np.arange(len(owner)) - np.searchsorted(owner, owner)
    shape = (owner[-1] + 1, place.max() + 1, member.shape[1]) if len(owner) else (0, 0, member.shape[1])
    inside, beyond = np.zeros(shape, np.float32), np.zeros(shape, np.float32)
    inside[owner, place], beyond[owner, place] = member, ~near
    others = inside.transpose(0, 2, 1)
    joined = (inside @ others >= 3) & (beyond @ others == 0)
    whole = (joined.astype(np.float32) @ inside > 0).astype(np.float32)
    size, common = whole.sum(axis=2), whole @ whole.transpose(0, 2, 1)
    covered = common == size[:, :, None]
    earlier = np.tri(shape[1], k=-1, dtype=bool)
    doubled = covered & ((size[:, None, :] > size[:, :, None]) | (covered.transpose(0, 2, 1) & earlier))
    kept = ~(doubled & (size[:, None, :] > 0)).any(axis=2)[owner, place]
    return np.flatnonzero(kept), whole[owner, place][kept] > 0


def _in_turn(
    at: npt.NDArray[np.float64], member: npt.NDArray[np.bool_], normals: npt.NDArray[np.float64]
) -> npt.NDArray[np.intp]:
    """(f, n) the members of each face by their angle around its middle, without those inside the ring; then -1."""
    rows = np.arange(len(at))[:, None]
    middle = (at * member[..., None]).sum(axis=1) / member.sum(axis=1)[:, None]
    across = np.where(np.abs(normals[:, :1]) < 0.6, [[1.0, 0, 0]], [[0, 1.0, 0]])
    u = np.cross(normals, across)
    u /= np.linalg.norm(u, axis=1)[:, None]
    v = np.cross(normals, u)
    flat = np.stack([np.einsum("fnx,fx->fn", at - middle[:, None], axis) for axis in (u, v)], axis=2)
    angle = np.arctan2(flat[..., 1], flat[..., 0])
    while True:
        order = np.argsort(np.where(member, angle, np.inf), axis=1)
        count = member.sum(axis=1)
        step = np.arange(order.shape[1])
        before = flat[rows, order[rows, (step - 1) % count[:, None]]]
        after = flat[rows, order[rows, (step + 1) % count[:, None]]]
        here = flat[rows, order] - before
        side = (after - before)[..., 0] * here[..., 1] - (after - before)[..., 1] * here[..., 0]
        within = (side > _FLAT) & (step < count[:, None])
        if not within.any():
            return np.where(step < count[:, None], order, -1)
        member = member & ~_scattered(within, order)


def _scattered(flags: npt.NDArray[np.bool_], order: npt.NDArray[np.intp]) -> npt.NDArray[np.bool_]:
    result = np.zeros_like(flags)
    np.put_along_axis(result, order, flags, axis=1)
    return result
