"""The record of a run: what was asked of each file and what came of it.

Keys are a contract (docs/report.md): a key is added with care, and none is renamed within a schema.
"""

from __future__ import annotations

import dataclasses
import math
import platform
import sys
from dataclasses import dataclass, fields
from typing import Any, Literal

SCHEMA = 1
Status = Literal["done", "empty", "skipped", "failed"]


@dataclass(frozen=True, slots=True, eq=False, kw_only=True, weakref_slot=True)
class RunReport:
    """One output: docs/report.md explains every key. None where a failed run did not get so far."""

    source: str
    output: str
    status: Status
    message: str = ""
    warnings: tuple[str, ...] = ()
    missed: tuple[str, ...] = ()
    sha256: str | None = None
    bytes: int | None = None
    kind: Literal["volume", "mesh"] | None = None
    shape: tuple[int, ...] | None = None
    dtype: str | None = None
    spacing: tuple[float, ...] | None = None
    space: str | None = None
    unit: str | None = None
    volume: int | None = None
    field: str | None = None
    range: tuple[float, float] | None = None
    nonfinite: int | None = None
    histogram: dict[str, Any] | None = None
    isovalue: float | None = None
    asked: str = ""
    chosen: str = ""
    backend: str | None = None
    options: dict[str, Any] = dataclasses.field(default_factory=dict)
    surface: dict[str, Any] | None = None
    reference: dict[str, Any] | None = None
    ratio: dict[str, Any] | None = None
    error: dict[str, Any] | None = None
    search: dict[str, Any] | None = None
    ambiguous: dict[str, Any] | None = None
    climbing: dict[str, Any] | None = None
    facts: dict[str, Any] = dataclasses.field(default_factory=dict)
    seconds: dict[str, float] = dataclasses.field(default_factory=dict)
    peak_rss_bytes: int | None = None


@dataclass(frozen=True, slots=True, eq=False)
class BatchReport:
    """All outputs of one command."""

    outputs: tuple[RunReport, ...]
    arguments: tuple[str, ...] = ()
    seconds: float = 0.0
    tool: dict[str, Any] = dataclasses.field(default_factory=lambda: tool())
    host: dict[str, Any] = dataclasses.field(default_factory=lambda: host())

    @property
    def totals(self) -> dict[str, Any]:
        """Sums over the outputs."""
        runs = self.outputs
        peaks = [run.peak_rss_bytes for run in runs if run.peak_rss_bytes is not None]
        return {
            "outputs": len(runs),
            **{status: sum(run.status == status for run in runs) for status in ("done", "empty", "skipped", "failed")},
            "missed": sum(bool(run.missed) for run in runs),
            "triangles": sum((run.surface or {}).get("triangles") or 0 for run in runs),
            "seconds": self.seconds,
            "peak_rss_bytes": max(peaks, default=None),
        }


def run_as_dict(run: RunReport) -> dict[str, Any]:
    """Plain JSON types; numbers that JSON cannot say become None."""
    return {item.name: plain(getattr(run, item.name)) for item in fields(RunReport)}


def batch_as_dict(batch: BatchReport, *, outputs: bool = True) -> dict[str, Any]:
    """The JSON report; without its outputs, an empty list stands in their place."""
    return {
        "schema": SCHEMA,
        "tool": plain(batch.tool),
        "host": plain(batch.host),
        "arguments": list(batch.arguments),
        "outputs": [run_as_dict(run) for run in batch.outputs] if outputs else [],
        "totals": plain(batch.totals),
    }


def run_from_dict(record: dict[str, Any]) -> RunReport:
    """The inverse of run_as_dict; keys of a later version are left out."""
    known = {item.name for item in fields(RunReport)}
    lists = ("warnings", "missed", "shape", "spacing", "range")
    values: dict[str, Any] = {
        key: tuple(value) if key in lists and value is not None else value for key, value in record.items()
    }
    return RunReport(**{key: value for key, value in values.items() if key in known})


def batch_from_dict(record: dict[str, Any]) -> BatchReport:
    """The inverse of batch_as_dict."""
    return BatchReport(
        outputs=tuple(run_from_dict(run) for run in record["outputs"]),
        arguments=tuple(record.get("arguments", ())),
        seconds=float((record.get("totals") or {}).get("seconds") or 0.0),
        tool=record.get("tool") or {},
        host=record.get("host") or {},
    )


def plain(value: Any) -> Any:
    """Only what JSON knows: numpy scalars become numbers, NaN and infinities None."""
    if isinstance(value, dict):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [plain(item) for item in value]
    if hasattr(value, "tolist"):
        return plain(value.tolist())
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value


def tool() -> dict[str, Any]:
    """Which program, and which of its compiled modules."""
    from isocore import __version__, _kernels

    kernels = "x86-64-v3" if getattr(_kernels.supports_v3, "__module__", "").endswith("_v3") else "base"
    return {"name": "isocore", "version": __version__, "kernels": kernels}


def host() -> dict[str, Any]:
    """The machine, as far as a report of seconds needs it."""
    import os

    return {
        "system": platform.system(),
        "machine": platform.machine(),
        "cpus": os.cpu_count(),
        "python": ".".join(str(part) for part in sys.version_info[:3]),
    }
