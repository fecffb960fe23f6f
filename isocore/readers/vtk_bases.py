"""Shape functions of curved cells: Bernstein's polynomials on the lattice of a cell, by the degrees along its axes.

G. Farin, "Curves and Surfaces for CAGD", ch. 5 and 17: they are the control weights of Bezier cells, and a basis for
the polynomials of Lagrange cells that stays well conditioned as the degree grows.
"""

from __future__ import annotations

from math import comb, factorial

import numpy as np
import numpy.typing as npt

from isocore.readers.vtk_lattices import hex_nodes, tet_nodes, wedge_nodes
from isocore.readers.vtk_types import Shape

Matrix = npt.NDArray[np.float64]


def basis(shape: Shape, degrees: tuple[int, int, int], at: Matrix) -> Matrix:
    """(q, d) the basis functions at (q, 3) places; one for each node of a lattice, in VTK's order.

    For pyramids, whose shape functions are no polynomials, the polynomials of degree two or one.
    """
    x, y, z = at.T
    p, q, r = degrees
    if shape == "hex":
        i, j, k = np.array(hex_nodes(p, q, r)).T
        return np.asarray(_line(p, x)[:, i] * _line(q, y)[:, j] * _line(r, z)[:, k])
    if shape == "wedge":
        i, j, k = np.array(wedge_nodes(p, r)).T
        weights = np.stack((1 - x - y, x, y))
        return np.asarray(_simplex(np.stack((p - i - j, i, j)), weights) * _line(r, z)[:, k])
    if shape == "tet":
        i, j, k = np.array(tet_nodes(p)).T
        return _simplex(np.stack((p - i - j - k, i, j, k)), np.stack((1 - x - y - z, x, y, z)))
    linear = [np.ones_like(x), x, y, z]
    return np.stack(linear if p == 1 else [*linear, x * x, y * y, z * z, x * y, y * z, z * x], axis=1)


def values_at(shape: Shape, degrees: tuple[int, int, int], nodes: Matrix, at: Matrix) -> Matrix:
    """(q, L) weights of the values at `nodes` (L, 3) for the value at each of `at` (q, 3)."""
    return np.asarray(basis(shape, degrees, at) @ np.linalg.pinv(basis(shape, degrees, nodes)))


def _line(n: int, t: Matrix) -> Matrix:
    """(q, n + 1) Bernstein's polynomials of degree n."""
    return np.stack([comb(n, i) * t**i * (1 - t) ** (n - i) for i in range(n + 1)], axis=1)


def _simplex(powers: npt.NDArray[np.intp], weights: Matrix) -> Matrix:
    """(q, L) the same on a triangle or a tetrahedron. powers: (c, L); weights: (c, q) of its corners."""
    total = int(powers[:, 0].sum())
    factors = [factorial(total) / np.prod([float(factorial(int(n))) for n in column]) for column in powers.T]
    terms = np.prod(weights[:, :, None] ** powers[:, None, :], axis=0)
    return np.asarray(terms * np.array(factors))
