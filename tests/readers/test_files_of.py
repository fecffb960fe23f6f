"""The files beside an input that belong to it: what a depfile names, a stamp covers and a folder search leaves out."""

from __future__ import annotations

from pathlib import Path

import pytest

from isocore.batches.plan import find_inputs
from isocore.readers import content_bytes, files_of, nifti

HEAD = ["NRRD0004", "type: uchar", "dimension: 3", "sizes: 2 2 4", "encoding: raw"]


def nhdr(folder: Path, *lines: str, head: list[str] = HEAD) -> Path:
    """A header of these lines, and beside it s1.raw, s2.raw and s10.raw."""
    for name in ("s1.raw", "s2.raw", "s10.raw"):
        (folder / name).write_bytes(bytes(8))
    path = folder / "scan.nhdr"
    path.write_text("\n".join([*head, *lines, ""]), encoding="utf-8")
    return path


def beside(path: Path) -> list[str]:
    first, *others = files_of(path)
    assert first == path
    return [other.name for other in others]


@pytest.mark.parametrize(
    ("lines", "names"),
    [
        (("data file: s1.raw",), ["s1.raw"]),
        (("DataFile: ./s1.raw",), ["s1.raw"]),
        (("data file: LIST", "s2.raw", "gone.raw", "s1.raw"), ["s2.raw", "s1.raw"]),
        (("data file: s%d.raw 1 2 1",), ["s1.raw", "s2.raw"]),
        (("data file: s%d.raw 10 2 -8",), ["s10.raw", "s2.raw"]),
        (("data file: gone.raw",), []),
        (("data file:",), []),
        ((), []),
    ],
)
def test_a_detached_header_names_its_data(tmp_path: Path, lines: tuple[str, ...], names: list[str]) -> None:
    """One file, a list, or numbers; as far as they exist."""
    assert beside(nhdr(tmp_path, *lines)) == names


@pytest.mark.parametrize("head", [[], ["NRRD0009"], ["NRRD0004", "type: colour", "sizes: many", "no field at all"]])
def test_a_damaged_header_names_its_data_too(tmp_path: Path, head: list[str]) -> None:
    """Mending it is a change of the input, and so is mending the data."""
    assert beside(nhdr(tmp_path, "data file: s1.raw", head=["damaged", *head][bool(head) :])) == ["s1.raw"]


def test_what_belongs_to_an_input_counts_for_its_memory(tmp_path: Path) -> None:
    """A header of few bytes stands for all of its samples."""
    path = nhdr(tmp_path, "data file: s%d.raw 1 2 1")
    assert content_bytes(path) == path.stat().st_size + 2 * 8


def test_a_header_that_numbers_billions_ends_soon(tmp_path: Path) -> None:
    """Numbers beyond what any scan has are not looked for."""
    assert beside(nhdr(tmp_path, "data file: s%d.raw 1 3000000000 1")) == ["s1.raw", "s2.raw", "s10.raw"]
    assert beside(nhdr(tmp_path, f"data file: s%d.raw 1 {10**30} 1")) == ["s1.raw", "s2.raw", "s10.raw"]
    assert beside(nhdr(tmp_path, "data file: s%d.raw 2 1 1")) == []


def test_names_beyond_ascii_are_followed(tmp_path: Path) -> None:
    """As the reader follows them."""
    (tmp_path / "Schädel.raw").write_bytes(bytes(16))
    assert beside(nhdr(tmp_path, "data file: Schädel.raw")) == ["Schädel.raw"]


@pytest.mark.parametrize(
    ("header", "image"), [("a.hdr", "a.img"), ("a.HDR", "a.IMG"), ("a.hdr", "a.img.gz"), ("a.hdr.gz", "a.img.gz")]
)
def test_a_header_and_its_image_belong_together(tmp_path: Path, header: str, image: str) -> None:
    """Whichever is named."""
    (tmp_path / header).touch()
    assert beside(tmp_path / header) == []
    (tmp_path / image).touch()
    assert beside(tmp_path / header) == [image]
    if header.endswith(".gz") == image.endswith(".gz"):
        assert beside(tmp_path / image) == [header]


@pytest.mark.parametrize("name", ["a.raw", "a.raw.gz"])
def test_a_sidecar_belongs_to_its_samples(tmp_path: Path, name: str) -> None:
    """The one that the reader reads."""
    assert beside(tmp_path / name) == []
    (tmp_path / "a.raw.json").touch()
    (tmp_path / "a.raw.gz.json").touch()
    assert beside(tmp_path / name) == ["a.raw.json"]


def test_what_cannot_be_looked_at_stands_alone(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """An image without its header, a folder without access: reading says why, not this."""
    assert beside(tmp_path / "a.img") == [] and beside(tmp_path / "a.nii") == [] and beside(tmp_path / "a.txt") == []

    def locked(path: Path) -> tuple[Path, None]:
        raise PermissionError(path)

    monkeypatch.setattr(nifti, "_pair", locked)
    assert beside(tmp_path / "a.hdr") == []


@pytest.mark.parametrize("line", ["data file: LIST\n./s1.raw\ns2.raw\ns10.raw", "data file: s%d.raw 1 10 1"])
def test_a_folder_search_leaves_out_the_data_of_headers(tmp_path: Path, line: str) -> None:
    """However many files there are."""
    path = nhdr(tmp_path, line)
    (tmp_path / "s1.nii").touch()
    assert [item.path for item in find_inputs([tmp_path])] == [tmp_path / "s1.nii", path]
