"""Stills of surfaces, drawn in software: rays of Intel's Embree (package embreex), shaded here, and a PNG.

It needs no display and no GPU; `pip install 'isocore[picture]'` brings embreex.
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Sequence
from dataclasses import dataclass
from importlib.util import find_spec
from typing import Any, BinaryIO

import numpy as np
import numpy.typing as npt

from isocore.errors import OptionError
from isocore.surface import Surface
from isocore.views import Direction

Colour = tuple[int, int, int]
Pixels = npt.NDArray[np.uint8]
Floats = npt.NDArray[np.float32]

#: Of a surface without one.
BLUE: Colour = (107, 159, 212)
_PAPER = np.array([255, 255, 255], np.float32)
_INK = np.array([20, 38, 66], np.float32)
_SAMPLES = 2  # along both sides of a pixel
_MARGIN = 0.04  # of a view's shorter side
_RAYS = 1 << 19  # at once
#: Lights, as the eye has them: right, up, towards the eye; and how bright they are.
_LIGHTS = (((-0.55, 0.62, 0.56), 0.72), ((0.75, 0.1, 0.55), 0.22))
_AMBIENT, _SHINE = 0.24, 0.16


def check_installed() -> None:
    """Raises OptionError where what draws is missing."""
    if find_spec("embreex") is None:
        raise OptionError("--picture: needs embreex; pip install 'isocore[picture]'")


@dataclass(frozen=True, slots=True)
class _View:
    """The axes of a picture in the world: right, up, towards the eye, as rows; and where its middle is."""

    axes: Floats
    middle: Floats


def draw(
    surface: Surface,
    views: Sequence[tuple[Direction, Direction]],
    size: tuple[int, int],
    *,
    edges: float = 0,
) -> Pixels:
    """(height, width, 3): orthographic views side by side, all at one scale; white where nothing is.

    views: directions to the eye and up. size: width and height. edges: the width of triangles' edges in pixels, 0 for
    none.
    """
    columns, rows = _layout(len(views), size)
    picture = np.full((size[1], size[0], 3), 255, np.uint8)
    if not len(surface.triangles):
        return picture
    places = _in_unit_box(surface.vertices)
    axes = [_axes(*view) for view in views]
    width, height = size[0] // columns, size[1] // rows
    spans = [np.ptp(places @ one.T, axis=0) for one in axes]
    pixel = max(max(span[0] / width, span[1] / height) for span in spans) / (1 - 2 * _MARGIN)
    scene = _Scene(surface, places.astype(np.float32))
    for n, one in enumerate(axes):
        turned = places @ one.T
        middle = ((turned.min(axis=0) + turned.max(axis=0)) / 2) @ one
        view = _View(one.astype(np.float32), middle.astype(np.float32))
        top, left = n // columns * height, n % columns * width
        picture[top : top + height, left : left + width] = scene.seen(view, width, height, pixel, edges)
    return picture


def _layout(count: int, size: tuple[int, int]) -> tuple[int, int]:
    """Columns and rows that leave each view the longest shorter side."""
    choices = [(columns, -(-count // columns)) for columns in range(1, count + 1)]
    return max(choices, key=lambda choice: min(size[0] // choice[0], size[1] // choice[1]))


def _axes(to_eye: Direction, up: Direction) -> npt.NDArray[np.float64]:
    return np.array([np.cross(up, to_eye), up, to_eye], np.float64)


def _in_unit_box(vertices: npt.NDArray[Any]) -> npt.NDArray[np.float64]:
    """The vertices about their middle, the longest side of their box 1: coordinates may be as large as a double."""
    halves = vertices.astype(np.float64) / 2
    low, high = halves.min(axis=0), halves.max(axis=0)
    half = float((high - low).max()) or 1.0
    return np.asarray((halves - (low / 2 + high / 2)) / half)


class _Scene:
    """A surface in Embree's tree, and what is known at its vertices."""

    def __init__(self, surface: Surface, places: Floats) -> None:
        from embreex.mesh_construction import TriangleMesh
        from embreex.rtcore_scene import EmbreeScene

        self._scene = EmbreeScene()
        self._places = places
        self._triangles = surface.triangles
        self._mesh = TriangleMesh(self._scene, places, np.array(surface.triangles))
        self._normals = surface.normals if surface.normals is not None else _normals(places, surface.triangles)
        self._colours = surface.colours
        self._of_parts = None if surface.colours is not None else _part_colours(surface)

    def seen(self, view: _View, width: int, height: int, pixel: float, edges: float) -> Pixels:
        """(height, width, 3): one view. pixel: how wide one is, of the unit box."""
        out = np.empty((height, width, 3), np.uint8)
        step = max(1, _RAYS // (width * _SAMPLES * _SAMPLES))
        across = ((np.arange(width * _SAMPLES) + 0.5) / _SAMPLES - width / 2) * pixel
        for first in range(0, height, step):
            rows = min(step, height - first)
            down = ((np.arange(first * _SAMPLES, (first + rows) * _SAMPLES) + 0.5) / _SAMPLES - height / 2) * pixel
            x, y = np.meshgrid(across.astype(np.float32), -down.astype(np.float32))
            origins = view.middle + x.reshape(-1, 1) * view.axes[0] + y.reshape(-1, 1) * view.axes[1] + 4 * view.axes[2]
            shades = self._shaded(origins, view, edges * pixel)
            block = shades.reshape(rows, _SAMPLES, width, _SAMPLES, 3).mean(axis=(1, 3))
            out[first : first + rows] = np.clip(np.rint(block), 0, 255).astype(np.uint8)
        return out

    def _shaded(self, origins: Floats, view: _View, line: float) -> Floats:
        """(n, 3): what each ray sees."""
        ways = np.broadcast_to(-view.axes[2], origins.shape).astype(np.float32)
        found = self._scene.run(np.ascontiguousarray(origins, np.float32), ways, output=1)
        out = np.broadcast_to(_PAPER, origins.shape).copy()
        hit = np.flatnonzero(found["primID"] >= 0)
        if not len(hit):
            return out
        number, u, v = found["primID"][hit], found["u"][hit], found["v"][hit]
        corners = self._triangles[number]
        shares = np.stack([1 - u - v, u, v], axis=1)
        normals = np.einsum("nc,nca->na", shares, self._normals[corners]) @ view.axes.T
        flat = np.cross(*(self._places[corners[:, n]] - self._places[corners[:, 0]] for n in (1, 2)))
        facing = np.sign(flat @ view.axes[2])  # the inside of an open surface is lit as its outside
        normals *= np.where(facing == 0, 1, facing)[:, None]
        normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)
        out[hit] = _lit(normals, self._colours_at(number, corners, shares))
        if line:
            out[hit[_distance_to_edges(self._places[corners], shares) < line / 2]] = _INK
        return out

    def _colours_at(self, number: npt.NDArray[Any], corners: npt.NDArray[Any], shares: Floats) -> Floats:
        if self._colours is not None:
            return np.asarray(np.einsum("nc,nca->na", shares, self._colours[corners].astype(np.float32)))
        if self._of_parts is not None:
            ends, colours = self._of_parts
            return np.asarray(colours[np.searchsorted(ends, number, side="right")])
        return np.broadcast_to(np.array(BLUE, np.float32), (len(number), 3))


