"""The pictures of surfaces: one sample volume by marching cubes and by climbing, seen from the same side.

python docs/pictures/scan.py [FOLDER] writes knot.png, with edges, and look.png, as a viewer shades them; and cuts.png,
flat: climbing's mesh before simplification, with loops cut by area alone and by the gradient. They are drawn by what
draws `--picture`; `pip install 'isocore[picture]'`.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

import isocore
from isocore import _kernels
from isocore.pictures import Pixels, draw, write_png
from isocore.views import directions, parse_views

HERE = Path(__file__).resolve().parent
SAMPLE, ISOVALUE = HERE.parents[1] / "sample_volumes" / "knot.nii.gz", 200.0
SIZE = (400, 366)  # of each half, in pixels
GAP = 16
VIEW = "-109:40"


def surfaces() -> list[isocore.Surface]:
    """Marching cubes' and isocore's own, with the normals that their files get."""
    field = isocore.read(SAMPLE)
    return [isocore.extract(field, ISOVALUE, backend=backend, normals=True) for backend in ("mc", "asc")]


def cuts() -> list[isocore.Surface]:
    """Climbing's mesh, shaded flat: its loops cut by area, and by the gradient."""
    field = isocore.read(SAMPLE)
    assert isinstance(field, isocore.Volume)
    meshes = [_kernels.climb(field.samples, ISOVALUE, max_error=0.5, tilted=tilted) for tilted in (False, True)]
    return [flat(isocore.Surface(*mesh[:2]).placed(field.affine)) for mesh in meshes]


def flat(surface: isocore.Surface) -> isocore.Surface:
    """Every triangle with corners, and so normals, of its own."""
    corners = np.ascontiguousarray(surface.vertices[surface.triangles].reshape(-1, 3))
    triangles = np.arange(len(corners), dtype=np.int32).reshape(-1, 3)
    return isocore.Surface(corners, triangles, _kernels.triangle_normals(corners, triangles))


def picture(both: list[isocore.Surface], edges: float) -> Pixels:
    """(height, width, 3): one, a gap, the other."""
    gap = np.full((SIZE[1], GAP, 3), 255, np.uint8)
    left, right = (draw(one, directions(parse_views(VIEW), "native"), SIZE, edges=edges) for one in both)
    return np.hstack([left, gap, right])


PICTURES = {"knot.png": (surfaces, 1.1), "look.png": (surfaces, 0.0), "cuts.png": (cuts, 0.0)}


def main(out: Path = HERE) -> None:
    for name, (both, edges) in PICTURES.items():
        with (out / name).open("wb") as stream:
            write_png(stream, picture(both(), edges))


if __name__ == "__main__":
    main(*map(Path, sys.argv[1:]))
