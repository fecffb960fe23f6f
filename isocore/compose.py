"""The parts of a run's record, from what the stages of a job produced."""

from __future__ import annotations

from dataclasses import asdict, fields, replace
from typing import Any

from isocore.backends import Extraction, Field
from isocore.histogram import Histogram
from isocore.isovalue import Chosen
from isocore.job import Options
from isocore.measurements import Measurements
from isocore.report.record import RunReport
from isocore.volume import Volume

REQUIREMENTS = ("watertight", "manifold", "nonempty")
#: Facts of a backend that have a key of their own in the record.
_NAMED_FACTS = ("error", "search", "ambiguous", "climbing")


def field_parts(source: Field, spread: Histogram) -> dict[str, Any]:
    """What the report says about the field."""
    parts: dict[str, Any] = {
        "range": spread.range,
        "nonfinite": spread.nonfinite,
        "histogram": spread.coarse(),
        "unit": source.unit,
        "warnings": source.warnings + _nonfinite_warning(spread),
    }
    if isinstance(source, Volume):
        volume = {"kind": "volume", "shape": source.shape, "dtype": source.samples.dtype.name}
        return parts | volume | {"spacing": source.spacing, "space": source.space}
    mesh = {"kind": "mesh", "shape": (len(source.points), source.cells), "dtype": source.values.dtype.name}
    return parts | mesh | {"space": "native", "field": source.field_name}


def _nonfinite_warning(spread: Histogram) -> tuple[str, ...]:
    if not spread.nonfinite:
        return ()
    return (f"{spread.nonfinite:,} samples are not finite; they count as outside, so the surface ends beside them",)


def surface_parts(found: Extraction, measured: Measurements, chosen: Chosen, known: dict[str, Any]) -> dict[str, Any]:
    """What the report says about one surface. known: the parts of the field."""
    facts = {key: value for key, value in found.facts.items() if key not in _NAMED_FACTS}
    named = {key: found.facts.get(key) for key in _NAMED_FACTS}
    empty = not len(found.surface.triangles)
    message = ""
    if empty:
        low, high = known["range"] or (float("nan"), float("nan"))
        message = f"no surface at isovalue {chosen.isovalue:g}; the samples lie between {low:g} and {high:g}"
    return named | {
        "status": "empty" if empty else "done",
        "message": message,
        "isovalue": chosen.isovalue,
        "chosen": chosen.why,
        "surface": asdict(measured),
        "facts": facts,
        "warnings": found.warnings + _border_warning(measured, known["kind"]),
    }


def _border_warning(measured: Measurements, kind: str) -> tuple[str, ...]:
    if kind != "volume" or not measured.boundary_edges:
        return ()
    edges = measured.boundary_edges
    return (f"the surface is open where it meets the volume's border ({edges:,} edges); --cap closes it",)


def options_part(options: Options, **others: Any) -> dict[str, Any]:
    """The options that were given, without those left to the backend."""
    given = {item.name: getattr(options, item.name) for item in fields(Options)}
    if options.max_error is not None:
        given["max_error"] = str(options.max_error)
    return {key: value for key, value in (given | others).items() if value is not None}


def with_reference(run: RunReport, name: str, triangles: int, vertices: int, seconds: float) -> RunReport:
    """The run beside a reference's counts. ratio: triangles is reference / ours, seconds is ours / reference."""
    ours = (run.surface or {}).get("triangles") or 0
    own_seconds = run.seconds["prepare"] + run.seconds["extract"]
    return replace(
        run,
        reference={"name": name, "triangles": triangles, "vertices": vertices, "seconds": seconds},
        ratio={
            "triangles": triangles / ours if ours else None,
            "seconds": own_seconds / seconds if seconds else None,
        },
    )


def missed(run: RunReport, require: tuple[str, ...], max_triangles: int | None) -> tuple[str, ...]:
    """The requirements that this surface does not meet, each with the count that says so."""
    surface = run.surface or {}
    misses = []
    if "watertight" in require and not surface["watertight"]:
        misses.append(f"watertight: {surface['boundary_edges']:,} open edges")
    if "manifold" in require and (surface["nonmanifold_edges"] or surface.get("nonmanifold_vertices")):
        vertices = surface.get("nonmanifold_vertices") or 0
        misses.append(f"manifold: {surface['nonmanifold_edges']:,} edges and {vertices:,} vertices are not")
    if "nonempty" in require and not surface["triangles"]:
        misses.append("nonempty: no triangles")
    if max_triangles is not None and surface["triangles"] > max_triangles:
        misses.append(f"max-triangles: {surface['triangles']:,} of at most {max_triangles:,}")
    return tuple(misses)
