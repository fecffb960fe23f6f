"""Drawings 5 to 7: marks OR-ed up to dikes, prices and the choice of an axis, the partition and its boxes."""

from __future__ import annotations

import numpy as np
from by_hand import ACCEPTED, NOTHING, SPLIT, Block, Box, Label, N, axes, ends, halves, length, start
from by_hand_loops import cut, is_cell
from draw_signs import surface
from svg import BAD, BOXES, EDGE, FAINT, GOOD, GREY, INK, Sheet, View
from svg import NOTHING as EMPTY
from the_volume import climbed

FILLS = {NOTHING: EMPTY, ACCEPTED: GOOD, SPLIT: BAD}
AXES = "xyz"


def again_x(block: Block, j: int, k: int) -> set[Label]:
    """The dikes of one lign along x that are crossed several times: a word of the survey, as a set of labels."""
    steps = np.abs(np.diff(block.inside[:, j, k].astype(int)))
    return {x for x in range(1, 2 * N) if steps[start(x) : start(x) + length(x)].sum() > 1}


def up_one_axis(words: list[set[Label]]) -> dict[Label, set[Label]]:
    """From the samples of an axis to its dikes: a unit has two samples, any other dike two halves."""
    found = {N + n: words[n] | words[n + 1] for n in range(N)}
    for label in range(N - 1, 0, -1):
        found[label] = found[2 * label] | found[2 * label + 1]
    return found


def over_y(block: Block) -> dict[Label, list[set[Label]]]:
    """again_x by the dikes along y, and still by sample k."""
    columns = [up_one_axis([again_x(block, j, k) for j in range(N + 1)]) for k in range(N + 1)]
    return {y: [columns[k][y] for k in range(N + 1)] for y in range(1, 2 * N)}


def named(word: set[Label]) -> str:
    return ",".join(map(str, sorted(word)))


def pyramid() -> Sheet:
    block = climbed()
    sheet = Sheet(900, 330, "The mark again_x, from ligns to boxes: an OR pyramid along y, then along z")
    w, h, top = 32, 28, 70
    fill = {True: BAD, False: "#fff"}

    def grid(left: int, title: str, rows: list[tuple[str, list[set[Label]]]], columns: list[str]) -> None:
        sheet.text((left, 22), title, bold=True)
        for n, name in enumerate(columns):
            sheet.text((left + 34 + n * w + w / 2, top - 8), name, anchor="middle", size=11, ink=GREY)
        for n, (name, words) in enumerate(rows):
            sheet.text((left + 28, top + n * h + 18), name, anchor="end", size=11, ink=GREY)
            sheet.cells(
                left + 34, top + n * h, [named(word) for word in words], [fill[bool(word)] for word in words], w=w, h=h
            )

    ks, labels = [f"k={k}" for k in range(N + 1)], list(range(2 * N - 1, 0, -1))
    grid(
        20,
        "1  by lign: rows j, k",
        [(f"j={j}", [again_x(block, j, k) for k in range(N + 1)]) for j in range(N, -1, -1)],
        ks,
    )
    lines = over_y(block)
    grid(290, "2  OR along y: dikes of y", [(f"y {y}", lines[y]) for y in labels], ks)
    grid(
        570,
        "3  OR along z: all pairs of dikes",
        [(f"y {y}", [up_one_axis(lines[y])[z] for z in range(1, 2 * N)]) for y in labels],
        [f"z {z}" for z in range(1, 2 * N)],
    )
    sheet.arrow((234, 160), (286, 160), GREY)
    sheet.arrow((492, 160), (566, 160), GREY)
    sheet.text(
        (20, 290),
        "In each square: the dikes along x, by label, that are crossed more than once somewhere. "
        "A unit takes the OR of its two samples,",
    )
    sheet.text(
        (20, 310),
        "any other dike the OR of its halves; so a mark of one lign reaches every box that contains it, "
        "and no box is looked at twice.",
    )
    return sheet


def prices() -> Sheet:
    block = climbed()
    sheet = Sheet(900, 350, "The price of halving the whole block along each axis")
    whole: Box = (1, 1, 1)
    choice = block.choices[0]
    for axis in range(3):
        top = 40 + axis * 96
        best = axis == choice.axis
        sheet.text((20, top + 34), f"along {AXES[axis]}", bold=best)
        x = 110.0
        for half in halves(whole, axis):
            price = block.price(half)
            sheet.rect(x, top, 330, 72, "#fff", INK, 1)
            sheet.rect(x + 8, top + 8, 62, 56, FILLS[price], GREY)
            low, high = ends(half, axis)
            sheet.text((x + 39, top + 30), f"{AXES[axis]} {low}-{high}", anchor="middle", size=12)
            sheet.text((x + 39, top + 50), f"price {price}", anchor="middle", size=12)
            if price == SPLIT:
                ways = {a: [block.price(part) for part in halves(half, a)] for a in axes(half)}
                least = min(sum(way) for way in ways.values())
                sheet.text((x + 80, top + 16), "its own halves would cost", size=11, ink=GREY)
                for m, (a, way) in enumerate(ways.items()):
                    sheet.text(
                        (x + 80 + 84 * m, top + 38),
                        f"{AXES[a]}: {way[0]} + {way[1]} = {sum(way)}",
                        size=11,
                        bold=sum(way) == least,
                    )
                sheet.text((x + 80, top + 60), f"one halving further it counts {least}", size=12)
            else:
                sheet.text((x + 80, top + 40), "counts as it is", size=12, ink=GREY)
            x += 342
        sheet.text((806, top + 34), f"= {choice.costs[axis]}", bold=True)
        if best:
            sheet.text((806, top + 52), "chosen", ink=EDGE, bold=True, size=12)
    sheet.text(
        (20, 342),
        "Least cost first, then the longest dike, then the lowest axis. 2 is one box, so 5 is two boxes and a half.",
        ink=GREY,
    )
    return sheet


