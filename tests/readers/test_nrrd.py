"""NRRD: encodings, detached data, axes that are not space, spaces and units."""

from __future__ import annotations

import bz2
import gzip
from collections.abc import Callable
from pathlib import Path

import nrrd
import numpy as np
import pytest
from scans import ramp

from isocore.errors import FieldError, InputError, IsocoreError
from isocore.readers import ReadOptions, count_volumes, read
from isocore.volume import Volume

HEAD = {"type": "short", "dimension": "3", "sizes": "4 5 6", "encoding": "raw", "endian": "little"}


def volume_of(path: Path, volume: int | None = None) -> Volume:
    """The volume in `path`."""
    field = read(path, ReadOptions(volume=volume))
    assert isinstance(field, Volume)
    return field


def written(path: Path, content: bytes | None = None, **fields: str) -> Path:
    """A NRRD file with these fields (blanks as _; one of "" is left out) and its samples behind the head."""
    lines = {**HEAD, **{name.replace("_", " "): value for name, value in fields.items()}}
    head = "".join(f"{name}: {value}\n" for name, value in lines.items() if value)
    content = ramp().tobytes(order="F") if content is None else content
    path.write_bytes(f"NRRD0005\n# a remark\nkey:=value\n{head}\n".encode() + content)
    return path


@pytest.mark.parametrize(
    ("encoding", "encode"),
    [
        ("raw", bytes),
        ("gzip", gzip.compress),
        ("gz", gzip.compress),
        ("bzip2", bz2.compress),
        ("bz2", bz2.compress),
        ("hex", lambda raw: raw.hex(" ", 1).encode()),
        ("HEX", lambda raw: raw.hex("\n", 8).upper().encode()),
        ("ascii", lambda raw: " ".join(map(str, np.frombuffer(raw, "<i2"))).encode()),
        ("text", lambda raw: "\n".join(map(str, np.frombuffer(raw, "<i2"))).encode()),
        ("txt", lambda raw: "\t".join(map(str, np.frombuffer(raw, "<i2"))).encode()),
    ],
)
def test_every_encoding_is_read(tmp_path: Path, encoding: str, encode: Callable[[bytes], bytes]) -> None:
    """To the same samples."""
    path = written(tmp_path / "scan.nrrd", encode(ramp().tobytes(order="F")), encoding=encoding)
    volume = volume_of(path)
    assert np.array_equal(volume.samples, ramp()) and not volume.warnings


@pytest.mark.parametrize("name", ["zrl", "rubbish"])
def test_an_unknown_encoding_is_refused_by_name(tmp_path: Path, name: str) -> None:
    """And another one is proposed."""
    with pytest.raises(InputError, match=f"encoding '{name}', which cannot be read; use raw or gzip"):
        read(written(tmp_path / "scan.nrrd", encoding=name))


@pytest.mark.parametrize(
    ("said", "space"),
    [
        ("right-anterior-superior", "ras"),
        ("RAS", "ras"),
        ("left-anterior-superior", "las"),
        ("las", "las"),
        ("left-posterior-superior", "lps"),
        ("LPS", "lps"),
        ("3D-right-handed", "native"),
        ("", "native"),
    ],
)
def test_the_space_is_the_header_s_own(tmp_path: Path, said: str, space: str) -> None:
    """Nothing is turned; the volume says which world it lies in."""
    volume = volume_of(
        written(
            tmp_path / "scan.nrrd",
            space=said,
            space_dimension="" if said else "3",
            space_directions="(0,2,0) (-3,0.5,0) (0,0,4)",
            space_origin="(7, 8, -9)",
        )
    )
    assert volume.space == space and volume.unit == ""
    assert volume.affine.tolist() == [[0, -3, 0, 7], [2, 0.5, 0, 8], [0, 0, 4, -9], [0, 0, 0, 1]]


@pytest.mark.parametrize(
    ("units", "factors", "unit"),
    [
        ('"mm" "mm" "mm"', (1, 1, 1), "mm"),
        ('"microns" "um" "μm"', (1e-3, 1e-3, 1e-3), "mm"),
        ('"m" "cm" "mm"', (1000, 10, 1), "mm"),
        ("mm mm mm", (1, 1, 1), "mm"),
        ('"pixel" "pixel" "pixel"', (1, 1, 1), ""),
        ('"mm" "mm"', (1, 1, 1), ""),
    ],
)
def test_units_of_the_world_become_millimetres(
    tmp_path: Path, units: str, factors: tuple[float, ...], unit: str
) -> None:
    """Each world axis by its own; one that is not known leaves all as they are."""
    path = tmp_path / "scan.nrrd"
    volume = volume_of(written(path, space="LPS", space_directions="(1,1,1) (0,1,0) (0,0,1)", space_units=units))
    assert np.allclose(volume.affine[:3, 0], factors) and volume.unit == unit


