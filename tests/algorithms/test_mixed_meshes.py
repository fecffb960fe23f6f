"""Surfaces through meshes that mix hexahedra, wedges and pyramids stay closed where the cells meet."""

from __future__ import annotations

import numpy as np
import pytest
from cell_shapes import HEX, PYRAMID, TET, WEDGE, block, of_kind

from isocore.backends import BACKENDS, Options, prepare
from isocore.cell_mesh import CellMesh
from isocore.measurements import measure
from isocore.readers.cell_splitting import split_cells

MESH_BACKENDS = [name for name, backend in BACKENDS.items() if CellMesh in backend.accepts]


def mixed_mesh(seed: int) -> CellMesh:
    """A block of bricks: hexahedra, columns of wedges, bricks of six pyramids; low on the border, random inside."""
    random = np.random.default_rng(seed)
    kinds = random.choice(["h", "p", "/", "\\"], size=(4, 4, 4), p=[0.6, 0.2, 0.1, 0.1])
    points, cells = block(kinds, random)
    assert {kind for kind, _ in cells} >= {HEX, PYRAMID}
    split = split_cells(*(of_kind(cells, kind) for kind in (TET, HEX, WEDGE, PYRAMID)))
    values = random.integers(0, 4, len(points)).astype(np.float64)
    border = ((points == points.min(axis=0)) | (points == points.max(axis=0))).any(axis=1)
    values[border] = -1
    return CellMesh(points, split.tets, split.hexes, values)


@pytest.mark.parametrize("backend", MESH_BACKENDS)
@pytest.mark.parametrize("seed", range(12))
def test_a_surface_inside_a_mixed_mesh_is_closed_and_manifold(backend: str, seed: int) -> None:
    """Values tie with the isovalue; no edge is open, none has more than two triangles."""
    measured = measure(prepare(mixed_mesh(seed), backend, Options())(2.0).surface)
    assert measured.triangles > 0
    assert measured.boundary_edges == 0
    assert measured.nonmanifold_edges == 0
    assert measured.misoriented_edges == 0
    assert measured.volume is not None
    assert measured.volume > 0