def _rows(block: Block, box: Box, depth: int) -> list[tuple[int, Box, str]]:
    """A box and all that it is halved to, in preorder: depth, box, and what becomes of it."""
    price = block.price(box)
    if price != SPLIT:
        return [(depth, box, "nothing" if price == NOTHING else "a single cell" if is_cell(box) else "highrice")]
    (choice,) = (choice for choice in block.choices if choice.box == box)
    below = [row for half in halves(box, choice.axis) for row in _rows(block, half, depth + 1)]
    return [(depth, box, f"halved along {AXES[choice.axis]}: {choice.costs[choice.axis]}"), *below]


def exploded(block: Block, box: Box, by: float = 0.34) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    """How far a box is moved from the middle of the block, so that its neighbours can be seen."""
    return np.array([by * (sum(ends(box, a)) / 2 - N / 2) for a in range(3)])


def partition() -> Sheet:
    block = climbed()
    sheet = Sheet(900, 480, "The block, halved down to boxes")
    shown = {box: n for n, box in enumerate(block.boxes)}
    for n, (depth, box, fate) in enumerate(_rows(block, (1, 1, 1), 0)):
        x, y = 20 + 30 * depth, 16 + 24 * n
        words = "  ".join(f"{low}-{high}" for low, high in (ends(box, a) for a in range(3)))
        fill = BOXES[shown[box]] if box in shown else FILLS[block.price(box)]
        if depth:
            sheet.line((x - 15, y + 10), (x, y + 10), GREY)
            sheet.line((x - 15, y - 4), (x - 15, y + 10), GREY)
        sheet.rect(x, y, 104, 20, fill, INK)
        sheet.text(
            (x + 52, y + 14.5), words, anchor="middle", size=12, ink="#fff" if box in shown else INK, bold=box in shown
        )
        sheet.text((x + 112, y + 14.5), fate, size=12, ink=INK if box in shown else GREY)
    cells = sum(map(is_cell, block.boxes))
    sheet.text(
        (20, 468),
        f"{len(block.boxes)} boxes: {len(block.boxes) - cells} of several cells, {cells} single cells. "
        "In each: its samples along x, y and z, ends included. On the right they are moved apart.",
        ink=GREY,
        size=12,
    )
    view = View((500, 420), 54)
    for box in sorted(block.boxes, key=lambda b: (-sum(ends(b, 1)), sum(ends(b, 0)), sum(ends(b, 2)))):
        move = exploded(block, box)
        low, high = (np.array([ends(box, a)[n] for a in range(3)]) + move for n in (0, 1))
        view.box(sheet, list(low), list(high), BOXES[shown[box]], 1.6)
        drawn = [[list(block.place(block.crossings[n]) + move) for n in t] for t in cut(block, box)]
        surface(sheet, view, drawn, BOXES[shown[box]])
    return sheet


def word_layouts() -> Sheet:
    """Three of the shapes of a box, bit by bit."""
    sheet = Sheet(900, 262, "Bit layouts: a Piece, an Edge, and a window of a row's edges")

    def ruler(y: int, name: str, fields: list[tuple[str, int, int]], bits: int) -> None:
        sheet.text((20, y + 20), name, bold=True)
        wide = 740 / bits
        for text, low, high in fields:
            x = 890 - (high + 1) * wide
            sheet.rect(x, y, (high - low + 1) * wide, 30, "#eaf1f8" if text else FAINT, INK, 1)
            sheet.text((x + (high - low + 1) * wide / 2, y + 20), text, anchor="middle", size=11 if bits == 64 else 12)
            sheet.text((x + (high - low + 1) * wide - 2, y + 44), str(low), anchor="end", size=10, ink=GREY)
            if high > low:
                sheet.text((x + 2, y + 44), str(high), size=10, ink=GREY)

    ruler(
        24,
        "Piece, 64 bits",
        [
            ("", 55, 63),
            ("depth", 51, 54),
            ("axes", 48, 50),
            ("length z", 40, 47),
            ("length y", 32, 39),
            ("length x", 24, 31),
            ("low z", 16, 23),
            ("low y", 8, 15),
            ("low x", 0, 7),
        ],
        64,
    )
    ruler(104, "Edge, 32 bits", [("axis", 24, 31), ("k", 16, 23), ("j", 8, 15), ("i", 0, 7)], 32)
    ruler(
        184,
        "Window, 63 bits",
        [
            ("", 63, 63),
            ("edges along z, by i", 42, 62),
            ("edges along y, by i", 21, 41),
            ("edges along x, by i", 0, 20),
        ],
        64,
    )
    sheet.text(
        (20, 252),
        "Highest bit on the left, as numbers are written. The drawings of rows have bit 0 on the left, as samples lie.",
        ink=GREY,
        size=12,
    )
    return sheet
