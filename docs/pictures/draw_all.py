"""Draw docs/pictures/*.svg again, and fill the worked examples into docs/how-climbing-works.md.

python docs/pictures/draw_all.py [FOLDER] writes the drawings there instead, and the page as well. The README's
picture is scan.py's.
"""

from __future__ import annotations

import re
import sys
from pathlib import Path

import draw_boxes
import draw_edges
import draw_signs
import worked

HERE = Path(__file__).resolve().parent
PAGE = HERE.parent / "how-climbing-works.md"
DRAWINGS = (
    draw_signs.samples_and_signs,
    draw_signs.words,
    draw_signs.dikes,
    draw_signs.survey,
    draw_boxes.pyramid,
    draw_boxes.prices,
    draw_boxes.partition,
    draw_boxes.word_layouts,
    draw_edges.box_edges,
    draw_edges.layout,
    draw_edges.edge_loop,
    draw_edges.result,
)


def filled(page: str) -> str:
    """The page with every block between `<!-- worked: name -->` and `<!-- end -->` computed again."""
    computed = {block.__name__: block for block in worked.BLOCKS}

    def fill(match: re.Match[str]) -> str:
        return f"{match[1]}\n\n{computed.pop(match[2])()}\n\n<!-- end -->"

    page = re.sub(r"(<!-- worked: (\w+) -->)\n.*?<!-- end -->", fill, page, flags=re.DOTALL)
    if computed:
        raise ValueError(f"the page has no place for {', '.join(computed)}")
    return page


def main(out: Path = HERE) -> None:
    for draw in DRAWINGS:
        (out / f"{draw.__name__}.svg").write_text(draw().source(), encoding="utf-8")
    page = PAGE if out == HERE else out / PAGE.name
    page.write_text(filled(PAGE.read_text(encoding="utf-8")), encoding="utf-8")


if __name__ == "__main__":
    main(*map(Path, sys.argv[1:]))
