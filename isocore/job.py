"""What is asked of one file: its surfaces, where they go, and how they are made."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

from isocore.choices import (
    FIELD_FORMATS,
    SHADED_FORMATS,
    About,
    Choice,
    Format,
    MaxError,
    parse_about,
    parse_choice,
    parse_max_error,
)
from isocore.errors import OptionError
from isocore.labels import Label
from isocore.readers.options import ReadOptions
from isocore.views import Still
from isocore.volume import Space, Volume, to_ras

if TYPE_CHECKING:
    from isocore.piece_sizes import MinPiece

#: The target that is not a file.
STDOUT = Path("-")


@dataclass(frozen=True, slots=True, kw_only=True)
class Options:
    """What a user may ask of an extraction. What is None is left to the backend.

    threads: at least 1. Results do not depend on it.
    cap: close the surface at the volume's border.
    normals: compute vertex normals; None is yes where a job's format holds them, and no in `extract`.
    block_size: cells per block and axis, one of BLOCK_SIZES.
    max_error: how far the reference's vertices may lie from the surface; a text is parsed.
    simplify: contract edges within max_error; None is yes where the backend does so by default.
    triangles: at most so many; edges are contracted past the default bound if they must, not past one that was given.
    topology: "faces" (the default) closes every loop of a cell by a disk; "trilinear" joins two by a tube where the
        trilinear function does.
    smooth: rounds of smoothing, in which no sample changes sides.
    background: the label that is none; 0 by default. Of label maps only.
    keep_largest: keep so many of the largest pieces of each surface. min_piece: keep those that are as large; a text
        is parsed. fill_bubbles: drop the inner shells of the pieces kept.
    angles: measure how far triangles are turned from the gradient, where an error is measured: for a report.
    """

    threads: int = 1
    cap: bool = False
    normals: bool | None = None
    block_size: int | None = None
    max_error: MaxError | None = None
    simplify: bool | None = None
    triangles: int | None = None
    topology: str | None = None
    smooth: int | None = None
    background: int | None = None
    keep_largest: int | None = None
    min_piece: MinPiece | None = None
    fill_bubbles: bool = False
    angles: bool = False

    def __post_init__(self) -> None:
        if isinstance(self.max_error, str):
            object.__setattr__(self, "max_error", parse_max_error(self.max_error))
        if isinstance(self.min_piece, str):
            from isocore.piece_sizes import parse_min_piece  # late: few jobs drop pieces

            object.__setattr__(self, "min_piece", parse_min_piece(self.min_piece))


@dataclass(frozen=True, slots=True)
class Target:
    """One surface of a job: how its isovalue is chosen (a text is parsed) and where it goes; `-` is stdout.

    picture: where a still of it goes, if one is asked for.
    """

    choice: Choice
    output: Path
    picture: Path | None = None

    def __post_init__(self) -> None:
        if isinstance(self.choice, str):
            object.__setattr__(self, "choice", parse_choice(self.choice))


class ReadAhead:
    """A field that was read when its job was planned, and the seconds that it took: handed out once.

    Another process, to which a job is sent, reads for itself.
    """

    def __init__(self, field: Volume | None = None, seconds: float = 0.0) -> None:
        self._field, self.seconds = field, seconds

    def take(self) -> Volume | None:
        """The field, which is then no longer kept here."""
        taken, self._field = self._field, None
        return taken

    def __reduce__(self) -> tuple[type[ReadAhead], tuple[()]]:
        return ReadAhead, ()


@dataclass(frozen=True, slots=True, kw_only=True)
class Job:
    """What is asked of one file.

    time: of the step of a series that `read_options` choose, for the record.
    format: of the outputs.
    backend: by name, or None for the default of the field.
    space: of the outputs, "native" for the file's own.
    offset: the point that vertices are written about; a text is parsed.
    reference: set marching cubes beside each surface.
    self_intersections: count them; they are also counted where `require` names `simple`.
    require: names out of requirements.REQUIREMENTS; max_triangles: a further one.
    together: all targets are parts of one output, which all of them name. colour: of what has no colour of its own.
    colormap, color_by, color_range: how the vertices are coloured by a field that `read_options.carry` carries; None:
        viridis, the first of them, from its smallest to its largest value on the surface.
    ambiguities: where the ambiguous faces go, for a job of one target.
    still: how the pictures of targets are drawn.
    compress: pack the arrays of a format that can be packed, which is VTP.
    if_changed: leave outputs alone that are up to date (batches/stamps.py); force: not even those. A batch obeys
        both, also on a cluster; `convert` alone always converts.
    page_triangles: of the copy of each surface that its report holds for a page; 0 for none.
    refusal: why the source is not even tried, such as a folder that cannot be searched; the job fails with it.
    read_ahead: the source's field, where planning had to read it.
    """

    source: Path
    targets: tuple[Target, ...]
    format: Format = "ply"
    backend: str | None = None
    options: Options = field(default_factory=Options)
    read_options: ReadOptions = field(default_factory=ReadOptions)
    space: Space = "native"
    time: float | None = None
    offset: About | None = None
    reference: bool = True
    self_intersections: bool = True
    require: tuple[str, ...] = ()
    max_triangles: int | None = None
    ambiguities: Path | None = None
    together: bool = False
    colour: tuple[int, int, int] | None = None
    colormap: str | None = None
    color_by: str | None = None
    color_range: tuple[float, float] | None = None
    compress: bool = False
    if_changed: bool = False
    force: bool = False
    page_triangles: int = 0
    still: Still = field(default_factory=Still)
    refusal: str = ""
    read_ahead: ReadAhead | None = field(default=None, compare=False, repr=False)

    def __post_init__(self) -> None:
        if isinstance(self.offset, str):
            object.__setattr__(self, "offset", parse_about(self.offset))
        if self.compress and self.format != "vtp":
            raise OptionError(f"--compress: packs the arrays of VTP, and {self.format} has no such thing; leave it out")
        if self.format == "gii" and self.space in ("lps", "las"):
            raise OptionError(f"--space {self.space}: GIFTI is in RAS; leave it out, or choose another format with -f")

    def place(self, volume: Volume) -> Volume:
        """The volume in the space that is asked for; GIFTI is in RAS where the file says which way its axes point."""
        as_ras = self.format == "gii" and self.space == "native" and to_ras(volume.space) is not None
        return volume.in_space("ras" if as_ras else self.space)

    @property
    def counts_intersections(self) -> bool:
        """Are self-intersections counted? Also where only a requirement asks for it."""
        return self.self_intersections or "simple" in self.require

    @property
    def holds_fields(self) -> bool:
        """Does the format hold fields of the vertices?"""
        return self.format in FIELD_FORMATS

    @property
    def colours_by_field(self) -> bool:
        """Are surfaces coloured by a field, where one is carried? By default, but for labels, which have a colour."""
        labels = any(isinstance(one.choice, Label) for one in self.targets)
        return self.colour is None and (self._map_is_asked or not labels)

    @property
    def colours_vertices(self) -> bool:
        """Does the file get a colour for every vertex, where fields are carried? GLB does by default, PLY if asked."""
        return self.colours_by_field and (self.format == "glb" or (self.format == "ply" and self._map_is_asked))

    @property
    def _map_is_asked(self) -> bool:
        return any(given is not None for given in (self.colormap, self.color_by, self.color_range))

    @property
    def normals(self) -> bool:
        """Are vertex normals written? By default where the format holds them."""
        return self.format in SHADED_FORMATS and self.options.normals is not False
