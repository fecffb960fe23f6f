"""What a reader of VTK's meshes tells its user, and what it refuses to contour."""

from __future__ import annotations

from collections import Counter

from isocore.cell_mesh import Connectivity
from isocore.errors import FieldError
from isocore.readers.cell_splitting import SplitCells
from isocore.readers.vtk_cells import Block
from isocore.readers.vtk_fields import FieldInfo
from isocore.readers.vtk_types import FACETED, FLAT, NAMES


def cell_warnings(path: str, counts: Counter[int], ghosts: int) -> list[str]:
    """Of cells left out; FieldError where no cell fills space."""
    flat = [f"{count:,} {FLAT[number]}" for number, count in counts.items() if number in FLAT]
    if not counts and ghosts:
        raise FieldError(f"{path}: each of its {ghosts:,} cells is a ghost, so there is nothing to contour")
    if len(flat) == len(counts):
        raise FieldError(
            f"{path}: holds only surface cells ({', '.join(flat)}); contouring needs cells that fill space"
        )
    warnings = [f"{cells} enclose nothing and were left out" for cells in flat]
    if ghosts:
        warnings.append(f"{ghosts:,} cells are marked as ghosts (duplicate, refined or hidden); they were left out")
    return warnings


def splitting_warnings(counts: Counter[int], split: SplitCells, turned: tuple[int, int]) -> list[str]:
    """Of cells that were split. turned: how many list a face inside out, and the first of them."""
    faceted = [f"{count:,} {FACETED[number]}" for number, count in counts.items() if number in FACETED]
    warnings = [f"{cells} were split into tetrahedra around their centres" for cells in faceted]
    if turned[0]:
        warnings.append(
            f"{turned[0]:,} polyhedra list faces inside out, the first is {turned[1]:,}; their faces were turned"
        )
    if split.collapsed:
        warnings.append(
            f"{split.collapsed:,} cells name a corner twice; they were split by the corners they have left,"
            " or dropped where those enclose nothing"
        )
    if split.beside:
        warnings.append(
            f"{split.beside:,} hexahedra hang together through faces with cells that were split (wedges, pyramids,"
            " polyhedra, collapsed cells); they were split into tetrahedra too, so that the surface stays closed"
        )
    return warnings


def corner_warnings(blocks: list[Block], left: Counter[str], asked: bool) -> list[str]:
    """Of curved cells that are read by their corners: all where that was asked, else those `left`, by name."""
    reason = "as --corners asks" if asked else "since no degree has their number of points"
    if asked:
        for block in blocks:
            if not block.kind.straight:
                left[block.kind.name] += len(block.cells)
    return [
        f"{count:,} {name} were reduced to their corners, {reason}; the values between the corners are not used"
        for name, count in left.items()
    ]


def joining_warnings(found: Connectivity, field: FieldInfo, distance: float | None) -> list[str]:
    """Of points that were joined, and of values that had to be averaged for it."""
    if not found.joined_points:
        return []
    where = "coincide with others" if distance is None else f"lie within {distance:g} of others"
    warnings = [f"{found.joined_points:,} points {where} and were joined; --keep-duplicates leaves them apart"]
    if found.repeated_cells:
        warnings.append(f"{found.repeated_cells:,} cells are those of an earlier piece once more; they were left out")
    if found.averaged_points:
        warnings.append(
            f"{field.name} is discontinuous: at {found.averaged_points:,} points the joined values differ, by up to"
            f" {found.largest_difference:.3g}; their mean was taken, and --keep-duplicates leaves the cells apart"
        )
    return warnings


def named(counts: Counter[int]) -> dict[str, int]:
    """Cells by the names of their types."""
    result: Counter[str] = Counter()
    for number, count in counts.items():
        result[NAMES[number]] += count
    return dict(result)
