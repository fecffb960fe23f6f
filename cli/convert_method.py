"""What `isocore convert` may be asked about the method and its error: one group of its help."""

from __future__ import annotations

import click

from isocore.choices import BACKEND_NAMES, BLOCK_SIZES, TOPOLOGIES

from .groups import GROUPS, option_of
from .values import MaxErrorType

_method = option_of(GROUPS[2])

METHOD = (
    _method(
        "-b",
        "--backend",
        type=click.Choice(BACKEND_NAMES, case_sensitive=False),
        default="auto",
        show_default=True,
        help="asc: few triangles, volumes. mc: marching cubes or tetrahedra. thinning: many isovalues of a mesh. "
        "auto: asc for volumes; for meshes thinning where its index lies beside or it repays itself, else mc.",
    ),
    _method(
        "--max-error",
        type=MaxErrorType(),
        metavar="E",
        show_default="0.5",
        help="How far the surface may lie from marching cubes', both ways: in voxels (0.5), in world units (0.3mm), "
        "in a mesh's own unit, or none.",
    ),
    _method(
        "--simplify/--no-simplify",
        show_default="simplify for asc, and for labels with --max-error",
        default=None,
        help="Fewest triangles within --max-error, both ways; no self-intersections.",
    ),
    _method(
        "--triangles",
        type=click.IntRange(min=1),
        metavar="N",
        show_default="as few as the bound allows",
        help="Simplify to at most N triangles, past 0.5 voxels if need be; a given --max-error holds.",
    ),
    _method(
        "--block-size",
        type=click.Choice([str(size) for size in BLOCK_SIZES]),
        show_default="16",
        help="asc: cells along the edge of the largest box.",
    ),
    _method(
        "--topology",
        type=click.Choice(TOPOLOGIES, case_sensitive=False),
        show_default="faces",
        help="mc: two loops in a cell are two disks (faces), or a tube where the trilinear function says so.",
    ),
    _method(
        "--smooth",
        type=click.IntRange(0, 1000),
        metavar="N",
        show_default="0",
        help="Rounds of smoothing, 20 for a mask or labels: vertices slide along their grid edges, so that no sample "
        "changes sides. Of volumes, by mc.",
    ),
    _method("--cap/--no-cap", show_default=True, help="Close the surface at the volume's border."),
)
