"""Raw files: what options and sidecars say, and what the file says against it."""

from __future__ import annotations

import gzip
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scans import ramp

from isocore.errors import FieldError, InputError, IsocoreError, OptionError
from isocore.readers import ReadOptions, count_volumes, read
from isocore.volume import Volume

SHAPE = (4, 5, 6)


def volume_of(path: Path, **options: Any) -> Volume:
    """The volume in `path`, read with these options."""
    field = read(path, ReadOptions(**options))
    assert isinstance(field, Volume)
    return field


@pytest.fixture
def bare(tmp_path: Path) -> Path:
    """Samples and nothing else."""
    path = tmp_path / "skull.raw"
    path.write_bytes(ramp().tobytes(order="F"))
    return path


def test_options_describe_a_raw_file(bare: Path) -> None:
    """World is index times spacing plus origin, in a space and unit nobody stated."""
    volume = volume_of(bare, shape=SHAPE, dtype="int16", spacing=(1, 2, 3), origin=(7, 8, 9))
    assert np.array_equal(volume.samples, ramp())
    assert volume.affine.tolist() == [[1, 0, 0, 7], [0, 2, 0, 8], [0, 0, 3, 9], [0, 0, 0, 1]]
    assert (volume.space, volume.unit, volume.warnings) == ("native", "", ())


@pytest.mark.parametrize(
    ("options", "missing"),
    [({}, "--shape and --dtype"), ({"shape": SHAPE}, "--dtype"), ({"dtype": "u1"}, "--shape")],
)
def test_what_is_missing_is_asked_for(bare: Path, options: dict[str, Any], missing: str) -> None:
    """In the words of the command line."""
    with pytest.raises(OptionError) as caught:
        volume_of(bare, **options)
    assert str(caught.value) == f"{bare}: needs {missing}; a raw file cannot tell its own"


def test_a_sidecar_describes_it_and_options_go_first(bare: Path) -> None:
    """Key by key."""
    sidecar = {
        "shape": [4, 5, 6],
        "dtype": "int16",
        "spacing": [1, 1, 2.5],
        "origin": [0, 0, 1],
        "byte-order": "little",
    }
    bare.with_name("skull.raw.json").write_text(json.dumps(sidecar))
    volume = volume_of(bare)
    assert np.array_equal(volume.samples, ramp()) and volume.spacing == (1, 1, 2.5)
    volume = volume_of(bare, spacing=(3, 3, 3), byte_order="big")
    assert volume.spacing == (3, 3, 3) and volume.affine[2, 3] == 1
    assert np.array_equal(volume.samples, ramp().byteswap())


def test_a_packed_file_has_the_sidecar_of_the_plain_one(tmp_path: Path) -> None:
    """Packing does not rename what describes it."""
    (tmp_path / "skull.raw.gz").write_bytes(gzip.compress(ramp().tobytes(order="F")))
    (tmp_path / "skull.raw.json").write_text('{"shape": [4, 5, 6], "dtype": "<i2"}')
    assert np.array_equal(volume_of(tmp_path / "skull.raw.gz").samples, ramp())


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("{", "is not JSON"),
        ("[1]", "is no JSON object"),
        ('{"shape": "4,5,6"}', 'gives shape as "4,5,6"'),
        ('{"shape": [4, 5, 6.5]}', "gives shape as"),
        ('{"dtype": 16}', "gives dtype as 16"),
        ('{"offset": true}', "gives offset as true"),
        ('{"spaceing": [1, 1, 1]}', "has the key spaceing; it takes shape, dtype"),
        ("\udcff", "is not JSON"),
    ],
)
def test_a_sidecar_that_makes_no_sense_is_refused(bare: Path, text: str, said: str) -> None:
    """By its name, behind the path of the raw file."""
    bare.with_name("skull.raw.json").write_bytes(text.encode("utf-8", "surrogateescape"))
    with pytest.raises(InputError) as caught:
        volume_of(bare)
    assert str(caught.value).startswith(f"{bare}: its sidecar skull.raw.json ") and said in str(caught.value)