@pytest.mark.parametrize(
    ("fields", "steps", "firsts"),
    [
        ({"spacings": "2 3 4"}, (2, 3, 4), (0, 0, 0)),
        ({"spacings": "2 nan 4"}, (2, 1, 4), (0, 0, 0)),
        ({"axis mins": "5 6 7", "axis maxs": "8 10 12"}, (1, 1, 1), (5, 6, 7)),
        (
            {"axis mins": "5 6 7", "axis maxs": "9 16 19", "centerings": "cell cell node"},
            (1, 2, 2.4),
            (5.5, 7, 7),
        ),
        ({"spacings": "2 3 4", "axis mins": "1 1 1", "centerings": "node cell ???"}, (2, 3, 4), (1, 2.5, 1)),
        ({"spacings": "2 3 4", "space directions": "none none none", "space": "RAS"}, (2, 3, 4), (0, 0, 0)),
        ({}, (1, 1, 1), (0, 0, 0)),
    ],
)
def test_axes_alone_place_a_volume_too(
    tmp_path: Path, fields: dict[str, str], steps: tuple[float, ...], firsts: tuple[float, ...]
) -> None:
    """Spacings, or the ends of the axes, of cells or of their nodes."""
    volume = volume_of(written(tmp_path / "scan.nrrd", **fields))
    assert np.allclose(volume.affine[:3, :3], np.diag(steps)) and np.allclose(volume.affine[:3, 3], firsts)


@pytest.mark.parametrize(
    ("sizes", "fields", "axis"),
    [
        ("4 5 6 3", {}, 3),
        ("3 4 5 6", {"kinds": "vector space space space"}, 0),
        ("3 4 5 6", {"space": "RAS", "space directions": "none (1,0,0) (0,1,0) (0,0,1)"}, 0),
        ("4 3 5 6", {"kinds": "domain list domain domain"}, 1),
        ("4 5 3 6", {"kinds": "domain domain time domain"}, 2),
        ("4 5 6 3", {"kinds": "space space space time", "space directions": "none none none none"}, 3),
        ("3 1 4 5 6", {"kinds": "3-vector stub space space space"}, 0),
        ("4 5 6 1 3", {}, 3),
    ],
)
def test_the_axis_that_is_not_space_may_be_any(tmp_path: Path, sizes: str, fields: dict[str, str], axis: int) -> None:
    """Its entries are the file's volumes, and none is mixed with another."""
    shape = tuple(map(int, sizes.split()))
    samples = ramp(shape)
    fields = {"dimension": str(len(shape)), "sizes": sizes, **fields}
    if sizes == "4 5 6 1 3":
        fields["kinds"] = "space space space stub list"
    path = written(tmp_path / "scan.nrrd", samples.tobytes(order="F"), **fields)
    assert count_volumes(path) == 3
    spatial = samples.reshape([size for size in shape if size != 1], order="F")
    for volume in range(3):
        assert np.array_equal(volume_of(path, volume).samples, np.take(spatial, volume, axis=axis))


@pytest.mark.parametrize("sizes", ["4 5 6 1", "1 4 5 6", "1 4 5 6 1", "4 5 6 1 1"])
def test_an_outer_axis_of_one_is_no_axis(tmp_path: Path, sizes: str) -> None:
    """Where nothing says which axes lie in space; one between others may be a slice, and is left."""
    fields = {"dimension": str(len(sizes.split())), "sizes": sizes}
    assert np.array_equal(volume_of(written(tmp_path / "scan.nrrd", **fields)).samples, ramp())
    with pytest.raises(FieldError, match="holds 4x5x1 samples"):
        read(written(tmp_path / "scan.nrrd", dimension="4", sizes="4 5 1 6"))


