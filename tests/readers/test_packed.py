"""The bytes of packed files: members, checksums, missing bytes, promises nobody can keep."""

from __future__ import annotations

import bz2
import gzip
import sys
from contextlib import nullcontext
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from scans import patched, ramp, save

from isocore.errors import InputError, reading
from isocore.readers import packed, read
from isocore.readers.joined import Decoded, Joined
from isocore.readers.members import Packing
from isocore.readers.packed import Packed, packing_of, unpacked_bytes
from isocore.volume import Volume

CONTENT = bytes(range(256)) * 5000
PACKERS = {"none": bytes, "gzip": gzip.compress, "bzip2": bz2.compress}


def _filled(path: Path, packing: Packing, size: int = len(CONTENT)) -> bytes:
    target = bytearray(size)
    with Packed(path, packing=packing) as source:
        source.promise(size, kept_bytes=size)
        source.fill(memoryview(target))
        source.finish()
    return bytes(target)


@pytest.mark.parametrize("packing", PACKERS)
def test_content_is_read_skipped_and_counted_alike(tmp_path: Path, packing: Packing) -> None:
    """Plain and packed files are one kind of source."""
    path = tmp_path / "content"
    path.write_bytes(b"head" + PACKERS[packing](CONTENT))
    target = bytearray(300_000)
    with Packed(path, packing=packing, start=4) as source:
        assert source.read(3) == CONTENT[:3]
        source.skip(700_000)
        source.fill(memoryview(target))
        assert target == CONTENT[700_003:1_000_003]
        assert source.rest() == len(CONTENT) - 1_000_003
        assert source.content_bytes() == len(CONTENT)


@pytest.mark.parametrize("packing", ["gzip", "bzip2"])
def test_several_members_are_one_content(tmp_path: Path, packing: Packing) -> None:
    """As written by parallel packers, and by `cat a.gz b.gz`."""
    path = tmp_path / "content"
    path.write_bytes(b"".join(PACKERS[packing](CONTENT[at : at + 100_000]) for at in range(0, len(CONTENT), 100_000)))
    assert _filled(path, packing) == CONTENT


@pytest.mark.parametrize("packing", PACKERS)
def test_missing_bytes_are_counted(tmp_path: Path, packing: Packing) -> None:
    """Those that are there and those that should be, also where the file ends amid a packed block."""
    path = tmp_path / "content"
    noise = np.random.default_rng(1).bytes(400_000)
    path.write_bytes(PACKERS[packing](noise)[:300_000])
    with pytest.raises(InputError, match=r"^ends early \([\d,]+ of 400,000 bytes\); copy it again$") as caught:
        _filled(path, packing, len(noise))
    held = int(str(caught.value).split("(")[1].split(" ")[0].replace(",", ""))
    if packing == "bzip2":
        assert held == 0, "a block is unpacked whole or not at all"
    else:
        assert 299_000 < held <= 300_000


