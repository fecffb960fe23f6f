"""The pictures of surfaces: one sample volume by marching cubes and by climbing, seen from the same side.

python docs/pictures/scan.py [FOLDER] writes knot.png, with edges, and look.png, as a viewer shades them. They are drawn
by what draws `--picture`; `pip install 'isocore[picture]'`.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

import isocore
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


def picture(edges: float) -> Pixels:
    """(height, width, 3): marching cubes, a gap, climbing."""
    gap = np.full((SIZE[1], GAP, 3), 255, np.uint8)
    left, right = (draw(one, directions(parse_views(VIEW), "native"), SIZE, edges=edges) for one in surfaces())
    return np.hstack([left, gap, right])


PICTURES = {"knot.png": 1.1, "look.png": 0.0}


def main(out: Path = HERE) -> None:
    for name, edges in PICTURES.items():
        with (out / name).open("wb") as stream:
            write_png(stream, picture(edges))


if __name__ == "__main__":
    main(*map(Path, sys.argv[1:]))
