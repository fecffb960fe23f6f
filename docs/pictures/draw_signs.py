"""Drawings 1 to 4: samples and signs, ligns as words, dikes and labels, what the survey knows of all boxes."""

from __future__ import annotations

from by_hand import NOTHING, SPLIT, N, bit, length, start
from svg import BAD, EDGE, FAINT, GOOD, GREY, IN, INK, SURFACE, Sheet, View
from svg import NOTHING as EMPTY
from the_volume import ISOVALUE, climbed, marched

DEPTH = (0.46, -1.0, 0.3)  # towards the eye


def surface(sheet: Sheet, view: View, triangles_at: list[list[list[float]]], fill: str = SURFACE) -> None:
    """Triangles by their corners, the farthest first."""

    def depth(corners: list[list[float]]) -> float:
        return round(sum(d * p[a] for p in corners for a, d in enumerate(DEPTH)), 6)

    for corners in sorted(triangles_at, key=lambda c: (depth(c), c)):
        sheet.polygon([view(p) for p in corners], fill, EDGE, 0.9, 0.85)


def samples_and_signs() -> Sheet:
    block = climbed()
    sheet = Sheet(900, 350, "The samples of one block and their signs")
    for k in range(N + 1):
        left, top = 20 + k * 118, 50
        sheet.text((left + 50, 30), f"k = {k}", anchor="middle", bold=True)
        for j in range(N + 1):
            for i in range(N + 1):
                x, y = left + i * 22, top + (N - j) * 22
                inside = bool(block.inside[i, j, k])
                sheet.rect(x, y, 22, 22, "#f7d9bd" if inside else "#fff")
                value = int(block.samples[i, j, k])
                sheet.text((x + 11, y + 15.5), str(value), anchor="middle", ink=INK if inside else GREY, bold=inside)
    sheet.text((20, 190), "Five slices of 5 x 5 samples: i to the right, j upwards.")
    sheet.text((20, 210), f"Orange: inside, which is sample >= {ISOVALUE}. From here on only")
    sheet.text((20, 230), "these 125 bits matter; the values come back when vertices are placed.")
    sheet.dot((28, 262), 5, IN)
    sheet.text((42, 267), "inside")
    sheet.dot((108, 262), 4, "#fff", GREY)
    sheet.text((122, 267), "outside")
    sheet.polygon([(190, 255), (210, 255), (210, 269), (190, 269)], SURFACE, EDGE)
    march, drawn = marched()
    sheet.text((218, 267), f"marching cubes: {len(drawn)} triangles, {len(march.crossings)} vertices")
    view = View((645, 300), 40)
    view.box(sheet, (0, 0, 0), (N, N, N), GREY)
    surface(sheet, view, [[list(march.place(march.crossings[n])) for n in t] for t in drawn])
    for k in range(N + 1):
        for j in (0,):
            for i in range(N + 1):
                inside = bool(block.inside[i, j, k])
                sheet.dot(
                    view((i, j, k)), 3.2 if inside else 2.4, IN if inside else "#fff", INK if inside else GREY, 0.8
                )
    sheet.text((630, 328), "i to the right, j to the back, k up;", size=11, ink=GREY)
    sheet.text((630, 343), "dots: the samples with j = 0", size=11, ink=GREY)
    return sheet


def words() -> Sheet:
    block = climbed()
    sheet = Sheet(900, 330, "Ligns as words, and the edges that the surface crosses")
    j, k = 1, 3

    def row(y: int, name: str, bits: list[bool], fill: str, note: str) -> None:
        sheet.text((30, y + 17), name, mono=True)
        sheet.cells(300, y, [str(int(b)) for b in bits], [fill if b else "#fff" for b in bits], w=30)
        sheet.text((480, y + 17), note, ink=GREY)

    here, right, up = ([bool(block.inside[i, b, c]) for i in range(N + 1)] for b, c in ((j, k), (j + 1, k), (j, k + 1)))
    for i in range(N + 1):
        sheet.text((300 + 30 * i + 15, 32), f"i={i}", anchor="middle", size=11, ink=GREY)
    row(40, f"row (j={j}, k={k})", here, "#f7d9bd", "a lign along x: five samples, one word; bit i is sample i")
    row(70, "row >> 1", [*here[1:], False], "#f7d9bd", "the neighbours along x, moved under their bits")
    row(
        100,
        "row ^ row >> 1",
        [a != b for a, b in zip(here, [*here[1:], here[-1]], strict=True)],
        SURFACE,
        "edges along x that are crossed",
    )
    row(150, f"row (j={j + 1}, k={k})", right, "#f7d9bd", "the next row: the other ends of five edges along y")
    row(
        180, "row ^ that", [a != b for a, b in zip(here, right, strict=True)], SURFACE, "edges along y that are crossed"
    )
    row(230, f"row (j={j}, k={k + 1})", up, "#f7d9bd", "the row above: the other ends of five edges along z")
    row(260, "row ^ that", [a != b for a, b in zip(here, up, strict=True)], SURFACE, "edges along z that are crossed")
    sheet.text(
        (30, 312),
        "Lowest bit on the left. The last bit of an edge word along x is cut off: no edge starts at the last sample.",
        ink=GREY,
    )
    return sheet


