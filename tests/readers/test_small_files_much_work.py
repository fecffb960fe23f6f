"""A few bytes that ask for much: refused before the work, and in memory that the file justifies."""

from __future__ import annotations

import bz2
import lzma
import tracemalloc
import zlib
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import IO

import numpy as np
import pytest
from scans import REAL_DATA

from isocore.choices import parse_choices
from isocore.errors import InputError
from isocore.readers import ReadOptions, files_of, packed, read
from isocore.readers.members import Packing, content
from isocore.volume import Volume

HEAD = "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 10 10 10\n"
MOST_BYTES = 1 << 23


def refused(path: Path, most_bytes: int = MOST_BYTES) -> str:
    """The message of the refusal, which took no more memory than that."""
    tracemalloc.start()
    try:
        with pytest.raises(InputError) as caught:
            read(path)
        peak_bytes = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert peak_bytes < most_bytes
    return str(caught.value).removeprefix(f"{path}: ")


@pytest.mark.parametrize("numbers", ["1 300000000 1", "1 999999999999999999999999 1", "300000000 1 -1"])
def test_of_numbered_files_the_first_missing_one_ends_the_search(tmp_path: Path, numbers: str) -> None:
    """Names are made one by one, and no more of them than the samples have bytes."""
    path = tmp_path / "scan.nhdr"
    (tmp_path / "x1.raw").write_bytes(bytes(10))
    big = HEAD.replace("10 10 10", "100000 100000 100000")
    path.write_text(f"{big}encoding: raw\ndata file: x%d.raw {numbers}\n")
    assert "missing" in refused(path) or "numbers" in refused(path)
    assert files_of(path)[0] == path


def test_a_header_of_more_axes_than_sixteen_is_damaged(tmp_path: Path) -> None:
    """As many as NRRD knows are counted, those beyond never looked at."""
    path = tmp_path / "scan.nrrd"
    for axes, said in ((17, "counts 17 axes"), (18_000, "counts 18,000"), (16, "ends early"), (0, "counts 0 axes")):
        sizes = " ".join(["1"] * (axes - 3) + ["10"] * min(axes, 3))
        path.write_text(f"NRRD0004\ntype: uchar\ndimension: {axes}\nsizes: {sizes}\nencoding: raw\n\n")
        assert said in refused(path)


