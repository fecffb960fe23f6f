"""The samples give the surfaces they gave when the golden counts were written."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent / "golden"))

import counts as golden


@pytest.mark.parametrize("sample", golden.ISOVALUES)
def test_the_counts_of_a_sample_have_not_changed(sample: str) -> None:
    """Changed on purpose? `make golden`, and say why in the commit."""
    assert golden.count(sample) == golden.load()[sample]


def test_the_samples_are_what_their_script_makes(tmp_path: Path) -> None:
    """Every file of sample_volumes/ holds what make.py computes, compression aside."""
    import gzip
    import subprocess

    folder = golden.SAMPLES
    subprocess.run([sys.executable, str(folder / "make.py"), str(tmp_path)], check=True, capture_output=True)
    for made in sorted(tmp_path.iterdir()):
        new, kept = made.read_bytes(), (folder / made.name).read_bytes()
        if made.name.endswith(".gz"):
            new, kept = gzip.decompress(new), gzip.decompress(kept)
        if made.suffix not in (".vtu", ".nrrd"):
            assert new == kept, made.name


def test_the_samples_are_small() -> None:
    """Under 200 kB each and 2 MB together, as a repository likes them."""
    sizes = [path.stat().st_size for path in golden.SAMPLES.iterdir() if path.is_file()]
    assert max(sizes) < 200_000
    assert sum(sizes) < 2_000_000
