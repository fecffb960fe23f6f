"""Drawings 8 to 11: the edges of a box, the layout's bitmap, a loop, and what is drawn in the end."""

from __future__ import annotations

import numpy as np
from by_hand import Block, Box, N, ends
from by_hand_loops import along, cut, deviation, dropped, faces, kept, loop, neighbours, rim
from draw_signs import surface
from svg import BOXES, EDGE, FAINT, GREY, IN, INK, SURFACE, Sheet, View
from the_volume import climbed, large_boxes, marched

WINDOW = 21  # edges along one axis in a window of DrawnSite
AXES = "xyz"
KEPT, DROPPED = "#2b5f92", "#fff"


def half_block(block: Block) -> Box:
    """The largest box: the one that the worked examples follow."""
    return max(
        large_boxes(block), key=lambda box: int(np.prod([high - low for low, high in (ends(box, a) for a in range(3))]))
    )


def rows_of(block: Block, box: Box) -> dict[tuple[int, int], list[tuple[int, int, int, bool]]]:
    """By row (k, j): axis, i, number and whether it is kept, of the box's crossings that BoxEdges lists."""
    rows: dict[tuple[int, int], list[tuple[int, int, int, bool]]] = {}
    for number in sorted({*kept(block, box), *dropped(block, box)}):
        axis, (i, j, k) = block.crossings[number]
        rows.setdefault((k, j), []).append((axis, i, number, block.kept[number]))
    return rows


def window(edges: list[tuple[int, int]]) -> int:
    """Edges of one row as (axis, i): bit 21 * axis + i."""
    return sum(1 << WINDOW * axis + i for axis, i in edges)


def box_edges() -> Sheet:
    block = climbed()
    box = half_block(block)
    rows = rows_of(block, box)
    sheet = Sheet(900, 116 + 24 * len(rows), "The crossed edges of one box, row by row, in windows of 21 bits an axis")
    left, w = 110, 20
    for axis in range(3):
        x = left + axis * 150
        sheet.text((x + 2.5 * w, 24), f"along {AXES[axis]}", anchor="middle", bold=True)
        sheet.text(
            (x + 2.5 * w, 42), f"bits {WINDOW * axis} ... {WINDOW * axis + N}", anchor="middle", size=11, ink=GREY
        )
    for n, ((k, j), edges) in enumerate(sorted(rows.items())):
        y = 52 + 24 * n
        sheet.text((left - 10, y + 15), f"k={k} j={j}", anchor="end", size=12)
        for axis in range(3):
            for i in range(N + 1):
                here = [(number, is_kept) for a, at, number, is_kept in edges if (a, at) == (axis, i)]
                low, high = ends(box, 0)
                fill = "#fff" if low <= i <= high else FAINT
                sheet.rect(left + axis * 150 + i * w, y, w, 20, fill, GREY)
                for number, is_kept in here:
                    sheet.rect(left + axis * 150 + i * w, y, w, 20, KEPT if is_kept else "#f3d9b8", GREY)
                    sheet.text(
                        (left + axis * 150 + (i + 0.5) * w, y + 14),
                        str(number),
                        anchor="middle",
                        size=11,
                        ink="#fff" if is_kept else INK,
                    )
    bottom = 52 + 24 * len(rows)
    sheet.rect(left, bottom + 14, w, 18, KEPT, GREY)
    sheet.text((left + 28, bottom + 28), "kept: a vertex")
    sheet.rect(left + 150, bottom + 14, w, 18, "#f3d9b8", GREY)
    sheet.text((left + 178, bottom + 28), "dropped: to be measured")
    sheet.rect(left + 350, bottom + 14, w, 18, FAINT, GREY)
    sheet.text((left + 378, bottom + 28), "beyond the box")
    sheet.text((left, bottom + 52), "The numbers are those of the crossings in the layout.", size=11, ink=GREY)
    view = View((578, 340), 50)
    corners = [[ends(box, a)[n] for a in range(3)] for n in (0, 1)]
    view.box(sheet, corners[0], corners[1], BOXES[len(block.boxes) - 1], 2)
    for edges in rows.values():
        for _, _, number, is_kept in edges:
            at = view(list(block.place(block.crossings[number])))
            sheet.dot(at, 4.5 if is_kept else 3, KEPT if is_kept else "#f3d9b8", INK, 0.8)
    return sheet


def layout() -> Sheet:
    block = climbed()
    sheet = Sheet(900, 300, "The layout: a bit for each crossing, and a rank query for a vertex's number")
    per_line, w = 23, 37
    for number, (axis, (i, j, k)) in enumerate(block.crossings):
        x, y = 22 + number % per_line * w, 44 + number // per_line * 104
        is_kept = block.kept[number]
        sheet.text((x + w / 2, y - 6), str(number), anchor="middle", size=11, ink=GREY)
        sheet.rect(x, y, w, 24, KEPT if is_kept else "#fff", GREY)
        sheet.text((x + w / 2, y + 16.5), str(int(is_kept)), anchor="middle", ink="#fff" if is_kept else INK)
        sheet.text((x + w / 2, y + 39), f"{AXES[axis]} {i}{j}{k}", anchor="middle", size=11, ink=GREY)
        if is_kept:
            sheet.text((x + w / 2, y + 57), f"v{block.number(number)}", anchor="middle", size=12, bold=True)
    sheet.text(
        (22, 264),
        "Above each bit its crossing's number; below it axis and lower sample ijk, then the vertex that it is.",
    )
    example = [n for n in range(len(block.crossings)) if block.kept[n]][11]
    sheet.text(
        (22, 286),
        f"Rank query: crossing {example} is kept, and {block.number(example)} of the bits before it are set: "
        f"it is vertex {block.number(example)}.",
    )
    return sheet


