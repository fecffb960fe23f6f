"""Simplification of label maps: the mesh that all labels share keeps its topology and its bound, sheet by sheet."""

from __future__ import annotations

import numpy as np
import pytest

from isocore import _kernels
from isocore.placing import placing_in
from tests.label_oracle import broken_label_promises, regions, surfaces_of


@pytest.mark.parametrize("seed", range(40))
def test_every_label_keeps_its_topology_and_its_bound(seed: int) -> None:
    """Random maps of 2..6 labels: each closed and manifold as before; sheets and curves within the bound both ways."""
    random = np.random.default_rng(seed)
    shape = tuple(int(n) for n in random.integers(2, 6, 3))
    count = int(random.integers(2, 7))
    labels = random.integers(0, count, shape).astype(np.uint8) if seed % 2 else regions(random, shape, count)
    bound = float(random.choice([0.1, 0.3, 0.5, 1.0]))
    assert broken_label_promises(labels, bound, rounds=int(random.choice([0, 20]))) == []


@pytest.mark.parametrize("seed", range(6))
def test_larger_regions_keep_them_too(seed: int) -> None:
    """Long curves, and sheets of many triangles; voxels that are not cubes."""
    random = np.random.default_rng(seed)
    labels = regions(random, (11, 9, 10), 4)
    assert broken_label_promises(labels, 0.5, rounds=20, stretch=(1, 0.5, 0.8)) == []


@pytest.mark.parametrize("most", [0, 500])
def test_threads_change_nothing(most: int) -> None:
    """The same bytes for one, two and four threads, over several boxes; with a number of triangles, too."""
    labels = regions(np.random.default_rng(3), (80, 20, 9), 6)
    meshes = []
    for threads in (1, 2, 4):
        surfaces = surfaces_of(labels, threads)
        surfaces.smooth(5, threads)
        found = surfaces.simplify(0.5, most_triangles=most, threads=threads)
        assert found.all_before > 5 * found.all_after == 5 * surfaces.triangles
        meshes.append([array.tobytes() for array in (*surfaces.shared(), *found) if isinstance(array, np.ndarray)])
    assert meshes[0] == meshes[1] == meshes[2]


def test_curves_are_simplified_as_well() -> None:
    """Three prisms that meet in one straight line: what is left is little more than their corners."""
    labels = np.zeros((14, 14, 16), np.uint8)
    labels[2:7, 2:12, 2:14], labels[7:12, 2:7, 2:14], labels[7:12, 7:12, 2:14] = 1, 2, 3
    surfaces = surfaces_of(labels)
    found = surfaces.simplify(0.5)
    assert found.all_before > 1000 and found.all_after < 60
    assert broken_label_promises(labels, 0.5) == []


def test_no_triangles_meet_where_vertices_are_rounded_far_from_the_origin() -> None:
    """Unless told how vertices are written, some would."""
    labels = regions(np.random.default_rng(1), (40, 36, 12), 6)
    affine = np.array([[0.96, 0.28, 0, 3000], [-0.28, 0.96, 0, 3000], [0, 0, 1, 3000]])
    placing = placing_in((-1, -1, -1, *labels.shape), np.float32, affine)
    meeting = []
    for writing in (None, placing.for_kernels()):
        surfaces = surfaces_of(labels)
        surfaces.smooth(20)
        surfaces.simplify(0.5, writing=writing)
        mesh = surfaces.shared()
        meeting.append(_kernels.self_intersections(placing(mesh.vertices), mesh.triangles))
    assert meeting[0] > meeting[1] == 0
