"""Small meshes whose numbers are known from their construction."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from isocore.surface import Surface

Triangles = npt.NDArray[np.int32]


def surface(vertices: object, triangles: object, dtype: str = "float32") -> Surface:
    return Surface(
        np.array(vertices, dtype).reshape(-1, 3),
        np.array(triangles, np.int32).reshape(-1, 3),
        space="ras",
        unit="mm",
    )


def empty() -> Surface:
    return surface([], [])


def tetrahedron() -> Surface:
    """Area 1.5 + sqrt(3) / 2, volume 1 / 6."""
    return surface([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])


def cube() -> Surface:
    """Area 6, volume 1."""
    corners = [[i & 1, i >> 1 & 1, i >> 2] for i in range(8)]
    quads = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    return surface(corners, [t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))])


def torus(around: int = 60, across: int = 30, large: float = 3, small: float = 1) -> Surface:
    """Area near 4 pi^2 R r, volume near 2 pi^2 R r^2, Euler number 0."""
    u, v = np.meshgrid(np.arange(around), np.arange(across), indexing="ij")
    a, b = 2 * np.pi * u / around, 2 * np.pi * v / across
    ring = large + small * np.cos(b)
    places = np.stack([ring * np.cos(a), ring * np.sin(a), small * np.sin(b)], -1)
    return surface(places, _grid_triangles(around, across))


def sphere(centre: tuple[float, float, float] = (0, 0, 0), around: int = 48, rings: int = 23) -> Surface:
    """Unit radius: area near 4 pi, volume near 4/3 pi, both from below."""
    theta = np.pi * np.arange(1, rings + 1) / (rings + 1)
    phi = 2 * np.pi * np.arange(around) / around
    t, p = np.meshgrid(theta, phi, indexing="ij")
    belt = np.stack([np.sin(t) * np.cos(p), np.sin(t) * np.sin(p), np.cos(t)], -1).reshape(-1, 3)
    north, south = len(belt), len(belt) + 1
    triangles: list[tuple[int, int, int]] = []
    for here in range(0, (rings - 1) * around, around):
        below = here + around
        for i, j in enumerate(np.roll(np.arange(around), -1).tolist()):
            triangles += _quad(here + i, below + i, below + j, here + j)
    last = (rings - 1) * around
    for i in range(around):
        triangles += [(north, i, (i + 1) % around), (south, last + (i + 1) % around, last + i)]
    return surface(np.vstack([belt, [[0, 0, 1], [0, 0, -1]]]) + centre, triangles)


def two_spheres() -> Surface:
    """Twice the sphere, apart."""
    return joined(sphere(), sphere((3, 0, 0)))


def moebius_strip(around: int = 20) -> Surface:
    """One side, one border of 2 * around edges, Euler number 0; some edge must be misoriented."""
    a = 2 * np.pi * np.arange(around) / around
    places = [
        [(1 + w * np.cos(t / 2)) * np.cos(t), (1 + w * np.cos(t / 2)) * np.sin(t), w * np.sin(t / 2)]
        for t in a
        for w in (-0.3, 0.3)
    ]
    triangles = []
    for i in range(around):
        low, high = 2 * i, 2 * i + 1
        next_low, next_high = (2 * i + 2, 2 * i + 3) if i + 1 < around else (1, 0)
        triangles += _quad(low, next_low, next_high, high)
    return surface(places, triangles)


def bow_tie() -> Surface:
    """Two tetrahedra that touch at one vertex: closed, no bad edge, one bad vertex."""
    one = tetrahedron()
    mirrored = np.where(one.triangles == 0, 0, one.triangles + 3)[:, ::-1]
    return surface(np.vstack([one.vertices, -one.vertices[1:]]), np.vstack([one.triangles, mirrored]))


def fan(blades: int = 3) -> Surface:
    """Triangles around one common edge."""
    tips = [[np.cos(a), np.sin(a), 0] for a in 2 * np.pi * np.arange(blades) / blades]
    return surface([[0, 0, 0], [0, 0, 1], *tips], [[0, 1, 2 + i] for i in range(blades)])


def cone(sides: int) -> Surface:
    """A disc of `sides` triangles around vertex 0."""
    rim = [[np.cos(a), np.sin(a), 0] for a in 2 * np.pi * np.arange(sides) / sides]
    return surface([[0, 0, 0], *rim], [[0, 1 + i, 1 + (i + 1) % sides] for i in range(sides)])


def joined(a: Surface, b: Surface) -> Surface:
    return surface(np.vstack([a.vertices, b.vertices]), np.vstack([a.triangles, b.triangles + len(a.vertices)]))


def _grid_triangles(around: int, across: int) -> Triangles:
    def at(u: int, v: int) -> int:
        return (u % around) * across + v % across

    triangles: list[tuple[int, int, int]] = []
    for u in range(around):
        for v in range(across):
            triangles += _quad(at(u, v), at(u + 1, v), at(u + 1, v + 1), at(u, v + 1))
    return np.array(triangles, np.int32)


def _quad(a: int, b: int, c: int, d: int) -> list[tuple[int, int, int]]:
    return [(a, b, c), (a, c, d)]
