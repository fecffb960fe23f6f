"""The report as a Markdown table, failures and warnings first."""

from __future__ import annotations

import re

from isocore.errors import printable
from isocore.report.record import BatchReport
from isocore.report.summary import HEADINGS, RIGHT, summary_rows, totals_line


def render_markdown(batch: BatchReport) -> str:
    """Totals, what went wrong, then one line per output."""
    lines = ["# isocore", "", totals_line(batch), ""]
    for run in batch.outputs:
        lines += [f"- **failed** {_text(run.message)}"] if run.status == "failed" else []
        lines += [f"- **missed** {_text(run.output)}: {_text(miss)}" for miss in run.missed]
    for run in batch.outputs:
        lines += [f"- {_text(run.source)}: {_text(warning)}" for warning in run.warnings]
    if lines[-1]:
        lines.append("")
    lines.append("| " + " | ".join(HEADINGS) + " |")
    lines.append("|" + "|".join("--:" if heading in RIGHT else "---" for heading in HEADINGS) + "|")
    lines += ["| " + " | ".join(_text(cell) for cell in row) + " |" for row in summary_rows(batch)]
    return "\n".join(lines) + "\n"


def _text(text: str) -> str:
    text = printable(re.sub(r"[\r\n\x0b\x0c\x85\u2028\u2029]", " ", text))
    for character in "\\|*_`<>[]":
        text = text.replace(character, "\\" + character)
    return text
