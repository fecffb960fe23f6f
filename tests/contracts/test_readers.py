"""What every reader promises, over the table of readers."""

from __future__ import annotations

import shutil
import tracemalloc
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scans import ramp, save

from isocore.errors import FieldError, InputError, IsocoreError, OptionError
from isocore.readers import SEARCHED, ReadOptions, count_volumes, read, suffix_of
from isocore.readers.formats import BY_SUFFIX
from isocore.volume import Volume

#: Meshes, and files of one volume only, which have tests of their own.
OF_VTK = {suffix for suffix in BY_SUFFIX if suffix.startswith((".vt", ".pv"))}
VOLUMES = [suffix for suffix in BY_SUFFIX if suffix not in OF_VTK]
#: FreeSurfer's files hold four types, big-endian.
OF_ANY_TYPE = [suffix for suffix in VOLUMES if suffix not in (".mgz", ".mgh")]
WITH_HEADER = [suffix for suffix in VOLUMES if ".raw" not in suffix]


def refusal(path: Path, options: ReadOptions | None = None) -> IsocoreError:
    """The error of reading `path`, one line that starts with the path."""
    with pytest.raises(IsocoreError) as caught:
        read(path, options)
    message = str(caught.value)
    assert message.startswith(f"{path}: ") and "\n" not in message
    assert message.count(str(path)) == 1
    return caught.value


@pytest.mark.parametrize("suffix", VOLUMES)
def test_a_volume_comes_back_as_it_was_written(tmp_path: Path, suffix: str) -> None:
    """Values, type and order are the stored ones."""
    volume = read(save(tmp_path / f"scan{suffix}", ramp()))
    assert isinstance(volume, Volume)
    assert np.array_equal(volume.samples, ramp()) and volume.samples.dtype == np.int16
    assert volume.samples.flags.f_contiguous and not volume.samples.flags.writeable


@pytest.mark.parametrize("suffix", OF_ANY_TYPE)
@pytest.mark.parametrize(
    "dtype", ["u1", "i1", "<u2", ">u2", "<i2", ">i2", "<u4", ">u4", "<i4", ">i4", "<f4", ">f4", "<f8", ">f8"]
)
def test_every_type_is_read_in_both_byte_orders(tmp_path: Path, suffix: str, dtype: str) -> None:
    """A stored type is kept; only its byte order becomes the machine's."""
    volume = read(save(tmp_path / f"scan{suffix}", ramp(dtype=dtype)))
    assert isinstance(volume, Volume)
    assert np.array_equal(volume.samples, ramp()) and volume.samples.dtype == np.dtype(dtype).newbyteorder("=")


@pytest.mark.parametrize("suffix", OF_ANY_TYPE)
@pytest.mark.parametrize("dtype", ["<i8", ">u8"])
def test_eight_byte_integers_are_narrowed(tmp_path: Path, suffix: str, dtype: str) -> None:
    """No kernel reads them, and values of four bytes lose nothing."""
    volume = read(save(tmp_path / f"scan{suffix}", ramp(dtype=dtype)))
    assert isinstance(volume, Volume)
    assert np.array_equal(volume.samples, ramp()) and volume.samples.dtype == np.int32
    assert not volume.warnings


@pytest.mark.parametrize("suffix", VOLUMES)
def test_one_volume_of_several_is_read(tmp_path: Path, suffix: str) -> None:
    """Each of them, and only when it is named."""
    samples = ramp((4, 5, 6, 3))
    path = save(tmp_path / f"scan{suffix}", samples)
    assert count_volumes(path) == 3
    for volume in range(3):
        field = read(path, ReadOptions(volume=volume))
        assert isinstance(field, Volume) and np.array_equal(field.samples, samples[..., volume])
    for volume, said in ((None, "holds 3 volumes"), (3, "no volume 3"), (-1, "no volume -1")):
        error = refusal(path, ReadOptions(volume=volume))
        assert isinstance(error, OptionError) and said in str(error)


@pytest.mark.parametrize("suffix", VOLUMES)
def test_a_last_axis_of_one_is_no_axis(tmp_path: Path, suffix: str) -> None:
    """Such a file holds one volume, which needs no choice."""
    path = save(tmp_path / f"scan{suffix}", ramp((4, 5, 6, 1)))
    field = read(path)
    assert isinstance(field, Volume) and field.shape == (4, 5, 6) and count_volumes(path) == 1


@pytest.mark.parametrize("suffix", BY_SUFFIX)
def test_a_missing_file_is_named(tmp_path: Path, suffix: str) -> None:
    """Before any format is asked."""
    assert "no such file" in str(refusal(tmp_path / f"scan{suffix}"))


@pytest.mark.parametrize("suffix", BY_SUFFIX)
def test_an_empty_file_is_refused(tmp_path: Path, suffix: str) -> None:
    """As empty, not as damaged."""
    path = tmp_path / f"scan{suffix}"
    path.touch()
    assert "is empty" in str(refusal(path))


