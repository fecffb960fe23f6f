"""What is no field, or is elsewhere, is named, and so is what to do about it."""

from __future__ import annotations

import gzip
import io
import os
import tarfile
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from isocore.cli.convert import convert
from scans import patched, ramp, save

from isocore.batches.inputs import find_inputs
from isocore.errors import InputError, IsocoreError, OptionError
from isocore.readers import SEARCHED, ReadOptions, count_volumes, files_of, read, suffix_of
from isocore.readers.formats import BY_SUFFIX
from isocore.readers.strangers import STRANGERS
from isocore.volume import Volume

LFS = b"version https://git-lfs.github.com/spec/v1\noid sha256:%064x\nsize 123456\n" % 7
ANNEX = b"/annex/objects/MD5E-s123456--00000000000000000000000000000000.nii.gz\n"
HTML = b"\n<!DOCTYPE html>\n<html><head><title>404</title></head></html>"


def refused(path: Path) -> str:
    """The message of the refusal, without the path."""
    with pytest.raises(IsocoreError) as caught:
        read(path, ReadOptions(shape=(40, 50, 60), dtype="uint8"))
    message = str(caught.value)
    assert message.startswith(f"{path}: ") and len(message) <= 300
    return message.removeprefix(f"{path}: ")


@pytest.mark.parametrize("suffix", [suffix for suffix in BY_SUFFIX if suffix not in (".img", ".img.gz")])
@pytest.mark.parametrize(
    ("content", "said"),
    [
        (LFS, "is a git-lfs pointer of a file of 123,456 bytes; run git lfs pull"),
        (LFS.replace(b"\nsize 123456\n", b"\n"), "is a git-lfs pointer of a file; run git lfs pull"),
        (ANNEX, "is a git-annex pointer of a file of 123,456 bytes that is not here; run git annex get"),
        (b"../../.git/annex/objects/aa/bb/SHA256E-s9--0/SHA256E-s9--0", "is a git-annex pointer of a file of 9 bytes"),
        (HTML, "is a web page (HTML) under the name of a download; open it to see why, and download the file again"),
        (b"\xef\xbb\xbf<HTML>", "is a web page (HTML)"),
        (b'<?xml version="1.0"?><Error><Code>AccessDenied</Code>', "is the error message of a server"),
        (b'{"message": "Not Found"}', "is the error message of a server"),
        (b"404: Not Found", "is the error message of a server"),
    ],
)
def test_data_that_is_elsewhere_is_named_under_any_suffix(
    tmp_path: Path, suffix: str, content: bytes, said: str
) -> None:
    """Pointers of repositories that were cloned without their large files, and pages of servers."""
    path = tmp_path / f"scan{suffix}"
    path.write_bytes(content)
    assert refused(path).startswith(said)


def test_data_files_that_are_pointers_are_named(tmp_path: Path) -> None:
    """The header came along, what it names did not."""
    path = tmp_path / "scan.nhdr"
    path.write_text("NRRD0004\ntype: uchar\ndimension: 3\nsizes: 9 9 9\nencoding: raw\ndata file: scan.raw\n")
    (tmp_path / "scan.raw").write_bytes(LFS)
    assert refused(path) == "its file scan.raw is a git-lfs pointer of a file of 123,456 bytes; run git lfs pull"
    (tmp_path / "scan.raw").unlink()
    (tmp_path / "scan.raw").symlink_to(".git/annex/objects/x/y.raw")
    assert "scan.raw is a git-annex link to a file that is not here; run git annex get" in refused(path)
    save(tmp_path / "pair.hdr", ramp((9, 9, 9)))
    (tmp_path / "pair.img").write_bytes(ANNEX)
    assert refused(tmp_path / "pair.hdr").startswith("its file pair.img is a git-annex pointer")


def test_links_that_lead_nowhere_are_no_missing_files(tmp_path: Path) -> None:
    """The path is right; what it leads to is not here."""
    for name, target, said in (
        ("a.nii.gz", ".git/annex/objects/xx/a.nii.gz", "is a git-annex link to a file that is not here; run git"),
        ("b.vtu", "elsewhere/b.vtu", "is a link to elsewhere/b.vtu, which is not here; fetch that file"),
        ("c.dcm", "c.dcm", "is a link to c.dcm"),
    ):
        (tmp_path / name).symlink_to(target)
        assert said in refused(tmp_path / name)
    assert refused(tmp_path / "d.nii") == "no such file; check the path"


