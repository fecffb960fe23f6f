"""Numbers are read as Fortran and Windows print them, or the word and its place are quoted."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from vtu_files import Mesh, write

from isocore.errors import InputError
from isocore.readers import read
from isocore.readers.vtu_words import floats, integers

TET = Mesh([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], [(10, [0, 1, 2, 3])], {"u": np.arange(4.0)})
CASES = Path(__file__).parents[3] / "shared" / "data" / "cases" / "08-vtu-fortran-numbers"


@pytest.mark.parametrize(
    "word, value",
    [
        ("1.0D+00", 1),
        ("0.1732D+01", 1.732),
        ("-1d-3", -1e-3),
        (".5Q2", 50),
        ("0.1234-101", 0.1234e-101),
        ("1.2+101", 1.2e101),
        ("-7.-300", -7e-300),
        ("+4.5E+100", 4.5e100),
        ("Infinity", math.inf),
        ("-1.#INF", -math.inf),
        ("1.#INF00e+000", math.inf),
    ],
)
def test_a_number_is_read_as_fortran_and_windows_print_it(word, value):
    """Exponents by D or Q or without a letter; infinity by its names."""
    assert floats(b" 1 " + word.encode() + b" 2\n", 0, 99).tolist() == [1, value, 2]


@pytest.mark.parametrize(
    "word", ["-1.#IND", "1.#QNAN", "1.#SNAN0", "-nan(ind)", "nan(snan)", "NaNQ", "NAN", "1.#QNANe+000", "-1.#IND00"]
)
def test_what_is_no_number_is_nan_under_all_its_names(word):
    """Such a value counts as outside, as everywhere."""
    assert np.isnan(floats(word.encode(), 0, len(word))).tolist() == [True]


@pytest.mark.parametrize("word", ["oops", "1,5", "1_000", "****", "1.0DD2", "--1", "1.2-", "0x10", "#"])
def test_any_other_word_is_quoted_with_its_place(word, tmp_path):
    """The line of the file, and which number of its array it would have been."""
    path = write(tmp_path / "a.vtu", TET)
    path.write_text(path.read_text().replace("0.0 1.0 2.0 3.0", f"0.0 1.0\n {word} 3.0"))
    line = next(n for n, text in enumerate(path.read_text().splitlines(), 1) if f" {word} " in text)
    with pytest.raises(InputError) as caught:
        read(path)
    assert str(caught.value) == (
        f"{path}: array 'u' holds {word!r} in line {line} as number 3, which is no number; correct it"
    )


def test_a_bad_word_far_into_a_long_array_has_its_own_number():
    """Also behind the chunks that were read quickly."""
    text = b"1.5 " * 200_000 + b"bad 2"
    with pytest.raises(Exception, match="holds 'bad' in line 1 as number 200,001, which is no number"):
        floats(text, 0, len(text))


def test_a_bad_word_among_integers_is_quoted():
    """A number with a point is no integer."""
    with pytest.raises(Exception, match=r"holds '2\.5' in line 2 as number 3, which is no integer"):
        integers(b"+1 -7\n2.5", 0, 9)


@pytest.mark.parametrize("count", ["+4", " 4 ", " +4", "+ 4", "4 "])
def test_counts_may_have_a_plus_sign_or_blanks(count, tmp_path):
    """As Fortran prints them."""
    path = write(tmp_path / "a.vtu", TET)
    path.write_text(path.read_text().replace('NumberOfPoints="4"', f'NumberOfPoints="{count}"'))
    assert len(read(path).points) == 4


@pytest.mark.parametrize(
    "name, first", [("underflow", 0.1234e-101), ("double", 1.732), ("msvc_old", math.nan), ("msvc_new", math.nan)]
)
@pytest.mark.skipif(not CASES.is_dir(), reason="the cases lie beside the repository, not in it")
def test_the_files_users_met_are_read(name, first):
    """One word each that only its program prints."""
    mesh = read(CASES / f"{name}.vtu")
    np.testing.assert_equal(mesh.values[0], first)
    assert np.isfinite(mesh.values[1:]).all()
