"""What Python programs call for one surface of a field, with everything optional by its name.

The command line's options have these names with hyphens; an error that the two share names the argument here.
"""

from __future__ import annotations

import math
import os
import re
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from typing import Literal, SupportsFloat, TypeAlias

import numpy as np
import numpy.typing as npt

from isocore.backends import default_backend, prepare
from isocore.carried import CarriedField, chosen
from isocore.cell_mesh import CellMesh
from isocore.choices import Choice, MaxError, Number, Voxels, parse_choice, spread
from isocore.digits import exact
from isocore.errors import IsocoreError, OptionError
from isocore.extraction import Outlook
from isocore.histogram import histogram
from isocore.isovalue import choose
from isocore.job import Options
from isocore.piece_sizes import parse_min_piece
from isocore.pieces import check_unit, keep_pieces
from isocore.surface import Surface
from isocore.volume import Volume

Isovalue: TypeAlias = SupportsFloat | str
Name: TypeAlias = os.PathLike[str] | str
Carry: TypeAlias = str | Iterable[str] | Mapping[str, Volume | npt.ArrayLike]
Topology: TypeAlias = Literal["faces", "trilinear"]

_OPTION = re.compile(r"(?<![\w-])--?([a-z]+(?:-[a-z]+)*)\b")
_SHORT = {"i": "isovalue", "b": "backend", "d": "output_dir", "f": "format"}


def extract(
    field: Volume | CellMesh,
    isovalue: Isovalue = "auto",
    *,
    backend: str | None = None,
    max_error: float | str | None = None,
    simplify: bool | None = None,
    triangles: int | None = None,
    block_size: int | None = None,
    topology: Topology | None = None,
    smooth: int | None = None,
    keep_largest: int | None = None,
    min_piece: int | str | None = None,
    fill_bubbles: bool = False,
    cap: bool = False,
    normals: bool = False,
    threads: int = 1,
    options: Options | None = None,
    carry: Carry | None = None,
) -> Surface:
    """One surface of a volume or a mesh.

    isovalue: a number, or a text as the command line takes it: "otsu", "p90" (a percentile), "auto".
    backend: "asc", "thinning" or "mc"; None is the default of the field.
    max_error: how far the surface may lie from marching cubes', both ways: voxels (0.25), a mesh's unit, or "0.3mm".
    simplify: the fewest triangles within it; None is yes for asc. triangles: at most so many, as in Options.
    block_size: asc, cells along the edge of the largest box. topology: mc, as in Options.
    smooth: rounds of smoothing, in which no sample changes sides; of a volume, by mc.
    keep_largest: of the surface's pieces, so many of the largest. min_piece: drop those of fewer triangles, or of a
        smaller volume, as "20mm3". fill_bubbles: drop the inner shells of the pieces kept.
    cap: close the surface at the volume's border. normals: compute vertex normals.
    threads: at least 1; the surface is the same for any number.
    options: all of these in one object; then they are not looked at.
    carry: which fields the surface gets the values of, as `surface.fields`: names of those that the field carries
        (`ReadOptions(carry=...)`); or a mapping of names to volumes on the same grid, or to arrays of a value (or k)
        for each sample or point, indexed as they are. None: all that the field carries.

    Raises OptionError for an argument that makes no sense, FieldError for a field that has no such isovalue.
    """
    if not isinstance(field, (Volume, CellMesh)):
        kind = type(field).__name__
        raise OptionError(f"field: is a {kind}, not a Volume or CellMesh; see Volume.from_array and read")
    with arguments_named():
        field = _carrying(field, carry)
        asked = options or options_of(
            threads, cap, normals, block_size, max_error, simplify, triangles, topology, smooth, keep_largest,
            min_piece, fill_bubbles,
        )
        check_unit(asked, field.unit)
        outlook = Outlook(isovalues=1, named=backend is not None)
        default = "mc" if asked.smooth else default_backend(type(field), outlook)[0]
        extract_ = prepare(field, backend or default, asked, outlook)
        choice = parse_choice(isovalue) if isinstance(isovalue, str) else choices_of(isovalue)[0]
        if not isinstance(choice, Number):
            choice = Number(choose(choice, histogram(field, threads=asked.threads)).isovalue, str(choice))
        return keep_pieces(extract_(choice.value).surface, asked).surface