@pytest.mark.parametrize("sizes", [(3, 70, 70, 80), (70, 3, 70, 80), (70, 70, 3, 80), (700, 500, 3, 3)])
def test_interleaved_volumes_are_taken_apart_in_pieces(tmp_path: Path, sizes: tuple[int, ...]) -> None:
    """Also where a file is longer than one piece, and where one slice is."""
    samples = ramp(sizes, dtype="uint16")
    axis = sizes.index(3)
    kinds = " ".join("list" if at == axis else "space" for at in range(4))
    fields = {
        "type": "ushort",
        "dimension": "4",
        "sizes": " ".join(map(str, sizes)),
        "kinds": kinds,
        "encoding": "gzip",
    }
    path = written(tmp_path / "scan.nrrd", gzip.compress(samples.tobytes(order="F"), 1), **fields)
    for volume in range(3):
        assert np.array_equal(volume_of(path, volume).samples, np.take(samples, volume, axis=axis))


@pytest.mark.parametrize(
    ("fields", "error", "said"),
    [
        ({"kinds": "RGB-color domain domain", "sizes": "3 5 6"}, FieldError, "samples are RGB colours"),
        ({"kinds": "complex domain domain", "sizes": "2 5 6"}, FieldError, "samples are complex numbers"),
        ({"type": "block", "block size": "3"}, FieldError, "samples are blocks of bytes"),
        ({"kinds": "list domain domain"}, FieldError, "holds 5x6 samples"),
        ({"sizes": "4 0 6"}, FieldError, "holds 4x0x6 samples"),
        ({"dimension": "2", "sizes": "20 6"}, FieldError, "holds 20x6 samples"),
        ({"dimension": "4", "sizes": "4 5 6 0"}, FieldError, "holds 0 volumes"),
        ({"dimension": "5", "sizes": "2 2 2 3 5"}, FieldError, "axes beyond space"),
        ({"dimension": "", "sizes": "4 5 6"}, InputError, "lacks the field dimension"),
        ({"sizes": "4 5"}, InputError, "gives 3 axes the sizes 4 5"),
        ({"sizes": "4 -5 6"}, InputError, "gives 3 axes the sizes 4 -5 6"),
        ({"sizes": "4 five 6"}, InputError, "header line 'sizes: 4 five 6' cannot be read"),
        ({"sizes": "4.7 5 6"}, InputError, "'sizes: 4.7 5 6' cannot be read"),
        ({"sizes": "4 5 nan"}, InputError, "'sizes: 4 5 nan' cannot be read"),
        ({"sizes": "4 5 " + "9" * 400}, InputError, "cannot be read"),
        ({"dimension": "three"}, InputError, "'dimension: three' cannot be read"),
        ({"sizes": "10000 10000 10000"}, InputError, "ends early (240 of 2,000,000,000,000 bytes)"),
        (
            {"sizes": "10000 10000 10000", "encoding": "gzip"},
            InputError,
            "should hold 2,000,000,000,000 bytes",
        ),
        ({"type": "quark"}, InputError, "the sample type 'quark'"),
        ({"endian": ""}, InputError, "no byte order for its short samples"),
        ({"endian": "middle"}, InputError, "no byte order"),
        ({"spacings": "1 two 3"}, InputError, "header line 'spacings: 1 two 3' cannot be read"),
        ({"spacings": "1 0 3"}, FieldError, "singular"),
        ({"space": "LPS", "space directions": "(1,0,0) (0,1,0) (0,0,x)"}, InputError, "(0,0,x)' cannot be read"),
        ({"space": "LPS", "space directions": "(1,0,0) (0,1,0) (0,0,1"}, InputError, "(0,0,1' cannot be read"),
        ({"space": "LPS", "space directions": "(1,0,0) (0,1,0) (0,0)"}, InputError, "same number of elements"),
        ({"space": "LPS", "space directions": "(1,0) (0,1) (0,0)"}, InputError, "no three numbers"),
        ({"space": "LPS", "space origin": "(1,0,nan)"}, InputError, "no three numbers"),
        ({"space": "LPS", "space origin": "none"}, InputError, "'space origin: none' cannot be read"),
        (
            {"space": "LPS", "space directions": "(1,0,0) (0,1,0)"},
            InputError,
            "more or fewer than its 3 axes",
        ),
        ({"kinds": "space"}, InputError, "more or fewer than its 3 axes"),
        ({"units": '"mm" "mm" "mm'}, InputError, "cannot be read (No closing quotation)"),
        ({"byte skip": "-5"}, InputError, "skips 0 lines and -5 bytes"),
        ({"line skip": "-1"}, InputError, "skips -1 lines"),
        ({"line skip": "9"}, InputError, "skips 9 lines"),
        ({"byte skip": "10"}, InputError, "ends early (240 of 250 bytes)"),
    ],
)
def test_a_lying_header_is_found_out(
    tmp_path: Path, fields: dict[str, str], error: type[IsocoreError], said: str
) -> None:
    """Each lie in one line."""
    fields = {"kinds": "list space space space time", **fields} if fields.get("sizes") == "2 5 6 2 1" else fields
    path = written(tmp_path / "scan.nrrd", **fields)
    with pytest.raises(error) as caught:
        read(path)
    assert said in str(caught.value) and str(caught.value).startswith(f"{path}: ")