def dikes() -> Sheet:
    sheet = Sheet(900, 300, "The dikes of a lign of four cells, their labels and their bits")
    left, step = 60, 110
    for label in range(1, 2 * N):
        level = label.bit_length() - 1
        x0, x1, y = left + start(label) * step, left + (start(label) + length(label)) * step, 46 + 52 * level
        sheet.rect(x0 + 3, y, x1 - x0 - 6, 34, ("#cfe0f1", "#dcebd9", "#f4e7cc")[level], INK, 1)
        sheet.text(
            ((x0 + x1) / 2, y + 22), f"dike {label}  (bit {bit(label)})", anchor="middle", size=13 if level < 2 else 12
        )
        if level < 2:
            for child in (2 * label, 2 * label + 1):
                middle = left + (start(child) + length(child) / 2) * step
                sheet.line(((x0 + x1) / 2, y + 34), (middle, y + 52), GREY)
    sheet.line((left, 220), (left + N * step, 220), INK, 2)
    for i in range(N + 1):
        sheet.dot((left + i * step, 220), 5, "#fff", INK, 1.4)
        sheet.text((left + i * step, 243), f"sample {i}", anchor="middle", size=12)
    sheet.text((560, 62), "Dike k starts at k * length - N.")
    sheet.text((560, 84), "Its halves are dikes 2k and 2k + 1.")
    sheet.text((560, 106), "Labels N ... 2N - 1 are the units: single cells.")
    sheet.text((560, 140), "A word has one answer for each dike:")
    order = sorted(range(1, 2 * N), key=bit)
    sheet.cells(560, 150, [str(bit(k)) for k in order], ["#fff"] * 7, w=40, h=20)
    sheet.cells(
        560, 170, [str(k) for k in order], [("#cfe0f1", "#dcebd9", "#f4e7cc")[k.bit_length() - 1] for k in order], w=40
    )
    sheet.text((848, 164), "bit", size=12, ink=GREY)
    sheet.text((848, 187), "dike", size=12, ink=GREY)
    sheet.text((560, 218), "A dike of several cells sits at its middle sample,")
    sheet.text((560, 238), "a unit at its own label: no two share a bit.")
    sheet.text(
        (60, 282),
        "DikeBits::widened<half>: shift by half, OR, keep the starts, put the answer at the middle; "
        "then the dikes twice as long.",
        ink=GREY,
    )
    return sheet


def survey() -> Sheet:
    block = climbed()
    sheet = Sheet(900, 640, "What the survey knows of all 343 boxes of the block")
    fills = {NOTHING: EMPTY, SPLIT: BAD}
    names = ["", *(f"{k}: {start(k)}-{start(k) + length(k)}" for k in range(1, 2 * N))]
    cell, left, top = 84, 66, 44
    for y in range(1, 2 * N):
        row_top = top + (2 * N - 1 - y) * cell
        sheet.text((left - 8, row_top + cell / 2 + 4), f"y {names[y]}", anchor="end", size=11)
        for z in range(1, 2 * N):
            column = left + (z - 1) * cell
            if y == 1:
                sheet.text((column + cell / 2 - 4, top - 8), f"z {names[z]}", anchor="middle", size=11)
            sheet.rect(column, row_top, cell - 6, cell - 6, "#fff", FAINT)
            for x in range(1, 2 * N):
                level, w = x.bit_length() - 1, (cell - 12) / N
                place = (column + 3 + start(x) * w, row_top + 3 + level * 25)
                sheet.rect(*place, length(x) * w, 22, fills.get(block.price((x, y, z)), GOOD), "#fff", 1)
                sheet.text((place[0] + length(x) * w / 2, place[1] + 15), str(x), anchor="middle", size=11)
    for n, (fill, words_) in enumerate(
        ((EMPTY, "nothing crosses it: 0"), (GOOD, "may be one highrice: 2"), (BAD, "must be split: 5 = kSplit"))
    ):
        sheet.rect(672, 60 + 34 * n, 24, 22, fill)
        sheet.text((704, 76 + 34 * n), words_)
    notes = (
        "Each small square is one pair of",
        "dikes along y and z; in it the",
        "seven dikes along x, by label,",
        "as one tree: the whole lign on",
        "top, its halves, the four units.",
        "",
        "All squares are answered by two",
        "words each: nothing_[y][z] and",
        "highrice_[y][z].",
        "",
        "The whole block is x 1, y 1, z 1:",
        "top of the lower left square.",
    )
    for n, note in enumerate(notes):
        sheet.text((672, 190 + 20 * n), note)
    counts = [
        sum(block.price((x, y, z)) == p for x in range(1, 8) for y in range(1, 8) for z in range(1, 8))
        for p in (0, 2, 5)
    ]
    sheet.text((672, 460), f"{counts[0]} hold nothing,", bold=True)
    sheet.text((672, 480), f"{counts[1]} may be one highrice,", bold=True)
    sheet.text((672, 500), f"{counts[2]} must be split.", bold=True)
    return sheet