def test_a_link_that_was_checked_out_as_text_is_named(tmp_path: Path) -> None:
    """As git does it on systems without symbolic links."""
    path = tmp_path / "scan.nii.gz"
    path.write_text("../data/scan.nii.gz")
    assert refused(path) == (
        "is the text of a link to ../data/scan.nii.gz; give that file, or check out with symbolic links"
    )


def _tar() -> bytes:
    stream = io.BytesIO()
    with tarfile.open(fileobj=stream, mode="w") as archive:
        archive.addfile(tarfile.TarInfo("scan.nii"), io.BytesIO(b""))
    return stream.getvalue()


def _npy() -> bytes:
    stream = io.BytesIO()
    np.save(stream, np.zeros(3))
    return stream.getvalue()


#: What is written -> what is said of it, under a suffix that promises something else and under none.
CONTENTS = {
    "is a DICOM file": bytes(128) + b"DICM" + bytes(300),
    "is a VTK surface (PolyData)": b'<?xml version="1.0"?>\n<VTKFile type="PolyData" version="1.0">',
    "is a structured grid of VTK": b"<VTKFile version='1.0' type='StructuredGrid'>",
    "is an HDF5 file": b"\x89HDF\r\n\x1a\n" + bytes(400),
    "is a NetCDF file": b"CDF\x01" + bytes(400),
    "is a PLY surface": b"ply\nformat ascii 1.0\n",
    "is an STL surface": b"solid bone\n facet normal 0 0 1\n",
    "is a numpy array": _npy(),
    "is a picture, TIFF": b"II*\0" + bytes(400),
    "is a picture, one": b"\x89PNG\r\n\x1a\n" + bytes(400),
    "is an archive (zip)": b"PK\x03\x04" + bytes(400),
    "is an archive (tar)": _tar(),
    "is a PDF": b"%PDF-1.4",
    "is packed with xz": b"\xfd7zXZ\0" + bytes(30),
    "is packed with zstd": b"\x28\xb5\x2f\xfd" + bytes(30),
    "is a Gmsh mesh": b"$MeshFormat\n2.2 0 8\n",
    "is a GIFTI surface": b'<?xml version="1.0"?>\n<!DOCTYPE GIFTI SYSTEM "x">\n<GIFTI Version="1.0">',
    "is zeros from its first byte on": bytes(400),
}


@pytest.mark.parametrize("said", CONTENTS)
@pytest.mark.parametrize("name", ["scan.nii", "scan.nii.gz", "scan.nrrd", "scan.nhdr", "scan.vtu", "scan", "IM0001"])
def test_files_of_other_formats_are_named(tmp_path: Path, said: str, name: str) -> None:
    """Whatever their names say, also packed with gzip."""
    path = tmp_path / name
    for content in (CONTENTS[said], gzip.compress(CONTENTS[said])):
        path.write_bytes(content)
        message = refused(path)
        assert message.startswith(said) and "; " in message


@pytest.mark.parametrize("stranger", STRANGERS, ids=lambda stranger: stranger.what)
def test_a_suffix_that_is_not_read_is_named_too(tmp_path: Path, stranger: object) -> None:
    """Where the content tells nothing; and what a reader reads is never turned away by its row here."""
    for suffix in getattr(stranger, "suffixes"):  # noqa: B009
        if suffix not in BY_SUFFIX:
            path = tmp_path / f"scan{suffix}"
            path.write_bytes(b"\1\2\3" * 500)
            assert refused(path).startswith("is ") and "; " in refused(path)