def test_a_field_that_is_repeated_is_read_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The last one counts, and a thousand of them cost no more than one."""
    from isocore.readers import nrrd_header

    calls: list[str] = []
    value: Callable[..., object] = nrrd_header._value

    def counted(magic: str, name: str, text: str) -> object:
        calls.append(name)
        return value(magic, name, text)

    monkeypatch.setattr(nrrd_header, "_value", counted)
    path = tmp_path / "scan.nrrd"
    path.write_bytes((HEAD + "sizes: 1 1 1\n" * 1000 + "sizes: 10 10 10\nencoding: raw\n\n").encode() + bytes(1000))
    assert isinstance(read(path), Volume) and calls.count("sizes") == 1


@pytest.mark.parametrize("skip", ["byte skip: -1\n", ""])
def test_bzip2_is_inflated_piece_by_piece(tmp_path: Path, skip: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """A few hundred bytes that hold a third of a gigabyte; what is asked for is the last, or less, thousand."""
    pieces: list[int] = []

    def counted(file: IO[bytes], packing: Packing) -> Iterator[bytes]:
        for piece in content(file, packing):
            pieces.append(len(piece))
            yield piece

    monkeypatch.setattr(packed, "content", counted)
    path = tmp_path / "scan.nrrd"
    path.write_bytes(f"{HEAD}encoding: bzip2\n{skip}\n".encode() + bz2.compress(bytes(300_000_000)))
    if skip:
        assert refused(path) and sum(pieces) < 70_000_000, "not to its end"
        assert refused(path) == (
            "inflates to more than 67,110,864 bytes, of which its last 1,000 are samples; check its byte skip"
        )
    else:
        tracemalloc.start()
        field = read(path)
        assert tracemalloc.get_traced_memory()[1] < MOST_BYTES
        tracemalloc.stop()
        assert "bytes more than its header describes" in field.warnings[0]


def test_bzip2_cannot_hold_what_it_cannot_hold(tmp_path: Path) -> None:
    """No block is that short."""
    path = tmp_path / "scan.nrrd"
    head = HEAD.replace("10 10 10", "9999 9999 9999") + "encoding: bz2\n\n"
    path.write_bytes(head.encode() + bz2.compress(bytes(9)))
    assert "of bzip2 hold at most" in refused(path)


def test_samples_in_thousands_of_files_are_read(tmp_path: Path) -> None:
    """One file per slice, as scanners write them; a process may open a thousand at once, or fewer."""
    samples = np.arange(2 * 2 * 3000, dtype=np.uint16).reshape((2, 2, 3000), order="F")
    for k in range(3000):
        (tmp_path / f"{k:04}.raw").write_bytes(samples[:, :, k].tobytes(order="F"))
    path = tmp_path / "scan.nhdr"
    head = HEAD.replace("uchar", "ushort").replace("10 10 10", "2 2 3000") + "encoding: raw\nendian: little\n"
    path.write_text(f"{head}data file: %04d.raw 0 2999 1\n")
    field = read(path)
    assert isinstance(field, Volume) and np.array_equal(field.samples, samples) and not field.warnings


@pytest.mark.parametrize("promised", [48, 47, 0])
def test_zlib_inflates_no_further_than_promised(tmp_path: Path, promised: int) -> None:
    """A part of 100 MB under a header that says 48 bytes."""
    path = _vtu(tmp_path / "a.vtu", [_block([bytes(100_000_000)], promised)])
    assert "inflates to another size than" in refused(path)


@pytest.mark.parametrize("compressor", ["vtkZLibDataCompressor", "vtkLZMADataCompressor"])
def test_a_part_that_is_cut_is_damaged(tmp_path: Path, compressor: str) -> None:
    """Also where only its checksum is missing, and all of its bytes are there."""
    pack = zlib.compress if compressor == "vtkZLibDataCompressor" else lzma.compress
    packed = pack(np.arange(6.0).tobytes())
    for cut in (1, 4, len(packed) // 2):
        block = np.array([1, 48, 0, len(packed) - cut], "<u4").tobytes() + packed[:-cut]
        path = _vtu(tmp_path / "a.vtu", [block], pack=pack)
        path.write_bytes(path.read_bytes().replace(b"vtkZLibDataCompressor", compressor.encode()))
        assert "is damaged or ends early" in refused(path, 1 << 24)  # LZMA takes eight megabytes


def test_pieces_that_share_their_bytes_are_refused_in_time(tmp_path: Path) -> None:
    """Twenty pieces of one and the same array, which would be a gigabyte."""
    many = 1_000_000
    path = _vtu(tmp_path / "a.vtu", [_block([bytes(8 * many)], 8 * many)], points=many, pieces=20)
    assert "shares its bytes with others" in refused(path, 200_000_000)


def test_a_few_shared_bytes_are_no_harm(tmp_path: Path) -> None:
    """A writer may state an array once that two pieces have."""
    path = _vtu(tmp_path / "a.vtu", [_block([np.arange(6.0).tobytes()], 48)], pieces=20)
    assert read(path, ReadOptions(field="p")).cell_counts == {"tetrahedra": 20}  # type: ignore[union-attr]  # a mesh


def test_no_isovalue_is_looked_for_among_all_others() -> None:
    """Fifty thousand of them; comparing each with each would take a minute."""
    texts = [f"{n}:{n + 1}:10000" for n in range(5)]
    assert len(parse_choices(texts * 2)) == 49_996


@pytest.mark.skipif(not REAL_DATA.is_dir(), reason=f"no real data at {REAL_DATA}")
@pytest.mark.parametrize("name", ["num.nhdr", "axes.nrrd", "bz_more.nrrd", "bz_skip.nrrd"])
def test_a_case_that_was_met_is_refused_at_once(name: str) -> None:
    """Those that took a minute or gigabytes."""
    assert refused(REAL_DATA / "cases/fuzz-12-small-files-much-work" / name)


def _block(parts: list[bytes], promised: int, pack: Callable[[bytes], bytes] = zlib.compress) -> bytes:
    packed = [pack(part) for part in parts]
    return np.array([1, promised, 0, *map(len, packed)], "<u4").tobytes() + b"".join(packed)


def _vtu(
    path: Path,
    blocks: list[bytes],
    *,
    points: int = 6,
    pieces: int = 1,
    pack: Callable[[bytes], bytes] = zlib.compress,
) -> Path:
    """Tetrahedra whose field is the first block, and whose points are three times as many zeros."""
    def array(kind: str, name: str, values: np.ndarray | None = None, extra: str = "") -> str:
        if values is not None:
            offsets.append(sum(map(len, blocks)))
            blocks.append(_block([values.tobytes()], values.nbytes, pack))
        offset = offsets[-1] if values is not None else 0
        return f'<DataArray type="{kind}" Name="{name}" format="appended" offset="{offset}"{extra}/>'

    offsets: list[int] = []
    coordinates = np.zeros(3 * points) + np.arange(3 * points) % 7
    cells = array("Int32", "connectivity", np.arange(4, dtype="<i4")) + array("Int32", "offsets", np.array([4], "<i4"))
    piece = (
        f'<Piece NumberOfPoints="{points}" NumberOfCells="1"><PointData>{array("Float64", "p")}</PointData><Points>'
        f'{array("Float64", "Points", coordinates, " NumberOfComponents=" + chr(34) + "3" + chr(34))}</Points><Cells>'
        f'{cells}{array("UInt8", "types", np.array([10], "u1"))}</Cells></Piece>'
    )
    path.write_bytes(
        b'<VTKFile type="UnstructuredGrid" byte_order="LittleEndian" header_type="UInt32"'
        b' compressor="vtkZLibDataCompressor"><UnstructuredGrid>' + piece.encode() * pieces + b"</UnstructuredGrid>"
        b'<AppendedData encoding="raw">_' + b"".join(blocks) + b"</AppendedData></VTKFile>"
    )
    return path


@pytest.mark.parametrize("name", ["p.vtu", "./p.vtu", "link.vtu"])
def test_one_piece_over_and_over_is_refused(tmp_path: Path, name: str) -> None:
    """A list of a few bytes per piece would else be a mesh of any size."""
    _vtu(tmp_path / "p.vtu", [_block([np.arange(6.0).tobytes()], 48)])
    (tmp_path / "link.vtu").symlink_to("p.vtu")
    path = tmp_path / "a.pvtu"
    pieces = '<Piece Source="p.vtu"/>' + f'<Piece Source="{name}"/>' * 20_000
    path.write_text(f'<VTKFile type="PUnstructuredGrid"><PUnstructuredGrid>{pieces}</PUnstructuredGrid></VTKFile>')
    assert refused(path, 1 << 25).endswith("p.vtu twice among its 20,001 pieces; leave one out") or name == "link.vtu"