def test_key_value_pairs_are_no_fields(tmp_path: Path) -> None:
    """A program may remark on "byte skip:=" without setting it."""
    path = written(tmp_path / "scan.nrrd")
    path.write_bytes(path.read_bytes().replace(b"key:=value", b"byte skip:=7\nsizes:=9 9 9"))
    assert np.array_equal(volume_of(path).samples, ramp())


@pytest.mark.parametrize(
    "field",
    [
        "SpaceDirections: ( 0, 2 ,0) (-3,0.5, 0)\t(0,0,4)",
        "space directions: (9,0,0) (0,9,0) (0,0,9)\nspace directions: (0,2,0) (-3,0.5,0) (0,0,4)",
        "space directions: (0,2,0) (-3,0.5,0) (0,0,4)\nlabels: Bob's\nmeasurement frame: (1,0)\nowner: A:B",
    ],
)
def test_fields_are_read_in_any_spelling(tmp_path: Path, field: str) -> None:
    """The last of two counts, and what says nothing of samples or place may say what it likes."""
    path = written(tmp_path / "scan.nrrd", space="RAS")
    path.write_bytes(path.read_bytes().replace(b"key:=value", field.encode()))
    assert volume_of(path).affine[:3, :3].tolist() == [[0, -3, 0], [2, 0.5, 0], [0, 0, 4]]


@pytest.mark.parametrize(("byte_skip", "before", "behind"), [("5", 5, 0), ("-1", 9, 0), ("0", 0, 0), ("5", 5, 8)])
@pytest.mark.parametrize("encoding", ["raw", "gzip", "bzip2"])
def test_bytes_are_skipped_after_unpacking(
    tmp_path: Path, encoding: str, byte_skip: str, before: int, behind: int
) -> None:
    """-1 takes the last bytes; what is left over at the end is worth a warning."""
    pack = {"raw": bytes, "gzip": gzip.compress, "bzip2": bz2.compress}[encoding]
    content = pack(b"?" * before + ramp().tobytes(order="F") + b"!" * behind)
    volume = volume_of(written(tmp_path / "scan.nrrd", content, encoding=encoding, byte_skip=byte_skip))
    assert np.array_equal(volume.samples, ramp())
    assert list(volume.warnings) == ["has 8 bytes more than its header describes; check its byte skip"] * bool(behind)


def test_lines_are_skipped_before_unpacking(tmp_path: Path) -> None:
    """They stand in front of the packed bytes, in the data file too."""
    packed = b"one\ntwo\n" + gzip.compress(ramp().tobytes(order="F"))
    assert np.array_equal(
        volume_of(written(tmp_path / "a.nrrd", packed, encoding="gzip", line_skip="2")).samples, ramp()
    )
    (tmp_path / "b.gz").write_bytes(packed)
    detached = written(tmp_path / "b.nhdr", b"", encoding="gzip", line_skip="2", data_file="b.gz")
    assert np.array_equal(volume_of(detached).samples, ramp())


@pytest.mark.parametrize("named", ["slice%02d.raw 5 0 -1", "slice%02d.raw 0 5 1 2", "LIST\n{}", "LIST 2\n{}"])
@pytest.mark.parametrize("encoding", ["raw", "gzip", "ascii"])
def test_data_may_lie_in_several_files(tmp_path: Path, named: str, encoding: str) -> None:
    """One per slice, by a list or by a numbered name, forwards or backwards."""
    samples = ramp()
    order = range(6) if "-1" not in named else range(5, -1, -1)
    for place, number in enumerate(order):
        raw = samples[..., place].tobytes(order="F")
        content = gzip.compress(raw) if encoding == "gzip" else raw
        if encoding == "ascii":
            content = " ".join(map(str, samples[..., place].ravel(order="F"))).encode()
        (tmp_path / f"slice{number:02d}.raw").write_bytes(content)
    names = "\n".join(f"slice{number:02d}.raw" for number in order)
    path = tmp_path / "scan.nhdr"
    head = "".join(f"{name}: {value}\n" for name, value in {**HEAD, "encoding": encoding}.items())
    path.write_text(f"NRRD0004\n{head}data file: {named.format(names)}\n")
    assert np.array_equal(volume_of(path).samples, samples)


