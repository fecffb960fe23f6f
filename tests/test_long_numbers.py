"""Python refuses to make an integer of more than 4,300 digits: text of any length is looked at before it is one."""

from __future__ import annotations

from pathlib import Path

import pytest
from click.testing import CliRunner
from isocore.cli.main import isocore as program

from isocore.errors import InputError, IsocoreError
from isocore.readers import read
from isocore.readers.label_tables import read_label_table

NINES = "9" * 5000


@pytest.mark.parametrize(
    "options",
    [
        ("--labels", NINES),
        ("--labels", f"1-{NINES}"),
        ("--isovalue", f"1:2:{NINES}"),
        ("--volume", NINES),
        ("--jobs", NINES),
        ("--memory-limit", NINES),
        ("--page-size", f"{NINES}M"),
        ("--steps", f"1:{NINES}"),
        ("--component", NINES),
        ("--triangles", NINES),
    ],
    ids=lambda options: options[0],
)
def test_an_option_of_thousands_of_digits_is_refused_in_words(options: tuple[str, str], tmp_path: Path) -> None:
    """As any other nonsense is; not as an internal error."""
    (tmp_path / "a.nrrd").write_bytes(b"")
    outcome = CliRunner().invoke(program, ["convert", str(tmp_path / "a.nrrd"), *options])
    assert isinstance(outcome.exception, SystemExit | IsocoreError)


def test_a_metaimage_numbers_no_files_by_thousands_of_digits(tmp_path: Path) -> None:
    """The pattern is then taken for a name, and that file is missing."""
    path = tmp_path / "a.mhd"
    path.write_text(
        "ObjectType = Image\nNDims = 3\nDimSize = 2 2 2\nElementType = MET_UCHAR\n"
        f"ElementDataFile = s%d.raw 1 {NINES} 1\n"
    )
    with pytest.raises(InputError, match=r"a\.mhd: (?!.*integer string conversion)"):
        read(path)


def test_a_table_of_names_leaves_out_numbers_that_no_label_has(tmp_path: Path) -> None:
    """The other rows are read."""
    path = tmp_path / "names.txt"
    path.write_text(f"{NINES} nothing 1 2 3 0\n7 liver 1 2 3 0\n")
    assert set(read_label_table(path)) == {7}