@pytest.mark.parametrize("suffix", ["", *BY_SUFFIX])
def test_a_folder_is_refused(tmp_path: Path, suffix: str) -> None:
    """Whatever its name says."""
    path = tmp_path / f"scan{suffix}"
    path.mkdir()
    error = refusal(path)
    assert isinstance(error, InputError) and "is a folder" in str(error)


@pytest.mark.parametrize("name", ["scan", "scan.gz", "scan.xyz", "nii"])
def test_an_unknown_suffix_is_refused_with_the_known_ones(
    tmp_path: Path, name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The message is the list to choose from."""
    monkeypatch.chdir(tmp_path)  # a message has 300 characters, and a long path takes them from the list
    Path("here").mkdir()
    path = Path("here", name)
    path.write_bytes(b"x")
    message = str(refusal(path))
    assert all(suffix in message for suffix in SEARCHED)


@pytest.mark.parametrize("suffix", WITH_HEADER)
@pytest.mark.parametrize(
    "content",
    [b"x", bytes(range(256)) * 8, b"\x00" * 4096, b"\x1f\x8b" * 600, b"NRRD0009\n\n", b"\xff" * 700],
)
def test_another_file_under_a_known_name_is_refused(tmp_path: Path, suffix: str, content: bytes) -> None:
    """Each as an InputError."""
    path = save(tmp_path / f"scan{suffix}", ramp())
    for file in tmp_path.iterdir():
        if ".img" not in file.name and ".raw" not in file.name:
            file.write_bytes(content)
    assert isinstance(refusal(path), InputError)


@pytest.mark.parametrize("suffix", VOLUMES)
def test_no_beginning_of_a_file_passes_for_the_file(tmp_path: Path, suffix: str) -> None:
    """Cut anywhere, it is refused, or nothing that counts was cut off."""
    path = save(tmp_path / f"scan{suffix}", ramp())
    intact = read(path)
    assert isinstance(intact, Volume)
    for file in sorted(tmp_path.iterdir()):
        whole = file.read_bytes()
        for length in {*range(0, len(whole), 7), *range(len(whole) - 20, len(whole))}:
            file.write_bytes(whole[:length])
            try:
                field = read(path)
                assert isinstance(field, Volume) and np.array_equal(field.samples, ramp())
                assert np.array_equal(field.affine, intact.affine)
                kept = 348 if ".hdr" in file.name else 284 + ramp().nbytes if file.suffix == ".mgh" else len(whole)
                assert length >= kept or whole[length:].isspace()
            except IsocoreError as error:
                assert str(error).startswith(f"{path}: ") and str(error).count(str(path)) == 1
        file.write_bytes(whole)


@pytest.mark.parametrize("suffix", VOLUMES)
@settings(max_examples=60, deadline=None)
@given(data=st.data())
def test_damage_ends_in_a_volume_or_in_one_line(
    tmp_path_factory: pytest.TempPathFactory, suffix: str, data: st.DataObject
) -> None:
    """Whatever bytes change, nothing else than an IsocoreError comes out."""
    folder = tmp_path_factory.mktemp("damaged")
    path = save(folder / f"scan{suffix}", ramp())
    for file in folder.iterdir():
        content = bytearray(file.read_bytes())
        for at in data.draw(st.lists(st.integers(0, len(content) - 1), max_size=4)):
            content[at] = data.draw(st.integers(0, 255))
        file.write_bytes(bytes(content))
    try:
        read(path)
    except IsocoreError as error:
        assert str(error).startswith(f"{path}: ") and "\n" not in str(error)
    finally:
        shutil.rmtree(folder)


@pytest.mark.parametrize("suffix", VOLUMES)
def test_a_flat_volume_is_refused(tmp_path: Path, suffix: str) -> None:
    """One sample along an axis bounds no cell."""
    error = refusal(save(tmp_path / f"scan{suffix}", ramp((4, 1, 6))))
    assert isinstance(error, FieldError) and "holds 4x1x6 samples" in str(error)


@pytest.mark.parametrize("suffix", VOLUMES)
def test_reading_costs_the_samples_and_little_more(tmp_path: Path, suffix: str) -> None:
    """Memory at its highest: the volume and one megabyte, also where bytes are swapped."""
    samples = np.zeros((160, 120, 100), dtype=">f4", order="F")
    path = save(tmp_path / f"scan{suffix}", samples)
    read(path)
    tracemalloc.start()
    read(path)
    peak_bytes = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak_bytes < samples.nbytes + (1 << 20)


@pytest.mark.parametrize("suffix", VOLUMES)
def test_a_suffix_is_known_in_either_case(suffix: str) -> None:
    """Scanners from another age shout."""
    assert suffix_of(f"SCAN{suffix.upper()}") == suffix


def test_the_longest_suffix_wins() -> None:
    """What is packed is known by what it is and by how."""
    assert [suffix_of(name) for name in ("a.nii.gz", "a.raw.gz", "a.b.nii", "a.hdr.gz")] == [
        ".nii.gz",
        ".raw.gz",
        ".nii",
        ".hdr.gz",
    ]


def test_a_folder_search_meets_each_scan_once() -> None:
    """An image is found by its header alone."""
    assert ".hdr" in SEARCHED and not any("img" in suffix for suffix in SEARCHED)