def _part_colours(surface: Surface) -> tuple[npt.NDArray[np.int64], Floats] | None:
    """Where each part's triangles end, and its colour."""
    if not surface.parts:
        return None
    ends = np.cumsum([part.triangles for part in surface.parts])
    return ends, np.array([part.colour or BLUE for part in surface.parts], np.float32)


def _lit(normals: Floats, colours: Floats) -> Floats:
    """(n, 3), 0 to 255: the colours under the lights, darker where the surface turns away.

    normals: right, up, towards the eye.
    """
    light = np.full(len(normals), _AMBIENT, np.float32)
    shine = np.zeros(len(normals), np.float32)
    for way, strength in _LIGHTS:
        direction = np.array(way, np.float32) / np.linalg.norm(way).astype(np.float32)
        light += strength * np.maximum(normals @ direction, 0)
        half = direction + np.array([0, 0, 1], np.float32)
        shine += strength * np.maximum(normals @ (half / np.linalg.norm(half)), 0) ** 24
    light *= 0.72 + 0.28 * np.abs(normals[:, 2])
    return np.asarray(np.minimum(colours * 1.1 * light[:, None] + 255 * _SHINE * shine[:, None], 255), np.float32)


def _normals(places: Floats, triangles: npt.NDArray[np.int32]) -> Floats:
    """(v, 3): the mean of the triangles' normals around each vertex, by area."""
    a, b, c = (places[triangles[:, n]] for n in range(3))
    each = np.cross(b - a, c - a)
    sums = np.zeros((len(places), 3))
    for axis in range(3):
        sums[:, axis] = np.bincount(triangles.ravel(), np.repeat(each[:, axis], 3), len(places))
    return np.asarray(sums / np.maximum(np.linalg.norm(sums, axis=1, keepdims=True), 1e-30), np.float32)


def _distance_to_edges(corners: Floats, shares: Floats) -> Floats:
    """(n,): of a place in each triangle (n, 3, 3), by its barycentric coordinates (n, 3), to the nearest side."""
    sides = np.linalg.norm(np.roll(corners, -1, axis=1) - np.roll(corners, -2, axis=1), axis=2)
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    return np.asarray((shares * area[:, None] / np.maximum(sides, 1e-30)).min(axis=1))


def write_png(stream: BinaryIO, pixels: Pixels) -> None:
    """Write (height, width, 3) as a PNG: every row by its difference to the one above."""
    height, width, _ = pixels.shape
    rows = pixels.reshape(height, -1)
    up = np.vstack([rows[:1], rows[1:] - rows[:-1]])
    lines = np.hstack([np.full((height, 1), 2, np.uint8), up])
    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    stream.write(b"\x89PNG\r\n\x1a\n")
    for name, body in ((b"IHDR", header), (b"IDAT", zlib.compress(lines.tobytes(), 7)), (b"IEND", b"")):
        stream.write(struct.pack(">I", len(body)) + name + body + struct.pack(">I", zlib.crc32(name + body)))
