"""Volume thinning where the cells are those of a voxel volume: hexahedra that need no adjacency.

Follows Itoh, Yamaguchi, Koyamada, IEEE TVCG 7(1), 2001, as isocore/methods/thinning.py does for meshes. On volumes it
is three to four times slower than marching cubes; isocore/kernels/thinning/grid/README.md says why.
"""

from __future__ import annotations

from isocore import _kernels
from isocore.extraction import Ambiguous, Extract, Extraction, Findings, Search
from isocore.job import Options
from isocore.methods.marching_cubes import drawn
from isocore.methods.simplifying import volume_simplifier
from isocore.volume import Volume

#: Past this share of the vertices, extrema are noise: the skeleton grows with them, and the walk saves little.
NOISE = 0.05


def prepare_grid_thinning(volume: Volume, options: Options) -> Extract:
    """Thin the volume now; then walk for every isovalue. With `options.cap` it counts as surrounded by the outside."""
    index = _kernels.GridIndex(volume.samples, volume.inside_is_below, options.cap)
    advice, simplify = _advice(index), volume_simplifier(volume, options)

    def extract(isovalue: float) -> Extraction:
        walked = index.propagate(volume.stored_isovalue(isovalue), options.threads)
        search = Search(
            cells=index.cells,
            extrema=index.extrema,
            skeleton=index.skeleton_cells,
            seeds=walked.seeds,
            visited=walked.visited,
            intersected=walked.visited,
        )
        ambiguous = Ambiguous(faces=walked.ambiguous_faces, cells=walked.ambiguous_cells)
        findings = Findings(search=search, ambiguous=ambiguous)
        mesh = (walked.vertices, walked.triangles)
        return drawn(volume, mesh, options, findings, simplify=simplify, warnings=advice)

    return extract


def _advice(index: _kernels.GridIndex) -> tuple[str, ...]:
    """Thinning seldom pays on volumes, whose full scan takes 64 cells at a time; on noise it never does."""
    if index.extrema / index.cells > NOISE:
        return (
            f"the field is noise to thinning: {index.extrema:,} extrema, and a skeleton of "
            f"{index.skeleton_cells:,} of {index.cells:,} cells; choose -b mc",
        )
    return ("a volume's full scan takes 64 cells at a time and is faster as a rule: choose -b mc",)
