"""What is said of a field, by `isocore info` and in the record of a run alike."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from isocore.cell_mesh import Connectivity
from isocore.extraction import Field
from isocore.histogram import Bars, Histogram
from isocore.volume import Volume


@dataclass(frozen=True, slots=True, kw_only=True)
class FieldFacts:
    """Facts under the record's keys.

    shape: of a volume the samples along i, j, k; of a mesh the points and the cells that are contoured.
    spacing: length of one step along i, j, k, in `unit`; None for a mesh.
    space: what world means, as in Volume.
    field: that was read, in a file that names its fields; else None.
    connectivity: of a mesh, how its cells came to hang together.
    range: smallest and largest finite value, scaled; None without one.
    nonfinite: samples that have none. ignored: samples that were named as meaning nothing; they count as outside too.
    """

    kind: Literal["volume", "mesh"]
    shape: tuple[int, ...]
    dtype: str
    spacing: tuple[float, ...] | None
    space: str
    unit: str
    field: str | None
    range: tuple[float, float] | None
    nonfinite: int
    histogram: Bars
    connectivity: Connectivity | None = None
    ignored: int = 0

    @property
    def warnings(self) -> tuple[str, ...]:
        """What these facts mean for a surface."""
        if not self.nonfinite:
            return ()
        return (f"{self.nonfinite:,} samples are not finite; they count as outside, so the surface ends beside them",)

    @classmethod
    def of(cls, source: Field, spread: Histogram) -> FieldFacts:
        """The facts of a field whose samples are spread so."""
        if isinstance(source, Volume):
            return cls(
                kind="volume",
                shape=source.samples.shape,
                dtype=source.samples.dtype.name,
                spacing=source.spacing,
                space=source.space,
                unit=source.unit,
                field=source.field_name or None,
                range=spread.range,
                nonfinite=spread.nonfinite - source.ignored,
                ignored=source.ignored,
                histogram=spread.coarse(),
            )
        return cls(
            kind="mesh",
            shape=(len(source.points), source.cells),
            dtype=source.values.dtype.name,
            spacing=None,
            space="native",
            unit=source.unit,
            field=source.field_name,
            range=spread.range,
            nonfinite=spread.nonfinite - source.ignored,
            ignored=source.ignored,
            histogram=spread.coarse(),
            connectivity=source.connectivity,
        )