def edge_loop() -> Sheet:
    block = climbed()
    box = half_block(block)
    places = along(block, box)
    stops = {number: place >> 16 for number, place in places.items()}
    order = loop(block, box)
    sheet = Sheet(900, 400, "The loop of one box through its kept crossings")
    view = View((40, 350), 66)
    low, high = (np.array([ends(box, a)[n] for a in range(3)]) for n in (0, 1))
    move = np.array([-low[0], 0, 0])
    view.box(sheet, list(low + move), list(high + move), BOXES[len(block.boxes) - 1], 2)
    for other in neighbours(block, box, 0):
        far = [max(ends(other, a)[0], ends(box, a)[0]) for a in range(3)]
        near = [min(ends(other, a)[1], ends(box, a)[1]) for a in range(3)]
        corners = [(0, far[1], far[2]), (0, near[1], far[2]), (0, near[1], near[2]), (0, far[1], near[2])]
        sheet.polygon([view(c) for c in corners], BOXES[block.boxes.index(other)], GREY, 1, 0.25)
    spots = {number: view(list(block.place(block.crossings[number]) + move)) for number in order}
    for a, b in zip(order, [*order[1:], order[0]], strict=True):
        (x, y), (u, v) = spots[a], spots[b]
        short = 6 / ((u - x) ** 2 + (v - y) ** 2) ** 0.5  # of the dot at the end
        sheet.arrow((x, y), (u - short * (u - x), v - short * (v - y)), EDGE, 2)
    for number, at in spots.items():
        is_rim = stops[number] % 2 == 0
        sheet.dot(at, 5, KEPT if is_rim else IN, INK)
        sheet.text((at[0] + 8, at[1] - 6), str(number), size=12, bold=True)
    sheet.text((430, 40), "crossing", bold=True)
    for n, title in enumerate(("faces", "stop", "along", "2^16 * stop + along")):
        sheet.text((510 + (0, 70, 130, 190)[n], 40), title, bold=True)
    for n, number in enumerate(order):
        y = 66 + 26 * n
        lies_on = ",".join(map(str, sorted(faces(box, block.crossings[number]))))
        values = (lies_on, str(stops[number]), str(places[number] % (1 << 16)), str(places[number]))
        sheet.dot((440, y - 4), 5, KEPT if stops[number] % 2 == 0 else IN, INK)
        sheet.text((456, y), str(number))
        for m, value in enumerate(values):
            sheet.text((510 + (0, 70, 130, 190)[m], y), value)
    y = 90 + 26 * len(order)
    notes = (
        "Even stops are crossings on edges of the box: the rim, in order.",
        "Odd stops are the faces between them; a kept crossing within a",
        "face was cut there by a neighbour. It comes as far along as its",
        "way from the face's first rim crossing, as a scalar product with",
        "the way to the second, in half steps.",
        "The tinted rectangles are the padis of face 0: what this box",
        f"shares with each of its {len(neighbours(block, box, 0))} neighbours there.",
        f"Rim: {len(rim(block, box))} crossings. Loop: {len(order)}, so {len(order) - 2} triangles.",
    )
    for n, note in enumerate(notes):
        sheet.text((430, y + 20 * n), note)
    return sheet


def result() -> Sheet:
    block = climbed()
    march, drawn = marched()
    sheet = Sheet(900, 330, "Marching cubes and climbing, and what was left out")
    ours = [triangle for box in block.boxes for triangle in cut(block, box)]
    for n, (blk, triangles, words) in enumerate(
        ((march, drawn, "marching cubes"), (block, ours, "climbing"), (block, ours, "the crossings left out"))
    ):
        view = View((24 + 296 * n, 280), 46)
        view.box(sheet, (0, 0, 0), (N, N, N), GREY)
        corners = [[[float(x) for x in blk.place(blk.crossings[c])] for c in t] for t in triangles]
        surface(sheet, view, corners, SURFACE if n < 2 else "#e8f0f8")
        count = f"{len(triangles)} triangles, {sum(blk.kept)} vertices"
        if n == 2:
            measured = {crossing: far for box in block.boxes for crossing, far in deviation(block, box)}
            for crossing, far in measured.items():
                at = view(list(block.place(block.crossings[crossing])))
                sheet.dot(at, 2.5 + 9 * far, "#f3d9b8", INK, 0.8)
            count = f"{len(measured)} crossings, at most {max(measured.values()):.3f} voxel off"
        sheet.text((24 + 296 * n, 308), words, bold=True)
        sheet.text((24 + 296 * n, 325), count, size=12, ink=GREY)
    return sheet
