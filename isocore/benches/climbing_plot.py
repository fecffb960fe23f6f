"""Triangles and time against block size, as in the paper's figures, drawn as SVG without a plotting library."""

from __future__ import annotations

from collections.abc import Sequence
from math import ceil, floor, log10

from isocore.benches.climbing import ClimbingBench

_WIDTH, _HEIGHT, _LEFT, _TOP, _GAP = 360, 240, 64, 40, 80
_OURS, _THEIRS, _LINES = "#1f6fb2", "#888888", "#dddddd"


def render_svg(bench: ClimbingBench) -> str:
    """Two panels over the block sizes without an error bound; the dashed line is marching cubes."""
    runs = [run for run in bench.runs if run.max_error == "none"]
    sizes = [run.block_size for run in runs]
    width = _LEFT + 2 * _WIDTH + _GAP + 24
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{_HEIGHT + _TOP + 60}" '
        'font-family="sans-serif" font-size="12">',
        '<rect width="100%" height="100%" fill="white"/>',
        *_panel(_LEFT, "triangles", sizes, [run.triangles for run in runs], bench.mc_triangles),
        *_panel(_LEFT + _WIDTH + _GAP, "seconds", sizes, [run.seconds for run in runs], bench.mc_seconds),
        "</svg>",
    ]
    return "\n".join(parts) + "\n"


def _panel(left: int, name: str, sizes: Sequence[int], values: Sequence[float], reference: float) -> list[str]:
    """One plot: block sizes evenly spaced, values on a logarithmic scale of whole decades."""
    low = floor(log10(min(*values, reference)))
    high = max(ceil(log10(max(*values, reference))), low + 1)

    def at(n: int) -> float:
        return left + _WIDTH * (n + 0.5) / len(sizes)

    def up(value: float) -> float:
        return _TOP + _HEIGHT * (high - log10(value)) / (high - low)

    parts = [f'<text x="{left}" y="{_TOP - 14}" font-weight="bold">{name}</text>']
    for decade in range(low, high + 1):
        y = up(10.0**decade)
        parts.append(f'<line x1="{left}" x2="{left + _WIDTH}" y1="{y:.1f}" y2="{y:.1f}" stroke="{_LINES}"/>')
        parts.append(f'<text x="{left - 6}" y="{y + 4:.1f}" text-anchor="end">{10.0**decade:g}</text>')
    for n, size in enumerate(sizes):
        parts.append(f'<text x="{at(n):.1f}" y="{_TOP + _HEIGHT + 18}" text-anchor="middle">{size}</text>')
    middle = left + _WIDTH / 2
    parts.append(f'<text x="{middle:.1f}" y="{_TOP + _HEIGHT + 40}" text-anchor="middle">block size</text>')
    y = up(reference)
    parts.append(
        f'<line x1="{left}" x2="{left + _WIDTH}" y1="{y:.1f}" y2="{y:.1f}" stroke="{_THEIRS}" stroke-dasharray="6 4"/>'
    )
    parts.append(f'<text x="{left + _WIDTH}" y="{y - 5:.1f}" text-anchor="end" fill="{_THEIRS}">marching cubes</text>')
    places = [(at(n), up(value)) for n, value in enumerate(values)]
    line = " ".join(f"{x:.1f},{y:.1f}" for x, y in places)
    parts.append(f'<polyline points="{line}" fill="none" stroke="{_OURS}" stroke-width="2"/>')
    parts += [f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3.5" fill="{_OURS}"/>' for x, y in places]
    return parts