def _carrying(field: Volume | CellMesh, carry: Carry | None) -> Volume | CellMesh:
    """The field with what it is asked to carry."""
    if carry is None:
        return field
    if not isinstance(carry, Mapping):
        return replace(field, carried=chosen(field.carried, (carry,) if isinstance(carry, str) else carry))
    found = []
    for name, values in carry.items():
        if isinstance(values, Volume):
            samples = values.samples.reshape(-1, order="F")
            if not isinstance(field, Volume) or values.shape != field.shape or not _same_place(field, values):
                raise OptionError(f"carry: {name!r} lies on another grid than the field; resample it to the same one")
            found.append(CarriedField(name, samples, "points", values.slope, values.intercept))
            continue
        array = np.asarray(values)
        axes = 3 if isinstance(field, Volume) else 1
        shape = field.shape if isinstance(field, Volume) else (len(field.points),)
        if array.shape[:axes] != shape or array.ndim > axes + 1 or array.dtype.kind not in "biuf":
            raise OptionError(f"carry: {name!r} is no array of {' x '.join(map(str, shape))} real numbers, or vectors")
        flat = array.reshape((-1, *array.shape[axes:]), order="F") if axes == 3 else array
        found.append(CarriedField(name, flat, "points"))
    return replace(field, carried=tuple(found))


def _same_place(field: Volume, other: Volume) -> bool:
    tolerance = 1e-2 * min(field.spacing) / max(field.shape)
    return bool(np.allclose(field.affine, other.affine, rtol=1e-6, atol=tolerance))


def choices_of(isovalue: Isovalue) -> tuple[Choice, ...]:
    """The choices behind one isovalue: a text may be several."""
    if isinstance(isovalue, str):
        return spread(isovalue)
    try:
        number = float(isovalue)
    except (TypeError, ValueError):
        number = math.nan
    if not math.isfinite(number):
        raise OptionError(f"isovalue: {isovalue!r} is no finite number; pass one, or a text as 'otsu' or 'p90'")
    return (Number(number, exact(number)),)


def options_of(
    threads: int,
    cap: bool,
    normals: bool | None,
    block_size: int | None,
    max_error: float | str | None,
    simplify: bool | None,
    triangles: int | None,
    topology: Topology | None,
    smooth: int | None,
    keep_largest: int | None = None,
    min_piece: int | str | None = None,
    fill_bubbles: bool = False,
) -> Options:
    """The options as the methods know them."""
    if smooth is not None and not (isinstance(smooth, int) and smooth >= 0):
        raise OptionError(f"smooth: {smooth!r} is no number of rounds; pass a whole number from 0 on")
    return Options(
        threads=at_least_one("threads", threads),
        cap=cap,
        normals=normals,
        block_size=block_size,
        max_error=_bound(max_error),
        simplify=simplify,
        triangles=None if triangles is None else at_least_one("triangles", triangles),
        topology=topology,
        smooth=smooth or None,
        keep_largest=None if keep_largest is None else at_least_one("keep_largest", keep_largest),
        min_piece=None if min_piece is None else parse_min_piece(str(min_piece)),
        fill_bubbles=fill_bubbles,
    )


def _bound(max_error: float | str | None) -> MaxError | None:
    """The bound as the methods know it; Options parses a text."""
    if max_error is None or isinstance(max_error, str):
        return max_error  # type: ignore[return-value]  # Options parses a text
    if not 0 <= float(max_error) < math.inf:
        raise OptionError(f"max_error: {max_error!r} is no length; pass voxels as 0.25, a text as '0.3mm', or 'none'")
    return Voxels(float(max_error), exact(float(max_error)))


def at_least_one(name: str, number: int) -> int:
    """The number, where it is one from 1 on."""
    if not isinstance(number, int) or number < 1:
        raise OptionError(f"{name}: {number!r} is no whole number from 1 on")
    return number


@contextmanager
def arguments_named() -> Iterator[None]:
    """Errors name Python's argument where they name an option of the command line."""
    try:
        yield
    except IsocoreError as error:
        text = _OPTION.sub(lambda match: _SHORT.get(match[1], match[1]).replace("-", "_"), str(error))
        raise type(error)(text) from error