@pytest.mark.parametrize("suffix", [".nii", ".nii.gz", ".nrrd", ".mha", ".mhd", ".mgz", ".mgh"])
def test_a_known_format_is_known_by_its_content(tmp_path: Path, suffix: str) -> None:
    """Under a suffix of another format and under none; a warning says so, and its files are found."""
    path = save(tmp_path / f"scan{suffix}", ramp())
    sound = read(path)
    assert isinstance(sound, Volume)
    for wrong in ("scan", "scan.dat", "scan.vtu", "scan.nhdr", "scan.nii", "scan.mgz"):
        if BY_SUFFIX.get(suffix_of(Path(wrong)) or "") is BY_SUFFIX[suffix]:
            continue
        path = path.rename(tmp_path / wrong)
        found = read(path)
        assert isinstance(found, Volume) and np.array_equal(found.samples, sound.samples), wrong
        assert np.array_equal(found.affine, sound.affine) and count_volumes(path) == 1
        assert "its content is a" in found.warnings[0] and found.warnings[0].endswith("was read as that")
    assert len(files_of(path.rename(tmp_path / "scan.dat"))) == (2 if suffix == ".mhd" else 1)


def test_a_known_format_that_is_damaged_too_says_so(tmp_path: Path) -> None:
    """What is wrong with it, as its own reader has it."""
    path = save(tmp_path / "scan.nii", ramp())
    path.write_bytes(path.read_bytes()[:-3])
    assert refused(path.rename(tmp_path / "scan.nrrd")).startswith("ends early")


def test_a_damaged_file_of_its_own_suffix_is_no_stranger(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """What is wrong with it is said as before."""
    path = save(tmp_path / "scan.nii", ramp())
    path.write_bytes(path.read_bytes()[:-3])
    assert refused(path).startswith("ends early")
    patched(path, 40, b"\x63")
    assert refused(path).startswith("header counts 99 axes")
    (tmp_path / "scan.xyz").write_bytes(b"\1\2\3")
    monkeypatch.chdir(tmp_path)  # a message has 300 characters, and a long path takes them from the list
    assert refused(Path("scan.xyz")) == f"has no suffix known here; known are {', '.join(SEARCHED)}"


def test_bare_samples_may_begin_with_anything(tmp_path: Path) -> None:
    """A raw file is read as it is told to be, and only words in it are taken for words."""
    path = tmp_path / "scan.raw"
    for head in (LFS, HTML, b"PK\x03\x04", bytes(8)):
        path.write_bytes(head.ljust(120, b"\1")[:120])
        if len(head) <= 120:
            assert isinstance(read(path, ReadOptions(shape=(4, 5, 6), dtype="uint8")), Volume)
    path.write_bytes(b"PK\x03\x04")
    assert refused(path).startswith("ends early")
    path.write_bytes(LFS)
    with pytest.raises(InputError, match="is a git-lfs pointer"):
        read(path)


def test_a_folder_without_inputs_says_what_it_holds(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Exit code 2, and what to do with the first file that is known by name or by its first bytes."""
    series = tmp_path / "series"
    series.mkdir()
    (series / "IM0001").write_bytes(bytes(128) + b"DICM" + bytes(300))
    (tmp_path / "image.zarr" / "0").mkdir(parents=True)
    for folder, said in ((series, "IM0001 is a DICOM file"), (tmp_path / "image.zarr", "is an OME-Zarr image")):
        run = CliRunner().invoke(convert, [str(folder), "-i", "1"])
        assert isinstance(run.exception, OptionError) and said in str(run.exception)
    (series / "IM0001").unlink()
    os.mkfifo(series / "IM0001")
    monkeypatch.chdir(tmp_path)
    with pytest.raises(OptionError, match="holds no file isocore reads; known are"):
        find_inputs([Path("series")])


def test_a_batch_names_each(tmp_path: Path) -> None:
    """Exit code 1, one line each."""
    for name, content in (("a.nii.gz", LFS), ("b.nrrd", HTML), ("c.vtu", ANNEX)):
        (tmp_path / name).write_bytes(content)
    (tmp_path / "d.nii.gz").symlink_to(".git/annex/objects/d")
    run = CliRunner().invoke(convert, [str(tmp_path), "-i", "1", "-d", str(tmp_path / "out"), "-q"])
    assert run.exit_code == 1
    for said in ("run git lfs pull", "is a web page", "run git annex get", "is a git-annex link"):
        assert said in run.output
