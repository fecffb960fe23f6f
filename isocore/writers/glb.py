"""GLB, binary glTF 2.0: a node, a mesh and a material for every part; float32, coordinates and unit as they are.

Khronos Group, "glTF 2.0 Specification", 2021: section 4 (binary container), 3.6 (accessors), 3.9 (materials).
"""

from __future__ import annotations

import json
import struct
from typing import Any, BinaryIO

import numpy as np
import numpy.typing as npt

from isocore.errors import OutputError
from isocore.surface import Part, Surface
from isocore.writers.names import column_names

_MAGIC, _JSON, _BIN = 0x46546C67, 0x4E4F534A, 0x004E4942
_FLOAT, _UINT, _SHORT = 5126, 5125, 5123
_VERTICES, _INDICES = 34962, 34963
_MOST_COMPONENTS = 4
_GREY = (200, 200, 200)
_WHITE = (255, 255, 255)


def write_glb(stream: BinaryIO, surface: Surface, threads: int) -> None:
    """Write every part that has triangles as a node with its name, its colour and, of label maps, its label."""
    whole = Part(name="surface", vertices=len(surface.vertices), triangles=len(surface.triangles))
    scene = _Scene()
    vertex = triangle = 0
    for part in surface.parts or (whole,):
        if part.triangles:
            scene.add(part, surface, slice(vertex, vertex + part.vertices), slice(triangle, triangle + part.triangles))
        vertex, triangle = vertex + part.vertices, triangle + part.triangles
    text = json.dumps(scene.document(surface), separators=(",", ":"), ensure_ascii=False).encode()
    text += b" " * (-len(text) % 4)
    length = 12 + 8 + len(text) + (8 + scene.bytes if scene.bytes else 0)
    if length >= 2**32:
        raise OutputError(f"GLB ends at 4 GiB, and this surface takes {length:,} bytes; write PLY or VTP")
    stream.write(struct.pack("<3I", _MAGIC, 2, length) + struct.pack("<2I", len(text), _JSON) + text)
    if scene.bytes:
        stream.write(struct.pack("<2I", scene.bytes, _BIN))
        for block in scene.blocks:
            stream.write(block.data)


class _Scene:
    """What is known of the parts so far, and their arrays. All rows are of whole words, so that none needs padding."""

    def __init__(self) -> None:
        self.blocks: list[npt.NDArray[Any]] = []
        self.bytes = 0
        self._views: list[dict[str, Any]] = []
        self._accessors: list[dict[str, Any]] = []
        self._parts: list[Part] = []
        self._meshes: list[dict[str, Any]] = []

    def add(self, part: Part, surface: Surface, vertices: slice, triangles: slice) -> None:
        """A part with its rows of the surface's vertices and triangles."""
        places = surface.vertices[vertices].astype("<f4", copy=False)
        attributes = {"POSITION": self._array(places, "VEC3", _VERTICES, bounded=True)}
        if surface.normals is not None:
            attributes["NORMAL"] = self._array(surface.normals[vertices].astype("<f4", copy=False), "VEC3", _VERTICES)
        if surface.colours is not None:
            attributes["COLOR_0"] = self._array(_linear(surface.colours[vertices]), "VEC4", _VERTICES)
        for name, some in _attributes(surface, vertices).items():
            attributes[name] = self._array(some, "SCALAR" if some.ndim == 1 else f"VEC{some.shape[1]}", _VERTICES)
        corners = (surface.triangles[triangles] - np.int32(vertices.start)).astype("<u4").reshape(-1)
        indices = self._array(corners, "SCALAR", _INDICES)
        primitive = {"attributes": attributes, "indices": indices, "material": len(self._parts)}
        self._meshes.append({"name": part.name, "primitives": [primitive]})
        self._parts.append(part if surface.colours is None else part._replace(colour=_WHITE))

    def _array(self, values: npt.NDArray[Any], kind: str, target: int, *, bounded: bool = False) -> int:
        block = np.ascontiguousarray(values)
        self._views.append({"buffer": 0, "byteOffset": self.bytes, "byteLength": block.nbytes, "target": target})
        accessor: dict[str, Any] = {
            "bufferView": len(self._views) - 1,
            "componentType": _SHORT if block.dtype == np.uint16 else _UINT if target == _INDICES else _FLOAT,
            "count": len(block),
            "type": kind,
        }
        if block.dtype == np.uint16:
            accessor["normalized"] = True
        if bounded:
            accessor |= {"min": block.min(axis=0).tolist(), "max": block.max(axis=0).tolist()}
        self._accessors.append(accessor)
        self.blocks.append(block)
        self.bytes += block.nbytes
        return len(self._accessors) - 1

    def document(self, surface: Surface) -> dict[str, Any]:
        """The JSON of the file; empty lists are left out, as the specification wants it."""
        extras = {"unit": surface.unit, "space": surface.space, "offset": surface.offset}
        lists = {
            "nodes": [_node(part, n) for n, part in enumerate(self._parts)],
            "meshes": self._meshes,
            "materials": [_material(part) for part in self._parts],
            "accessors": self._accessors,
            "bufferViews": self._views,
            "buffers": [{"byteLength": self.bytes}] if self.bytes else [],
        }
        scene: dict[str, Any] = {"extras": {key: value for key, value in extras.items() if value}}
        if self._parts:
            scene["nodes"] = list(range(len(self._parts)))
        return {"asset": {"version": "2.0", "generator": "isocore"}, "scene": 0, "scenes": [scene]} | {
            key: values for key, values in lists.items() if values
        }


def _node(part: Part, mesh: int) -> dict[str, Any]:
    said = {"label": part.label, "isovalue": part.isovalue}
    extras = {key: value for key, value in said.items() if value is not None}
    return {"name": part.name, "mesh": mesh} | ({"extras": extras} if extras else {})


def _attributes(surface: Surface, vertices: slice) -> dict[str, npt.NDArray[np.float32]]:
    """The carried fields under names that are the application's own, with an underscore before them; float32.

    Those of more than four components, or with what is no number, have no place in glTF.
    """
    as_one = {name: values if values.ndim == 1 else values[:, 0] for name, values in surface.fields.items()}
    names, found = column_names(as_one), {}
    for name, values in surface.fields.items():
        with np.errstate(over="ignore"):
            rows = values.astype("<f4")
        if rows.ndim == 2 and rows.shape[1] == 1:
            rows = rows[:, 0]
        if (rows.ndim == 1 or rows.shape[1] <= _MOST_COMPONENTS) and np.isfinite(rows).all():
            found[f"_{names[name][0]}"] = rows[vertices]
    return found


def _linear(colours: npt.NDArray[np.uint8]) -> npt.NDArray[np.uint16]:
    """(v, 4) red, green, blue and opacity of 16 bits; colours are linear in glTF, and sRGB everywhere else."""
    table = np.array([_to_linear(channel) for channel in range(256)])
    rows = np.full((len(colours), 4), 65535, np.uint16)
    rows[:, :3] = np.rint(table * 65535).astype("<u2")[colours]
    return rows


def _to_linear(channel: int) -> float:
    value = channel / 255
    return value / 12.92 if value <= 0.04045 else float(((value + 0.055) / 1.055) ** 2.4)


def _material(part: Part) -> dict[str, Any]:
    factor = [*(round(_to_linear(channel), 6) for channel in part.colour or _GREY), 1.0]
    surface = {"baseColorFactor": factor, "metallicFactor": 0.0, "roughnessFactor": 0.8}
    return {"name": part.name, "pbrMetallicRoughness": surface}
