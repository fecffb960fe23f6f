"""Some thousand damaged inputs of every kind, the same ones each time; `make fuzz` goes on for hours."""

from __future__ import annotations

from pathlib import Path

import pytest
from fuzz.run import fuzz, saved
from fuzz.targets import MISBEHAVING, TARGETS, Broken, check_line

RUNS = 900


@pytest.mark.parametrize("target", TARGETS)
def test_damage_is_refused_in_one_line_or_does_no_harm(target: str) -> None:
    """No other exception, no crash, no warning of Python, no memory or time that the input does not justify."""
    outcome = fuzz([target], seed=1, runs=RUNS)
    assert outcome.findings == []
    assert outcome.executions == {target: RUNS}


@pytest.mark.parametrize("kind", MISBEHAVING)
def test_the_fuzzer_notices(kind: str, tmp_path: Path) -> None:
    """Whatever a target does wrong at every other input is told of, and the inputs after it are run all the same."""
    held = bytearray(300_000_000)  # by whoever starts the process, which is nothing to it
    held[:: 1 << 12] = bytes([1]) * len(held[:: 1 << 12])
    outcome = fuzz([kind], seed=1, runs=8)
    assert outcome.executions == {kind: 8} and 1 <= len(outcome.findings) <= 7
    for finding in outcome.findings:
        assert finding["kind"] == ("crash" if kind == "exit" else kind)
        assert (saved(finding, tmp_path) / "f").is_file()


def test_a_message_may_hold_wide_spaces_but_nothing_that_moves_a_cursor() -> None:
    """Names have them, as Japanese ones do; a message shows them as they are."""
    check_line("脳\u3000図.nii: no such file; check the path")
    for character in "\n\r\t\x1b\u202e":
        with pytest.raises(Broken):
            check_line(f"a{character}.nii: no such file; check the path")
