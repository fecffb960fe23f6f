"""A record by the keys of the JSON report, and back: the only place that knows both the sections and the keys.

Keys are a contract (docs/report.md): a key is added with care, and none is renamed within a schema.
"""

from __future__ import annotations

import math
from dataclasses import MISSING, fields, is_dataclass
from typing import TYPE_CHECKING, Any, TypeVar

from isocore.extraction import Ambiguous, Climbing, Deviation, Findings, Search, keys_of
from isocore.field_facts import FieldFacts
from isocore.histogram import Bars
from isocore.measurements import Measurements
from isocore.report.record import BatchReport, RunReport
from isocore.report.sections import Asked, Given, Ratio, Reference, Seconds, Written

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

Section = TypeVar("Section", bound="DataclassInstance")

SCHEMA = 1
#: The keys of a record, in their order.
KEYS = (
    "source", "output", "status", "message", "warnings", "missed", "sha256", "bytes",
    "kind", "shape", "dtype", "spacing", "space", "unit", "volume", "field", "range", "nonfinite", "histogram",
    "isovalue", "asked", "chosen", "offset", "backend", "backend_chosen", "options", "surface", "reference", "ratio",
    "error", "search", "ambiguous", "climbing", "facts", "seconds", "peak_rss_bytes",
)


def run_as_dict(run: RunReport) -> dict[str, Any]:
    """Plain JSON types, by KEYS; numbers that JSON cannot say become None."""
    record: dict[str, Any] = dict.fromkeys(KEYS) | {
        "status": run.status,
        "message": run.message,
        "warnings": run.warnings,
        "missed": run.missed,
        "isovalue": run.isovalue,
        "chosen": run.chosen,
        "offset": run.offset,
        "backend": run.backend,
        "backend_chosen": run.backend_chosen,
        "surface": run.surface,
        "reference": run.reference,
        "ratio": run.ratio,
        "seconds": run.seconds or {},
        "peak_rss_bytes": run.peak_rss_bytes,
    }
    for section in (run.asked, run.written, run.field, run.findings):
        if section is not None:
            record |= {item.name: getattr(section, item.name) for item in fields(section)}
    record["options"] = record["options"] or {}
    return {key: plain(value) for key, value in record.items()}


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
    """The inverse of run_as_dict; keys of a later version are left out, those an earlier one lacks are None."""
    return RunReport(
        asked=_section(Asked, record | {"options": _optional(Given, record.get("options"))}),
        status=record["status"],
        message=record.get("message", ""),
        warnings=tuple(record.get("warnings", ())),
        missed=tuple(record.get("missed", ())),
        written=_section(Written, record) if record.get("sha256") is not None else None,
        field=_field(record) if record.get("kind") is not None else None,
        isovalue=record.get("isovalue"),
        chosen=record.get("chosen", ""),
        offset=_frozen(record.get("offset")),
        backend=record.get("backend"),
        backend_chosen=record.get("backend_chosen", ""),
        surface=_optional(Measurements, record.get("surface")),
        reference=_optional(Reference, record.get("reference")),
        ratio=_optional(Ratio, record.get("ratio")),
        findings=Findings(
            error=_optional(Deviation, record.get("error")),
            search=_optional(Search, record.get("search")),
            ambiguous=_optional(Ambiguous, record.get("ambiguous")),
            climbing=_optional(Climbing, record.get("climbing")),
            facts=record.get("facts") or {},
        ),
        seconds=_optional(Seconds, record.get("seconds")),
        peak_rss_bytes=record.get("peak_rss_bytes"),
    )


def batch_from_dict(record: dict[str, Any]) -> BatchReport:
    """The inverse of batch_as_dict."""
    return BatchReport(
        outputs=tuple(run_from_dict(run) for run in record["outputs"]),
        arguments=tuple(record.get("arguments", ())),
        seconds=float((record.get("totals") or {}).get("seconds") or 0.0),
        tool=record.get("tool") or {},
        host=record.get("host") or {},
    )


def _field(record: dict[str, Any]) -> FieldFacts:
    return _section(FieldFacts, record | {"histogram": _optional(Bars, record.get("histogram"))})


def _optional(kind: type[Section], record: dict[str, Any] | None) -> Section | None:
    """The section, or None for null and for the empty object that stands for one."""
    return _section(kind, record) if record else None


def _section(kind: type[Section], record: dict[str, Any]) -> Section:
    """A section out of the keys of its fields. Raises KeyError where `source` or `output`, the identity, is missing."""
    values: dict[str, Any] = {}
    for item in fields(kind):
        if item.name in record:
            values[item.name] = _frozen(record[item.name])
        elif kind is Asked and item.default is MISSING:
            raise KeyError(item.name)
        elif item.default is MISSING:
            values[item.name] = None
    return kind(**values)


def _frozen(value: Any) -> Any:
    return tuple(_frozen(item) for item in value) if isinstance(value, list) else value


def plain(value: Any) -> Any:
    """Only what JSON knows: sections become objects, numpy scalars numbers, NaN and infinities None."""
    if is_dataclass(value) and not isinstance(value, type):
        return plain(keys_of(value))
    if isinstance(value, dict):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [plain(item) for item in value]
    if hasattr(value, "tolist"):
        return plain(value.tolist())
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value
