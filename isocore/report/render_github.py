"""What went wrong, as lines that GitHub shows beside the run."""

from __future__ import annotations

from isocore.report.record import BatchReport


def github_annotations(batch: BatchReport) -> list[str]:
    """One workflow command per failure, missed requirement, empty surface and warning, but for old warnings."""
    lines = []
    for run in batch.outputs:
        place = f"file={_property(run.source)}"
        if run.status == "failed":
            lines.append(f"::error {place},title=isocore::{_data(run.message)}")
        lines += [f"::error {place},title=isocore missed::{_data(f'{run.output}: {miss}')}" for miss in run.missed]
        if run.is_empty:
            why = run.message if run.status == "empty" else "the surface is empty"
            lines.append(f"::warning {place},title=isocore empty::{_data(f'{run.output}: {why}')}")
        if run.status != "skipped":  # the run that made the output has said them
            lines += [f"::warning {place},title=isocore::{_data(warning)}" for warning in run.warnings]
    return lines


def _data(text: str) -> str:
    return text.replace("%", "%25").replace("\r", "%0D").replace("\n", "%0A")


def _property(text: str) -> str:
    return _data(text).replace(":", "%3A").replace(",", "%2C")