@pytest.mark.parametrize("prefix", ["", "<", ">"])
@pytest.mark.parametrize(
    ("name", "code"),
    [
        ("int16", "i2"),
        ("uint16", "u2"),
        ("short", "i2"),
        ("ushort", "u2"),
        ("i2", "i2"),
        ("u2", "u2"),
        ("UINT16", "u2"),
    ],
)
def test_types_have_many_names(bare: Path, prefix: str, name: str, code: str) -> None:
    """numpy's, C's, and those of the command line; byte order by either way."""
    order = prefix or "<"
    expected = np.frombuffer(bare.read_bytes(), f"{order}{code}").reshape(SHAPE, order="F")
    if len(name) == 2:
        assert np.array_equal(volume_of(bare, shape=SHAPE, dtype=f"{prefix}{name}").samples, expected)
    byte_order = {"": None, "<": "little", ">": "big"}[prefix]
    volume = volume_of(bare, shape=SHAPE, dtype=name, byte_order=byte_order)
    assert np.array_equal(volume.samples, expected)


def test_half_precision_becomes_single(bare: Path) -> None:
    """No kernel reads it, and single holds it exactly."""
    samples = ramp(dtype="f2")
    bare.write_bytes(samples.tobytes(order="F"))
    volume = volume_of(bare, shape=SHAPE, dtype="float16")
    assert volume.samples.dtype == np.float32 and np.array_equal(volume.samples, samples)


@pytest.mark.parametrize(
    ("options", "error", "said"),
    [
        ({"dtype": "int"}, InputError, "ends early (240 of 480 bytes); check --shape, --dtype and --offset"),
        ({"dtype": "long"}, OptionError, "--dtype is long"),
        ({"dtype": "complex64"}, OptionError, "--dtype is complex64"),
        ({"dtype": "O"}, OptionError, "--dtype is O"),
        ({"dtype": "<u2", "byte_order": "big"}, OptionError, "contradict each other"),
        ({"byte_order": "middle"}, OptionError, "--byte-order is middle"),
        ({"shape": (4, 5)}, OptionError, "--shape is 4,5"),
        ({"shape": (4, 5, -6)}, OptionError, "--shape is 4,5,-6"),
        ({"shape": (4, 0, 6)}, FieldError, "holds 4x0x6 samples"),
        ({"shape": (4, 5, 6, 0)}, OptionError, "--shape is 4,5,6,0"),
        ({"shape": (10**4, 10**4, 10**4)}, InputError, "ends early (240 of 2,000,000,000,000 bytes)"),
        ({"spacing": (1, 1)}, OptionError, "--spacing is 1,1"),
        ({"spacing": (1, 1, 0)}, OptionError, "--spacing is 1,1,0"),
        ({"spacing": (1, 1, float("nan"))}, OptionError, "--spacing is 1,1,nan"),
        ({"origin": (1, 1, float("inf"))}, OptionError, "--origin is 1,1,inf"),
        ({"offset": -1}, OptionError, "--offset is -1"),
        ({"offset": 10}, InputError, "ends early (240 of 250 bytes)"),
    ],
)
def test_a_description_that_cannot_be_is_refused(
    bare: Path, options: dict[str, Any], error: type[IsocoreError], said: str
) -> None:
    """In the words of the command line."""
    with pytest.raises(error) as caught:
        volume_of(bare, **{"shape": SHAPE, "dtype": "int16", **options})
    assert said in str(caught.value) and str(caught.value).startswith(f"{bare}: ")


@pytest.mark.parametrize("packed", [False, True])
def test_what_is_left_over_is_reported(tmp_path: Path, packed: bool) -> None:
    """It is most often a shape mistyped."""
    content = b"header" + ramp().tobytes(order="F") + b"tail"
    path = tmp_path / ("skull.raw.gz" if packed else "skull.raw")
    path.write_bytes(gzip.compress(content) if packed else content)
    volume = volume_of(path, shape=SHAPE, dtype="int16", offset=6)
    assert np.array_equal(volume.samples, ramp())
    assert volume.warnings == ("has 4 bytes more than it should; check --shape, --dtype and --offset",)


def test_a_fourth_size_counts_volumes(bare: Path) -> None:
    """One after the other, and none is left over."""
    options = ReadOptions(shape=(4, 5, 3, 2), dtype="int16", volume=0)
    assert count_volumes(bare, options) == 2
    field = read(bare, options)
    assert isinstance(field, Volume)
    assert np.array_equal(field.samples, ramp()[..., :3]) and not field.warnings


def test_a_plain_file_may_begin_like_gzip(bare: Path) -> None:
    """Its suffix says what it is."""
    bare.write_bytes(b"\x1f\x8b" + bare.read_bytes()[2:])
    assert volume_of(bare, shape=SHAPE, dtype="uint16").samples[0, 0, 0] == 0x8B1F
