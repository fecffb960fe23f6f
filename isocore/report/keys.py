"""A record by the keys of the JSON report, and back: the only place that knows both the sections and the keys.

Keys are a contract (docs/report.md): a key is added with care, and none is renamed within a schema.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, fields, is_dataclass
from typing import Any

from isocore.errors import InputError
from isocore.extraction import Findings, keys_of
from isocore.field_facts import FieldFacts
from isocore.report.record import BatchReport, RunReport
from isocore.report.schema import built
from isocore.report.sections import Asked, Written

SCHEMA = 1
#: The keys of a record, in their order.
KEYS = (
    "source", "output", "status", "message", "warnings", "missed", "sha256", "bytes", "kind", "shape", "dtype",
    "spacing", "space", "unit", "volume", "step", "time", "field", "connectivity", "range", "nonfinite", "ignored",
    "histogram", "isovalue", "asked", "chosen", "offset", "backend", "backend_chosen", "options", "surface",
    "carried", "colors", "reference", "ratio", "simplification", "error", "search", "ambiguous", "climbing", "label",
    "pieces", "facts", "seconds", "peak_rss_bytes",
)


@dataclass(frozen=True, slots=True)
class _Totals:
    """Of the sums over the records, the one that the records do not give."""

    seconds: float = 0.0


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
        "carried": run.carried,
        "colors": run.colors,
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
        "folder": batch.folder,
        "arguments": list(batch.arguments),
        "outputs": [run_as_dict(run) for run in batch.outputs] if outputs else [],
        "totals": plain(batch.totals),
    }


def run_from_dict(record: dict[str, Any], place: str = "", *, complete: bool = False) -> RunReport:
    """The inverse of run_as_dict; keys of a later version are left out, those an earlier one lacks are None.

    place: of the record in its file, for messages. complete: no key of this version may be missing.
    Raises InputError, without a path, for a record without its identity or with a value of another type.
    """
    if not isinstance(record, dict):
        return built(RunReport, record, place)
    flat = {
        "asked": built(Asked, record, place, needed=("source", "output"), complete=complete),
        "written": None if record.get("sha256") is None else built(Written, record, place, complete=complete),
        "field": None if record.get("kind") is None else built(FieldFacts, record, place, complete=complete),
        "findings": built(Findings, record, place, complete=complete),
        "copy": None,
    }
    return built(RunReport, record, place, given=flat, needed=("status",), complete=complete)


def batch_from_dict(record: dict[str, Any]) -> BatchReport:
    """The inverse of batch_as_dict. Raises InputError, without a path, where a value is missing or of another type."""
    outputs, totals = record.get("outputs"), record.get("totals")
    if not isinstance(outputs, list):
        raise InputError("lacks outputs, a list")
    runs = tuple(run_from_dict(run, f"outputs[{n}]") for n, run in enumerate(outputs))
    seconds = _Totals().seconds if totals is None else built(_Totals, totals, "totals").seconds
    made = {"tool": record.get("tool") or {}, "host": record.get("host") or {}}
    return built(BatchReport, record | made, "", given={"outputs": runs, "seconds": seconds})


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