@pytest.mark.parametrize(
    ("named", "said"),
    [
        ("gone.raw", "no gone.raw beside it"),
        ("LIST", "no data file beside it"),
        ("LISTEN.raw", "no LISTEN.raw beside it"),
        ("slice%d.raw 0 5 1", "no slice0.raw beside it"),
        ("slice%d.raw 5 0 1", "numbers 0 data files"),
        ("slice%d.raw 0 9999999999 1", "numbers 10000000000 data files"),
        (f"slice%d.raw {'9' * 5000} 1 1", "File name too long"),
        (
            "LIST\nshort.raw\nshort.raw\nshort.raw\nshort.raw\nshort.raw\nshort.raw\nshort.raw",
            "unevenly over 7 files",
        ),
        ("short.raw", "short.raw ends early (3 of 240 bytes)"),
    ],
)
def test_missing_data_files_are_named(tmp_path: Path, named: str, said: str) -> None:
    """Behind the path of the header, which is what was asked for."""
    (tmp_path / "short.raw").write_bytes(b"abc")
    path = tmp_path / "scan.nhdr"
    path.write_text("NRRD0004\n" + "".join(f"{n}: {v}\n" for n, v in HEAD.items()) + f"data file: {named}\n")
    with pytest.raises(InputError) as caught:
        read(path)
    assert said in str(caught.value) and str(caught.value).startswith(f"{path}: ")


@pytest.mark.parametrize("content", ["1 2 3", "1 " * 119 + "many", "1 " * 119 + "40000"])
def test_text_that_is_no_samples_is_refused(tmp_path: Path, content: str) -> None:
    """Too few, no numbers, or numbers its type cannot hold."""
    with pytest.raises(InputError, match=r"ends early \(6 of 240 bytes\)|text is no list of int16 samples"):
        read(written(tmp_path / "scan.nrrd", content.encode(), encoding="ascii"))


def test_hex_of_half_a_byte_is_refused(tmp_path: Path) -> None:
    """And so is what is no hex at all."""
    for content in (b"abc", b"no hex"):
        with pytest.raises(InputError, match="text is no list of int16 samples"):
            read(written(tmp_path / "scan.nrrd", content, encoding="hex"))


def test_a_header_without_an_end_is_refused(tmp_path: Path) -> None:
    """Before all of a large file is taken for one."""
    path = written(tmp_path / "scan.nrrd")
    path.write_bytes(b"NRRD0004\n" + b"#" * (1 << 25))
    with pytest.raises(InputError, match="header does not end"):
        read(path)


def test_pynrrd_s_own_files_are_read_alike(tmp_path: Path) -> None:
    """Every type and encoding it writes."""
    for dtype in ("u1", "i1", "u2", "i2", "u4", "i4", "f4", "f8"):
        for encoding in ("raw", "gzip", "bzip2", "ascii"):
            path = tmp_path / f"{dtype}-{encoding}.nrrd"
            nrrd.write(str(path), ramp(dtype=dtype), {"encoding": encoding}, index_order="F")
            assert np.array_equal(volume_of(path).samples, nrrd.read(str(path), index_order="F")[0])


@pytest.mark.parametrize("encoding", ["raw", "gzip", "bzip2"])
def test_a_skip_to_the_last_samples_of_too_few_ends_early(tmp_path: Path, encoding: str) -> None:
    """There is nothing before them."""
    pack: Callable[[bytes], bytes] = {"raw": bytes, "gzip": gzip.compress, "bzip2": bz2.compress}[encoding]
    path = tmp_path / "scan.nrrd"
    head = f"NRRD0004\ntype: uchar\ndimension: 3\nsizes: 9 9 9\nencoding: {encoding}\nbyte skip: -1\n\n"
    path.write_bytes(head.encode() + pack(bytes(700)))
    with pytest.raises(InputError, match=r"ends early \(700 of 729 bytes\); copy it again"):
        read(path)
