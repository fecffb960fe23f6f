"""The 5^3 samples that docs/how-climbing-works.md follows: a hill with a corner cut off, and a knob on its top."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from by_hand import Block, axes
from by_hand_loops import Triangle, cut

ISOVALUE = 4.5
#: One slice k a line, its rows j = 4 ... 0 from left to right, i = 0 ... 4 in each.
SLICES = """
99999 99999 99998 99997 88875
99997 99997 99986 89975 66653
88875 89875 88764 67653 44431
66653 67653 66542 45431 22210
44431 45431 44320 23210 00000
"""


def samples() -> npt.NDArray[np.uint8]:
    """(5, 5, 5), i first, in Fortran order as the kernels take it."""
    slices = [[[int(digit) for digit in row] for row in line.split()[::-1]] for line in SLICES.split("\n") if line]
    return np.asfortranarray(np.array(slices, dtype=np.uint8).transpose(2, 1, 0))


def climbed() -> Block:
    return Block(samples(), ISOVALUE)


def marched() -> tuple[Block, list[Triangle]]:
    """The same block with every crossed cell a box of its own, and its triangles as crossings: marching cubes."""
    block = climbed()
    units = range(4, 8)
    cells = [(x, y, z) for z in units for y in units for x in units]
    block.boxes = [cell for cell in cells if block.price(cell)]
    block.kept = [True] * len(block.crossings)
    return block, [triangle for cell in block.boxes for triangle in cut(block, cell)]


def large_boxes(block: Block) -> list[tuple[int, int, int]]:
    return [box for box in block.boxes if axes(box)]
