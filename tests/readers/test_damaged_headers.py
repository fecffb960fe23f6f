"""Every field of every header, set to what no program would write: a volume or one line, and not a word beside."""

from __future__ import annotations

import itertools
import logging
import tracemalloc
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import nibabel as nib
import numpy as np
import pytest
from scans import ramp

from isocore.errors import IsocoreError
from isocore.readers import ReadOptions, read
from isocore.volume import Volume

#: Zeros and ones, NaN, infinity and the largest number of four and of eight bytes, a NaN that signals.
BITS = ["00", "ff", "7f", "01", "0000c07f", "0000807f", "ffff7f7f", "ffffa07f", "000000000000f87f", "ffffffffffffef7f"]

WORDS = [
    "", "-1", "0", "nan", "inf nan 1e999", "9" * 30, "1e30 1 1", "(nan,nan,nan)", "(1,0,0) none (1e308,1e308,1e308)",
    "()", "((", '"', "'", "\\", "LIST", "%d 0 9 1", "µ", "none none none", "1 2 3 4 5 6 7 8", ":", "=", "\0", "\x85",
]  # fmt: skip
FIELDS = [
    "type", "dimension", "sizes", "encoding", "endian", "line skip", "byte skip", "data file", "kinds", "centerings",
    "spacings", "axis mins", "axis maxs", "units", "space", "space units", "space origin", "space directions", "labels",
]  # fmt: skip
GOOD = {"type": "short", "dimension": "3", "sizes": "4 5 6", "encoding": "raw", "endian": "little"}


@contextmanager
def silence(caplog: pytest.LogCaptureFixture) -> Iterator[None]:
    """No warning and no log record comes out, and no memory goes in that is not the volume's."""
    tracemalloc.start()
    with warnings.catch_warnings(record=True) as warned, caplog.at_level(logging.DEBUG):
        warnings.simplefilter("always")
        yield
    peak_bytes = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert not [str(one.message) for one in warned] and not caplog.records and peak_bytes < 1 << 23


def check(path: Path) -> None:
    """The volume in `path` is whole, or its refusal is a line in our words."""
    try:
        volume = read(path, ReadOptions(volume=0))
    except IsocoreError as error:
        message = str(error)
        assert message.startswith(f"{path}: ") and message.isprintable() and len(message) < len(str(path)) + 250
        assert not message.endswith("check that it is what its suffix says"), message
    else:
        assert isinstance(volume, Volume) and np.isfinite(volume.affine).all()


@pytest.mark.parametrize(
    ("kind", "endian"),
    [
        (nib.Nifti1Header, "<"),
        (nib.nifti1.Nifti1PairHeader, ">"),
        (nib.Nifti2Header, ">"),
        (nib.Spm2AnalyzeHeader, "<"),
    ],
)
def test_no_bits_of_a_binary_header_get_past_us(
    tmp_path: Path, caplog: pytest.LogCaptureFixture, kind: Any, endian: str
) -> None:
    """One field at a time, whole or its first number only, beside a qform that is in use."""
    header = kind(endianness=endian)
    header.set_data_shape((4, 5, 6))
    header.set_data_dtype(np.int16)
    alone = getattr(header, "is_single", False)
    if "qform_code" in header:
        header["qform_code"] = 1
    path = tmp_path / ("scan.nii" if alone else "scan.hdr")
    start = header.single_vox_offset if alone else 0
    (path if alone else tmp_path / "scan.img").write_bytes(bytes(start) + ramp().tobytes(order="F"))
    samples = path.read_bytes()[header.sizeof_hdr :] if alone else b""
    path.write_bytes(header.binaryblock + samples)
    assert isinstance(read(path), Volume)
    with silence(caplog):
        for (field, at), bits in itertools.product(header.template_dtype.fields.values(), map(bytes.fromhex, BITS)):
            for size in {field.itemsize, field.base.itemsize}:
                damaged = bytearray(header.binaryblock)
                pattern = (bits if endian == "<" else bits[::-1]) * size
                damaged[at : at + size] = pattern[:size]
                path.write_bytes(damaged + samples)
                check(path)


@pytest.mark.parametrize("field", FIELDS)
def test_no_words_of_a_text_header_get_past_us(tmp_path: Path, caplog: pytest.LogCaptureFixture, field: str) -> None:
    """One field at a time, in a header that is good without it."""
    path = tmp_path / "scan.nrrd"
    with silence(caplog):
        for words in WORDS:
            head = "".join(f"{name}: {value}\n" for name, value in {**GOOD, field: words}.items())
            path.write_bytes(f"NRRD0005\n{head}\n".encode() + ramp().tobytes(order="F"))
            check(path)
