"""The README's picture: one sample volume by marching cubes and by climbing, seen from the same side.

python docs/pictures/scan.py writes docs/pictures/knot.png.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from raster import Floats, Shades, render, write_png

import isocore

HERE = Path(__file__).resolve().parent
SAMPLE, ISOVALUE = HERE.parents[1] / "sample_volumes" / "knot.nii.gz", 200.0
SIZE = (470, 430)  # of each half, in pixels
MARGIN, GAP = 6, 16
INK, SURFACE = (20, 38, 66), (122, 168, 214)


def seen_from(corners: Floats, turn: float, tilt: float) -> Floats:
    """World to picture: turned about the vertical axis, then tilted; corners: (t, 3, 3), z up."""
    c, s = np.cos(turn), np.sin(turn)
    about_z = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    c, s = np.cos(tilt), np.sin(tilt)
    to_eye = np.array([[1, 0, 0], [0, -s, -c], [0, -c, s]])  # right, down, towards the eye
    turned: Floats = corners @ (to_eye @ about_z).T
    return turned


def halves(turn: float = 1.9, tilt: float = 0.7) -> tuple[list[Shades], list[int]]:
    """Both pictures at the same scale, and their numbers of triangles."""
    field = isocore.read(SAMPLE)
    surfaces = [isocore.extract(field, ISOVALUE, backend=backend) for backend in ("mc", "asc")]
    views = [seen_from(s.vertices.astype(np.float64)[s.triangles], turn, tilt) for s in surfaces]
    low, high = views[0].min(axis=(0, 1)), views[0].max(axis=(0, 1))
    scale = min((n - 2 * MARGIN) / (high[a] - low[a]) for a, n in enumerate(SIZE))
    middle = np.array([SIZE[0] / 2, SIZE[1] / 2, 0.0])
    light = np.array([-0.45, -0.6, 0.66])
    shades = [
        render((view - (low + high) / 2) * scale + middle, light / np.linalg.norm(light), size=SIZE, line=0.75)
        for view in views
    ]
    return shades, [len(s.triangles) for s in surfaces]


def picture() -> Shades:
    """(height, width): marching cubes, a gap, climbing."""
    (left, right), _ = halves()
    return np.hstack([left, np.ones((SIZE[1], GAP)), right])


def main(out: Path = HERE) -> None:
    write_png(out / "knot.png", picture(), INK, SURFACE)


if __name__ == "__main__":
    main(*map(Path, sys.argv[1:]))
