"""The worked examples of docs/how-climbing-works.md: numbers of the one volume, computed and never typed."""

from __future__ import annotations

import numpy as np
from by_hand import ACCEPTED, NOTHING, SPLIT, Block, Box, N, axes, bit, ends, halves
from by_hand_loops import cut, deviation, dropped, is_cell, kept, loop
from draw_boxes import again_x, named, over_y, up_one_axis
from draw_edges import half_block, rows_of, window
from the_volume import climbed, large_boxes, marched

Table = list[list[str]]


def _table(head: list[str], rows: Table) -> str:
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def _binary(labels: set[int]) -> str:
    return "`" + "".join(str(int(any(bit(k) == b for k in labels))) for b in range(1, 2 * N)) + "`"


def _where(box: Box) -> str:
    return " x ".join(f"{low}-{high}" for low, high in (ends(box, a) for a in range(3)))


def words_of_the_whole() -> str:
    """The words behind the answer for all boxes over the whole of y and z."""
    block, labels = climbed(), range(1, 2 * N)
    again = up_one_axis(over_y(block)[1])[1]
    flaws = {x: block.flaws((x, 1, 1)) for x in labels}

    def having(name: str) -> set[int]:
        return {x for x in labels if any(flaw.startswith(name) for flaw in flaws[x])}

    prices = {x: block.price((x, 1, 1)) for x in labels}
    rows = [
        ["again along x", named(again), _binary(again)],
        ["again along y", named(having("again y")), _binary(having("again y"))],
        ["again along z", named(having("again z")) or "none", _binary(having("again z"))],
        ["alternating cell faces", named(having("alternating")) or "none", _binary(having("alternating"))],
        ["crossed both ways along every axis", named(having("both")) or "none", _binary(having("both"))],
        ["corners cut a disk", named(set(labels) - having("no disk")), _binary(set(labels) - having("no disk"))],
        [
            "`nothing_[1][1]`",
            named({x for x in labels if prices[x] == NOTHING}) or "none",
            _binary({x for x in labels if prices[x] == NOTHING}),
        ],
        [
            "`highrice_[1][1]`",
            named({x for x in labels if prices[x] == ACCEPTED}),
            _binary({x for x in labels if prices[x] == ACCEPTED}),
        ],
    ]
    return _table(["word for y = 1, z = 1", "dikes along x", "bits 1 ... 7"], rows)


def marked_ligns() -> str:
    block = climbed()
    found = [(j, k) for j in range(N + 1) for k in range(N + 1) if again_x(block, j, k)]
    rows = [
        [
            f"j = {j}, k = {k}",
            "`" + "".join(str(int(s)) for s in block.inside[:, j, k]) + "`",
            named(again_x(block, j, k)),
            _binary(again_x(block, j, k)),
        ]
        for j, k in found
    ]
    return _table(["lign along x", "signs, i = 0 ... 4", "dikes crossed again", "bits 1 ... 7"], rows)


def costs_of_the_whole() -> str:
    block, whole = climbed(), (1, 1, 1)
    rows = []
    for axis in range(3):
        words = []
        for half in halves(whole, axis):
            price = block.price(half)
            least = min(sum(map(block.price, halves(half, a))) for a in axes(half)) if price == SPLIT else price
            words.append(str(price) if price == least else f"{price}, so {least} one halving further")
        rows.append(["xyz"[axis], *words, str(block.choices[0].costs[axis])])
    return _table(["axis", "lower half", "upper half", "cost"], rows)


def windows() -> str:
    block = climbed()
    box, rows = half_block(block), []
    for (k, j), edges in sorted(rows_of(block, box).items()):
        for_kept, for_dropped = (
            window([(a, i) for a, i, _, is_kept in edges if is_kept == side]) for side in (True, False)
        )
        bits = ", ".join(f"{'xyz'[a]} {i}: {21 * a + i}" for a, i, _, _ in edges)
        rows.append([f"k = {k}, j = {j}", f"`{for_kept:#x}`", f"`{for_dropped:#x}`", bits])
    return _table(["row", "kept", "dropped", "edges, as axis i: bit"], rows)


def counted_boxes() -> str:
    block = climbed()
    rows = []
    for box in block.boxes:
        far = max((d for _, d in deviation(block, box)), default=0.0)
        rows.append(
            [
                _where(box),
                "cell" if is_cell(box) else "box",
                str(len(kept(block, box))),
                str(len(dropped(block, box))),
                " ".join(str(n) for n in loop(block, box)),
                str(len(cut(block, box))),
                f"{far:.3f}" if far else "-",
            ]
        )
    return _table(
        ["samples along x, y, z", "", "kept", "dropped", "loop, by crossing", "triangles", "farthest dropped"], rows
    )


def rank_query() -> str:
    block = climbed()
    word = sum(1 << n for n, is_kept in enumerate(block.kept) if is_kept)
    example = [n for n, is_kept in enumerate(block.kept) if is_kept][11]
    axis, place = block.crossings[example]
    below = word & ((1 << example) - 1)
    row = [n for n, (_, (_, j, k)) in enumerate(block.crossings) if (j, k) == place[1:]]
    return (
        f"The bitmap is `{word:#x}`: {len(block.kept)} crossings, {sum(block.kept)} of them kept. Take the edge along\n"
        f"{'xyz'[axis]} that starts at sample {place}. "
        f"Row (j, k) = ({place[1]}, {place[2]}) starts with crossing {row[0]}; this edge\n"
        f"is number {example - row[0]} in the row, so crossing {example}. "
        f"Its bit is set: it is a vertex. The bits below it\n"
        f"are `{below:#x}`, of which {below.bit_count()} are set: it is vertex {below.bit_count()}."
    )


def in_numbers() -> str:
    block, (march, drawn) = climbed(), marched()
    large = large_boxes(block)
    far = [d for box in block.boxes for _, d in deviation(block, box)]
    return _table(
        ["", "marching cubes", "climbing"],
        [
            ["boxes", f"{len(march.boxes)} cells", f"{len(large)} boxes, {len(block.boxes) - len(large)} cells"],
            ["vertices", str(len(march.crossings)), str(sum(block.kept))],
            ["triangles", str(len(drawn)), str(sum(len(cut(block, box)) for box in block.boxes))],
            ["farthest crossing left out", "-", f"{max(far):.3f} voxel"],
        ],
    )


def flaws_of_halved() -> str:
    block: Block = climbed()
    rows = [
        [
            _where(c.box),
            ", ".join(block.flaws(c.box)),
            "xyz"[c.axis],
            ", ".join(f"{'xyz'[a]} {cost}" for a, cost in c.costs.items()),
            "yes" if np.prod([high - low for low, high in (ends(c.box, a) for a in range(3))]) >= 32 else "no",
        ]
        for c in block.choices
    ]
    return _table(["box", "why it is no highrice", "halved along", "costs", "looked further"], rows)


BLOCKS = (
    words_of_the_whole,
    marked_ligns,
    costs_of_the_whole,
    flaws_of_halved,
    windows,
    rank_query,
    counted_boxes,
    in_numbers,
)
