"""The record of a run: what was asked of each file and what came of it."""

from __future__ import annotations

import dataclasses
import os
import platform
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from isocore import _kernels
from isocore.copies import Copy
from isocore.errors import shortened
from isocore.extraction import Findings
from isocore.field_facts import FieldFacts
from isocore.measurements import Measurements
from isocore.report.sections import Asked, Carried, Colors, Ratio, Reference, Seconds, Written
from isocore.version import __version__

#: Of all copies of surfaces in a page together, unless told otherwise.
MESH_BYTES = 16 << 20

Status = Literal["done", "empty", "skipped", "failed"]


@dataclass(frozen=True, slots=True, eq=False, kw_only=True, weakref_slot=True)
class RunReport:
    """One output. None where a failed run did not get so far; docs/report.md explains every key.

    carried: fields that vertices have values of; colors: what they are coloured by.
    missed: requirements that the surface does not meet.
    isovalue: the number; chosen: how it came about. backend_chosen: the same of the backend.
    offset: the point that vertices are written about, where one was asked for.
    peak_rss_bytes: of the job, before the reference ran; None where the system does not tell.
    copy: of the surface, for a page; no key of the JSON report.
    message, warnings and missed are kept printable, each on one line.
    """

    asked: Asked
    status: Status
    message: str = ""
    warnings: tuple[str, ...] = ()
    missed: tuple[str, ...] = ()
    written: Written | None = None
    field: FieldFacts | None = None
    isovalue: float | None = None
    chosen: str = ""
    offset: tuple[float, float, float] | None = None
    backend: str | None = None
    backend_chosen: str = ""
    surface: Measurements | None = None
    carried: tuple[Carried, ...] = ()
    colors: Colors | None = None
    reference: Reference | None = None
    ratio: Ratio | None = None
    findings: Findings = dataclasses.field(default_factory=Findings)
    seconds: Seconds | None = None
    peak_rss_bytes: int | None = None
    copy: Copy | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "message", shortened(self.message))
        for name in ("warnings", "missed"):
            object.__setattr__(self, name, tuple(map(shortened, getattr(self, name))))

    def __repr__(self) -> str:
        """What became of it."""
        what = self.message if self.status == "failed" else f"{self.triangles:,} triangles"
        return f"RunReport({self.output or self.source}: {self.status}, {what})"

    @property
    def source(self) -> str:
        """The input, as it was named."""
        return self.asked.source

    @property
    def output(self) -> str:
        """The surface's file, as it was named; `-` is stdout."""
        return self.asked.output

    @property
    def triangles(self) -> int:
        """Of the surface; 0 where there is none."""
        return 0 if self.surface is None else self.surface.triangles or 0

    @property
    def is_empty(self) -> bool:
        """Whether there is a surface and it has no triangles; also where an earlier run made it."""
        return self.surface is not None and self.surface.triangles == 0


@dataclass(frozen=True, slots=True, eq=False)
class BatchReport:
    """All outputs of one command; folder: the one that it ran in, where paths start that are not absolute."""

    outputs: tuple[RunReport, ...]
    arguments: tuple[str, ...] = ()
    seconds: float = 0.0
    tool: dict[str, Any] = dataclasses.field(default_factory=lambda: tool())
    host: dict[str, Any] = dataclasses.field(default_factory=lambda: host())
    folder: str = ""

    def __repr__(self) -> str:
        """How many outputs there are, and what became of them."""
        totals = self.totals
        parts = [f"{totals[status]} {status}" for status in ("done", "empty", "skipped", "failed") if totals[status]]
        return f"BatchReport({', '.join(parts) or 'no output'}, {totals['triangles']:,} triangles)"

    @property
    def totals(self) -> dict[str, Any]:
        """Sums over the outputs."""
        runs = self.outputs
        peaks = [run.peak_rss_bytes for run in runs if run.peak_rss_bytes is not None]
        return {
            "outputs": len(runs),
            **{status: sum(run.status == status for run in runs) for status in ("done", "empty", "skipped", "failed")},
            "missed": sum(bool(run.missed) for run in runs),
            "triangles": sum(run.triangles for run in runs),
            "seconds": self.seconds,
            "peak_rss_bytes": max(peaks, default=None),
        }


def tool() -> dict[str, Any]:
    """Which program, and which of its compiled modules."""
    kernels = "x86-64-v3" if _kernels.BUILD == "v3" else _kernels.BUILD
    return {"name": "isocore", "version": __version__, "kernels": kernels}


def host() -> dict[str, Any]:
    """The machine, as far as a report of seconds needs it."""
    return {
        "system": platform.system(),
        "machine": platform.machine(),
        "cpus": os.cpu_count(),
        "python": ".".join(str(part) for part in sys.version_info[:3]),
    }


def working_folder() -> str:
    """Where relative paths of this process start; "" where that is gone."""
    try:
        return str(Path.cwd())
    except OSError:
        return ""
