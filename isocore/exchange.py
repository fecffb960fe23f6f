"""A surface as other libraries hold one. Each is imported when it is asked for: isocore needs none of them.

Everywhere vertices: (v, 3) float32 or float64, world; triangles: (t, 3) int32; normals: (v, 3) float32 or None;
fields: by name (v,) or (v, k); place: what the coordinates mean, for the object's metadata. What they return holds
copies, which may be changed.
"""

from __future__ import annotations

from collections.abc import Mapping
from importlib import import_module
from types import ModuleType
from typing import TYPE_CHECKING, Any, cast

import numpy as np
import numpy.typing as npt

from isocore.errors import IsocoreError

if TYPE_CHECKING:
    import meshio
    import pyvista
    import trimesh

Fields = Mapping[str, npt.NDArray[Any]]


def to_trimesh(
    vertices: npt.NDArray[Any], triangles: npt.NDArray[np.int32], normals: Any, fields: Fields, place: dict[str, str]
) -> trimesh.Trimesh:
    """Vertices and triangles as they are: none are merged, dropped or reordered. Fields are vertex attributes."""
    library = _imported("trimesh")
    mesh = library.Trimesh(
        vertices=np.array(vertices, dtype=np.float64),
        faces=np.array(triangles, dtype=np.int64),
        vertex_normals=None if normals is None else np.array(normals, dtype=np.float64),
        metadata=dict(place),
        vertex_attributes={name: np.array(values) for name, values in fields.items()},
        process=False,
    )
    if place["unit"]:
        mesh.units = place["unit"]
    return cast("trimesh.Trimesh", mesh)


def to_pyvista(
    vertices: npt.NDArray[Any], triangles: npt.NDArray[np.int32], normals: Any, fields: Fields, place: dict[str, str]
) -> pyvista.PolyData:
    """Faces of three corners each, normals as point data."""
    library = _imported("pyvista")
    faces = np.empty((len(triangles), 4), dtype=np.int64)
    faces[:, 0] = 3
    faces[:, 1:] = triangles
    mesh = library.PolyData(np.array(vertices), faces.ravel())
    if normals is not None:
        mesh.point_data["Normals"] = np.array(normals)
    for name, values in fields.items():
        mesh.point_data[name] = np.array(values)
    for key, text in place.items():
        mesh.add_field_data([text], key)
    return cast("pyvista.PolyData", mesh)


def to_meshio(
    vertices: npt.NDArray[Any], triangles: npt.NDArray[np.int32], normals: Any, fields: Fields
) -> meshio.Mesh:
    """One block of triangles, normals as point data."""
    library = _imported("meshio")
    point_data = {} if normals is None else {"Normals": np.array(normals)}
    point_data |= {name: np.array(values) for name, values in fields.items()}
    return cast("meshio.Mesh", library.Mesh(np.array(vertices), [("triangle", np.array(triangles))], point_data))


def _imported(name: str) -> ModuleType:
    try:
        return import_module(name)
    except ImportError as error:
        if error.name != name:
            raise
        raise IsocoreError(f"{name} is not installed; run `pip install {name}` in this environment") from error
