"""A sheet of paper for line drawings: SVG by hand, on white, with the same bytes on every machine."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from html import escape

Point = tuple[float, float]

INK, GREY, FAINT = "#1c2430", "#8a93a0", "#dfe3e8"
IN, SURFACE, EDGE = "#e0862f", "#8db8e0", "#2b5f92"
GOOD, BAD, NOTHING = "#9fc9a3", "#e7a39b", "#f6f7f8"
#: One for each box of the block.
BOXES = ("#5b8fc7", "#7fb77e", "#c9a24d", "#b77fb0", "#d98c7a", "#7fb5b5", "#a0a0d0")


def _n(value: float) -> str:
    """A coordinate with one digit: rounding hides the last bits of sums, which differ between machines."""
    text = f"{value:.1f}"
    return text.removesuffix(".0").replace("-0", "0") if text in ("-0.0", "0.0") else text.removesuffix(".0")


class Sheet:
    """Grows by what is drawn on it; y points down."""

    def __init__(self, width: int, height: int, title: str) -> None:
        self._head = (
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" height="{height}" '
            f'font-family="Helvetica, Arial, sans-serif" font-size="13">\n<title>{escape(title)}</title>\n'
            f'<rect width="{width}" height="{height}" fill="#fff"/>\n'
        )
        self._parts: list[str] = []

    def line(self, a: Point, b: Point, ink: str = INK, width: float = 1.2, dash: str = "") -> None:
        dashed = f' stroke-dasharray="{dash}"' if dash else ""
        ends = f'x1="{_n(a[0])}" y1="{_n(a[1])}" x2="{_n(b[0])}" y2="{_n(b[1])}"'
        self._parts.append(f'<line {ends} stroke="{ink}" stroke-width="{width}"{dashed}/>')

    def polygon(
        self, corners: Iterable[Point], fill: str, ink: str = INK, width: float = 1, opacity: float = 1
    ) -> None:
        points = " ".join(f"{_n(x)},{_n(y)}" for x, y in corners)
        through = f' fill-opacity="{opacity}"' if opacity < 1 else ""
        stroke = f' stroke="{ink}" stroke-width="{width}" stroke-linejoin="round"' if width else ""
        self._parts.append(f'<polygon points="{points}" fill="{fill}"{through}{stroke}/>')

    def rect(self, x: float, y: float, w: float, h: float, fill: str, ink: str = GREY, width: float = 0.8) -> None:
        self._parts.append(
            f'<rect x="{_n(x)}" y="{_n(y)}" width="{_n(w)}" height="{_n(h)}" fill="{fill}" stroke="{ink}" '
            f'stroke-width="{width}"/>'
        )

    def dot(self, at: Point, radius: float, fill: str, ink: str = INK, width: float = 1) -> None:
        self._parts.append(
            f'<circle cx="{_n(at[0])}" cy="{_n(at[1])}" r="{_n(radius)}" fill="{fill}" stroke="{ink}" '
            f'stroke-width="{width}"/>'
        )

    def text(
        self,
        at: Point,
        words: str,
        *,
        size: float = 13,
        anchor: str = "start",
        ink: str = INK,
        bold: bool = False,
        mono: bool = False,
    ) -> None:
        style = f' font-size="{size:g}"' if size != 13 else ""
        style += f' text-anchor="{anchor}"' if anchor != "start" else ""
        style += ' font-weight="bold"' if bold else ""
        style += ' font-family="Consolas, Menlo, monospace"' if mono else ""
        self._parts.append(f'<text x="{_n(at[0])}" y="{_n(at[1])}" fill="{ink}"{style}>{escape(words)}</text>')

    def arrow(self, a: Point, b: Point, ink: str = INK, width: float = 1.2) -> None:
        """From a to b, with a small head."""
        dx, dy = b[0] - a[0], b[1] - a[1]
        size = (dx * dx + dy * dy) ** 0.5
        dx, dy = 7 * dx / size, 7 * dy / size
        self.line(a, (b[0] - dx, b[1] - dy), ink, width)
        self.polygon(
            [b, (b[0] - dx + dy / 2, b[1] - dy - dx / 2), (b[0] - dx - dy / 2, b[1] - dy + dx / 2)], ink, ink, 0
        )

    def cells(
        self, x: float, y: float, words: Sequence[str], fills: Sequence[str], *, w: float = 24, h: float = 24
    ) -> None:
        """A row of squares with a word in each."""
        for n, (word, fill) in enumerate(zip(words, fills, strict=True)):
            self.rect(x + n * w, y, w, h, fill)
            self.text((x + n * w + w / 2, y + h / 2 + 4.5), word, anchor="middle", size=min(13, h * 0.55))

    def source(self) -> str:
        return self._head + "\n".join(self._parts) + "\n</svg>\n"


class View:
    """From samples to the sheet: x to the right, y to the back, z up."""

    def __init__(self, origin: Point, scale: float) -> None:
        self.origin, self.scale = origin, scale

    def __call__(self, place: Sequence[float]) -> Point:
        x, y, z = (float(n) for n in place)
        u, v = x + 0.46 * y, -z - 0.3 * y
        return self.origin[0] + self.scale * u, self.origin[1] + self.scale * v

    def box(self, sheet: Sheet, low: Sequence[float], high: Sequence[float], ink: str = INK, width: float = 1) -> None:
        """Its twelve edges, the three hidden ones dashed."""
        ends = (low, high)
        for axis in range(3):
            b, c = (a for a in range(3) if a != axis)
            for p in (0, 1):
                for q in (0, 1):
                    start, end = [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]
                    start[b] = end[b] = ends[p][b]
                    start[c] = end[c] = ends[q][c]
                    start[axis], end[axis] = low[axis], high[axis]
                    # Hidden are the edges at the corner that is farthest: low x, high y, low z.
                    far = {0: low[0], 1: high[1], 2: low[2]}
                    hidden = start[b] == far[b] and start[c] == far[c]
                    sheet.line(self(start), self(end), ink, width * 0.7 if hidden else width, "3 3" if hidden else "")
