"""OBJ: text with nine significant digits, vertices counted from one."""

from __future__ import annotations

from typing import Any, BinaryIO

import numpy as np
import numpy.typing as npt

from isocore import _kernels
from isocore.surface import Surface
from isocore.writers.pieces import merge_warning, pieces


def write_obj(stream: BinaryIO, surface: Surface, threads: int) -> tuple[str, ...]:
    """Write vertices, normals if any, triangles; warns if nine digits cannot tell vertices apart."""
    stream.write(_header(surface).encode("ascii"))
    for vertices in pieces(surface.vertices):
        stream.write(_kernels.format_rows("v", vertices, threads))
    if surface.normals is not None:
        for normals in pieces(surface.normals):
            stream.write(_kernels.format_rows("vn", normals, threads))
    for triangles in pieces(surface.triangles):
        stream.write(_kernels.format_faces(triangles, surface.normals is not None, threads))
    if surface.vertices.dtype == np.float32:
        return ()
    return merge_warning(surface.vertices, _nine_digits(surface.vertices), "OBJ keeps nine digits")


def _header(surface: Surface) -> str:
    lines = ["# isocore"]
    if surface.space != "native":
        lines.append(f"# SPACE={surface.space.upper()}")
    if surface.unit:
        lines.append(f"# vertex coordinates are measured in units, where 1 unit = 1.000000 {surface.unit}")
    return "\n".join([*lines, ""])


def _nine_digits(values: npt.NDArray[Any]) -> npt.NDArray[np.float64]:
    """`values` as their text with nine significant digits would be read."""
    with np.errstate(divide="ignore"):
        exponent = np.floor(np.log10(np.abs(values)))
    step = 10.0 ** (np.where(np.isfinite(exponent), exponent, 0) - 8)
    rounded: npt.NDArray[np.float64] = np.rint(values / step) * step
    return rounded
