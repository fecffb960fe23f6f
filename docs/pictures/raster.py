"""Triangles to pixels, in software: a z-buffer in numpy, flat shading, visible edges, and a PNG written by hand."""

from __future__ import annotations

import struct
import zlib
from pathlib import Path

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
Shades = npt.NDArray[np.float64]  # (height, width), 0 the darkest ink and 1 the paper

SHADES = 40  # of the palette


def render(corners: Floats, light: Floats, *, size: tuple[int, int], line: float, samples: int = 3) -> Shades:
    """Draw triangles with their edges, nearest first; triangles without area are passed over.

    corners: (t, 3, 3), in pixels: x to the right, y down, z towards the eye. light: (3,), a unit vector.
    size: (width, height). line: the width of an edge, in pixels. samples: along both sides of a pixel.
    """
    width, height = (n * samples for n in size)
    depth = np.full((height, width), -np.inf)
    shade = np.ones((height, width))
    corners = corners * np.array([samples, samples, 1.0])
    for triangle in corners:
        _draw(triangle, light, line * samples / 2, depth, shade)
    pixels: Shades = shade.reshape(size[1], samples, size[0], samples).mean(axis=(1, 3))
    return pixels


def _draw(triangle: Floats, light: Floats, line: float, depth: Floats, shade: Shades) -> None:
    (x0, y0, z0), (x1, y1, z1), (x2, y2, z2) = triangle
    area = (x1 - x0) * (y2 - y0) - (x2 - x0) * (y1 - y0)
    low_x, low_y = (max(int(np.floor(triangle[:, a].min())), 0) for a in (0, 1))
    high_x, high_y = (min(int(np.ceil(triangle[:, a].max())) + 1, depth.shape[1 - a]) for a in (0, 1))
    if abs(area) < 1e-9 or low_x >= high_x or low_y >= high_y:
        return
    x = np.arange(low_x, high_x)[None, :] + 0.5
    y = np.arange(low_y, high_y)[:, None] + 0.5
    # Barycentric coordinates: each times the triangle's height over that side is the distance from the side.
    a = ((x1 - x) * (y2 - y) - (x2 - x) * (y1 - y)) / area
    b = ((x2 - x) * (y0 - y) - (x0 - x) * (y2 - y)) / area
    c = 1 - a - b
    z = a * z0 + b * z1 + c * z2
    here = depth[low_y:high_y, low_x:high_x]
    seen = (a >= 0) & (b >= 0) & (c >= 0) & (z > here)
    here[seen] = z[seen]
    sides = [np.hypot(x2 - x1, y2 - y1), np.hypot(x0 - x2, y0 - y2), np.hypot(x1 - x0, y1 - y0)]
    to_edge = np.minimum(np.minimum(a / sides[0], b / sides[1]), c / sides[2]) * abs(area)
    normal = np.cross(triangle[1] - triangle[0], triangle[2] - triangle[0])
    lit = abs(float(normal @ light)) / float(np.linalg.norm(normal))
    out = shade[low_y:high_y, low_x:high_x]
    out[seen] = np.where(to_edge < line, 0.08, 0.42 + 0.5 * lit)[seen]


def write_png(path: Path, shades: Shades, ink: tuple[int, int, int], surface: tuple[int, int, int]) -> None:
    """Write shades with a palette from ink over the surface's colour to white: one byte a pixel, before zlib."""
    stops = np.array([ink, surface, (255, 255, 255)], dtype=float)
    ramp = np.linspace(0, 1, SHADES)
    palette = np.stack([np.interp(ramp, [0, 0.7, 1], stops[:, n]) for n in range(3)], axis=1).round().astype(np.uint8)
    rows = np.clip(np.rint(shades * (SHADES - 1)), 0, SHADES - 1).astype(np.uint8)
    height, width = rows.shape
    scanlines = np.hstack([np.zeros((height, 1), np.uint8), rows])  # each begins with its filter: none
    header = struct.pack(">IIBBBBB", width, height, 8, 3, 0, 0, 0)
    chunks = [
        (b"IHDR", header),
        (b"PLTE", palette.tobytes()),
        (b"IDAT", zlib.compress(scanlines.tobytes(), 9)),
        (b"IEND", b""),
    ]
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + b"".join(_chunk(name, body) for name, body in chunks))


def _chunk(name: bytes, body: bytes) -> bytes:
    return struct.pack(">I", len(body)) + name + body + struct.pack(">I", zlib.crc32(name + body))


def read_png(path: Path) -> npt.NDArray[np.uint8]:
    """The palette's numbers of a picture that write_png() wrote: (height, width)."""
    data, at, packed = path.read_bytes(), 8, b""
    width, height = struct.unpack(">II", data[16:24])
    while at < len(data):
        (length,) = struct.unpack(">I", data[at : at + 4])
        if data[at + 4 : at + 8] == b"IDAT":
            packed += data[at + 8 : at + 8 + length]
        at += 12 + length
    return np.frombuffer(zlib.decompress(packed), np.uint8).reshape(height, width + 1)[:, 1:]