def test_a_complete_but_short_content_is_counted_too(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The stream ends well, only too soon; what was read until then need not be unpacked again."""
    monkeypatch.delattr(Packed, "content_bytes")
    path = tmp_path / "content"
    path.write_bytes(gzip.compress(CONTENT))
    with pytest.raises(InputError, match=r"ends early \(1,280,000 of 1,280,001 bytes\)"):
        _filled(path, "gzip", len(CONTENT) + 1)


@pytest.mark.parametrize("inflater", ["isal", "zlib"])
@pytest.mark.parametrize("size", [1000, 1 << 18, 1 << 20])
def test_a_wrong_checksum_is_damage(tmp_path: Path, size: int, inflater: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """It stands behind the last byte that is needed, and is looked at all the same."""
    if inflater == "zlib":
        monkeypatch.setitem(sys.modules, "isal", None)
    path = tmp_path / "content"
    content = bytearray(gzip.compress(CONTENT[:size]))
    content[-6] ^= 1
    path.write_bytes(bytes(content))
    with pytest.raises(InputError, match="compressed data is damaged"), reading(path):
        _filled(path, "gzip", size)


@pytest.mark.parametrize("inflater", ["isal", "zlib"])
def test_a_damaged_stream_is_called_so(tmp_path: Path, inflater: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """isal and zlib raise errors of different families."""
    if inflater == "zlib":
        monkeypatch.setitem(sys.modules, "isal", None)
    path = save(tmp_path / "scan.nii.gz", ramp((20, 20, 20)))
    whole = path.read_bytes()
    for at in range(30, 60):
        path.write_bytes(whole[:at] + bytes(8) + whole[at + 8 :])
        with pytest.raises(InputError, match=f"^{path}: (compressed data is damaged|ends early|header|is no NIfTI)"):
            read(path)


def test_a_stream_without_its_checksum_ends_early(tmp_path: Path) -> None:
    """All samples are there, but who knows whether they are right."""
    path = save(tmp_path / "scan.nii.gz", ramp())
    path.write_bytes(path.read_bytes()[:-3])
    with pytest.raises(InputError, match="ends early amid packed data; copy it again"):
        read(path)


def test_zeros_after_the_last_member_are_padding(tmp_path: Path) -> None:
    """Tapes and some archives fill up their blocks."""
    path = save(tmp_path / "scan.nii.gz", ramp())
    path.write_bytes(path.read_bytes() + bytes(512))
    assert isinstance(read(path), Volume)


def test_gzip_is_inflated_without_isal_too(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """zlib is slower and reads the same."""
    path = tmp_path / "content"
    path.write_bytes(gzip.compress(CONTENT[:500_000]) + gzip.compress(CONTENT[500_000:]))
    monkeypatch.setitem(sys.modules, "isal", None)
    assert _filled(path, "gzip") == CONTENT
    path.write_bytes(path.read_bytes()[:-300])
    with pytest.raises(InputError, match="ends early"):
        _filled(path, "gzip")


def test_the_size_of_the_content_is_guessed_without_unpacking(tmp_path: Path) -> None:
    """By the end of a gzip file; where it cannot be true, by what scans usually are, and never beyond what gzip can."""
    path = tmp_path / "content.gz"
    path.write_bytes(gzip.compress(CONTENT))
    assert unpacked_bytes(path) == len(CONTENT)
    packed_bytes = path.stat().st_size
    for stated, guessed in ((0, 4 * packed_bytes), (2**32 - 1, 1032 * packed_bytes)):
        patched(path, packed_bytes - 4, stated.to_bytes(4, "little"))
        assert unpacked_bytes(path) == guessed
    path.write_bytes(bytes(17))
    assert unpacked_bytes(path) == 17 and unpacked_bytes(tmp_path / "gone.gz") == 0
    (tmp_path / "content").write_bytes(gzip.compress(CONTENT))
    assert unpacked_bytes(tmp_path / "content") == packed_bytes


def test_gzip_cannot_hold_what_it_cannot_hold(tmp_path: Path) -> None:
    """Refused by the size of the file alone, before anything is inflated."""
    path = tmp_path / "content"
    path.write_bytes(gzip.compress(bytes(1000)))
    with pytest.raises(InputError, match=r"should hold 2,000,000,000,000 bytes; \d+ of gzip hold at most"):
        _filled_promise(path, 2 * 10**12)


def test_zeros_packed_as_densely_as_can_be_are_no_lie(tmp_path: Path) -> None:
    """The bound on gzip is above what gzip reaches."""
    path = tmp_path / "content"
    path.write_bytes(gzip.compress(bytes(20_000_000), 9))
    assert 20_000_000 / path.stat().st_size > 1000
    _filled_promise(path, 20_000_000)


def test_more_than_the_machine_has_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """bzip2 may inflate a million times, so that memory is the bound."""
    monkeypatch.setattr(packed, "_memory_bytes", lambda: 10**9)
    path = tmp_path / "content"
    path.write_bytes(bz2.compress(CONTENT))
    with (
        pytest.raises(InputError, match="needs 1,500,000,000 bytes of memory of 1,000,000,000; crop the data"),
        Packed(path, packing="bzip2") as source,
    ):
        source.promise(15 * 10**8, kept_bytes=15 * 10**8)


def _filled_promise(path: Path, content_bytes: int) -> None:
    with Packed(path, packing="gzip") as source:
        source.promise(content_bytes, kept_bytes=1)


def test_packing_is_told_by_the_first_bytes(tmp_path: Path) -> None:
    """A NIfTI file may be packed without saying so in its name."""
    path = save(tmp_path / "scan.nii", ramp())
    for packing, pack in PACKERS.items():
        (tmp_path / f"{packing}.nii").write_bytes(pack(path.read_bytes()))
        assert packing_of(tmp_path / f"{packing}.nii") == packing
        field = read(tmp_path / f"{packing}.nii")
        assert isinstance(field, Volume) and np.array_equal(field.samples, ramp())


def test_an_image_that_begins_like_gzip_is_none(tmp_path: Path) -> None:
    """Bare samples may have any value."""
    path = save(tmp_path / "scan.hdr", ramp())
    patched(tmp_path / "scan.img", 0, b"\x1f\x8b")
    field = read(path)
    assert isinstance(field, Volume) and field.samples[0, 0, 0] == 0x8B1F - 0x10000


def test_joined_parts_read_as_one() -> None:
    """Over every seam, filling and skipping."""
    parts = [partial(nullcontext, Decoded(CONTENT[at : at + 11], 10)) for at in range(0, 50, 10)]
    target = bytearray(23)
    with Joined(parts, 10) as source:
        source.skip(13)
        source.fill(memoryview(target))
        assert bytes(target) == CONTENT[13:36]
        source.fill(memoryview(bytearray(14)))
        assert source.rest() == 5, "one byte too much in each"


@pytest.mark.parametrize("inflater", ["isal", "zlib"])
@pytest.mark.parametrize("members", [1, 3])
@pytest.mark.parametrize(
    ("tail", "said"),
    [
        (bytes(1), "is padded with zeros"),
        (bytes(700), "is padded with zeros"),
        (b"garbage", "has 7 bytes behind its gzip data that are none"),
        (b"\r\n", "has 2 bytes behind"),
        (b"\x1f", "has 1 bytes behind"),
        (bytes(40) + b"garbage", "has 47 bytes behind"),
        (b"x" * 1_000_000, "has 1,000,000 bytes behind"),
    ],
)
def test_bytes_behind_the_last_member_are_left_out(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, inflater: str, members: int, tail: bytes, said: str
) -> None:
    """The volume is whole, and a warning says what else is there; one zero behind several members looks like none."""
    if inflater == "zlib":
        monkeypatch.setitem(sys.modules, "isal", None)
    samples = np.random.default_rng(3).integers(0, 99, (80, 80, 60)).astype(np.int16)
    path = save(tmp_path / "scan.nii", samples)
    content = path.read_bytes()
    step = -(-len(content) // members)
    packed_ = b"".join(gzip.compress(content[at : at + step]) for at in range(0, len(content), step))
    for suffix in (".nii.gz", ".nii"):
        path = tmp_path / f"behind{suffix}"
        path.write_bytes(packed_ + tail)
        field = read(path)
        assert isinstance(field, Volume) and np.array_equal(field.samples, samples)
        if not (members > 1 and tail == bytes(1)):
            (warning,) = field.warnings
            assert warning.startswith(said) and "left out" in warning


@pytest.mark.parametrize("inflater", ["isal", "zlib"])
def test_a_cut_member_is_an_error_wherever_it_stands(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, inflater: str
) -> None:
    """What follows the last whole member is one too, by its first two bytes."""
    if inflater == "zlib":
        monkeypatch.setitem(sys.modules, "isal", None)
    path = save(tmp_path / "scan.nii.gz", ramp((30, 30, 30)))
    whole = path.read_bytes()
    for tail in (gzip.compress(b"")[:-1], gzip.compress(b"more")[:5], b"\x1f\x8b", bytes(9) + b"\x1f\x8b\x08"):
        path.write_bytes(whole + tail)
        with pytest.raises(InputError, match="ends early amid packed data; copy it again"):
            read(path)


def test_an_empty_block_at_the_end_is_no_padding(tmp_path: Path) -> None:
    """BGZF ends with one, whose last bytes are zeros; and so does what packs nothing at the end."""
    path = save(tmp_path / "scan.nii.gz", ramp())
    whole = path.read_bytes()
    for last in (bytes.fromhex("1f8b08040000000000ff0600424302001b0003000000000000000000"), gzip.compress(b"")):
        path.write_bytes(whole + last)
        field = read(path)
        assert isinstance(field, Volume) and not field.warnings


def test_surplus_without_end_is_not_counted_to_its_end(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Enough to tell that there is too much."""
    monkeypatch.setattr(packed, "_MOST_SURPLUS", 1 << 20)
    path = tmp_path / "content"
    path.write_bytes(gzip.compress(bytes(50_000_000)))
    with Packed(path, packing="gzip") as source:
        source.skip(100)
        assert 1 << 20 <= source.rest() < 2 << 20
