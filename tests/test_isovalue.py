"""How an isovalue is chosen."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from isocore.choices import Auto, Number, Otsu, Percentile, parse_choice, parse_choices
from isocore.errors import FieldError, OptionError
from isocore.histogram import histogram
from isocore.isovalue import choose, is_two_valued, otsu, percentile
from isocore.volume import Volume

TYPES = ["uint8", "int8", "uint16", "int16", "uint32", "int32", "float32", "float64"]


def volume(samples: npt.ArrayLike, **scale: float) -> Volume:
    flat = np.array(samples)
    return Volume(np.resize(flat, (2, 2, -(-max(flat.size, 8) // 4))).copy(order="F"), **scale)


@given(st.sampled_from(TYPES).flatmap(lambda name: hnp.arrays(name, st.integers(8, 200).map(lambda n: n // 4 * 4))))
def test_range_and_counts_are_numpys(values: npt.NDArray[np.generic]) -> None:
    """Whatever the type, and with NaN and infinities among the samples."""
    source = volume(values)
    found = histogram(source, threads=2)
    finite = source.samples[np.isfinite(source.samples)]
    assert found.nonfinite == source.samples.size - finite.size
    assert int(found.counts.sum()) == finite.size
    if finite.size:
        assert found.range == (float(finite.min()), float(finite.max()))


@given(hnp.arrays("float32", 64, elements=st.floats(-100, 100, width=32)), st.integers(0, 100))
def test_a_percentile_has_its_share_below(values: npt.NDArray[np.float32], percent: int) -> None:
    """Within a bin of a bin of the exact one."""
    found = percentile(histogram(volume(values)), percent)
    ordered = np.sort(values)
    exact = ordered[min(int(percent / 100 * 64), 63)]
    assert abs(found - exact) <= (ordered[-1] - ordered[0]) / 4096**2 + 1e-5


def test_a_percentile_is_found_at_the_edge_of_a_bin() -> None:
    """Samples one rounding below the edge between two of the coarse bins, and exactly on it."""
    for middle in (-3.345521e-19, 0.0, 3.345521e-19):
        values = np.full(64, middle, np.float32)
        values[0], values[-1] = -99, 99
        for percent in (2, 50, 98):
            assert percentile(histogram(volume(values)), percent) == pytest.approx(0, abs=198 / 4096**2)


def test_otsu_separates_two_heaps() -> None:
    """Halfway between the nearest samples of both, whether bins are exact or not."""
    heaps = np.concatenate([np.full(90, 10), np.full(4, 12), np.full(30, 100), np.full(4, 90)])
    assert otsu(histogram(volume(heaps.astype(np.int16)))) == 51
    assert otsu(histogram(volume(heaps.astype(np.float32)))) == pytest.approx(51, abs=0.1)


def test_otsu_is_the_best_of_all_cuts() -> None:
    """Against the definition: the largest variance between classes."""
    values = np.random.default_rng(3).gamma(2, 20, 400).astype(np.uint8)
    cut = otsu(histogram(volume(values)))

    def between(at: float) -> float:
        low, high = values[values < at], values[values >= at]
        return len(low) * len(high) * (low.mean() - high.mean()) ** 2 if len(low) and len(high) else 0.0

    assert between(cut) == pytest.approx(max(between(at + 0.5) for at in range(255)))


def test_two_values_are_cut_in_the_middle() -> None:
    """Also scaled ones, and floats; three values are none of the kind."""
    for name in TYPES:
        spread = histogram(volume(np.array([3, 7] * 8, name), slope=-2.0, intercept=1.0))
        assert is_two_valued(spread) and choose(Auto(), spread).isovalue == -9.0
    assert not is_two_valued(histogram(volume(np.array([0.0, 1.0, 1e-9, 1.0] * 4))))


def test_a_constant_volume_offers_no_isovalue() -> None:
    """The message says what every sample is; a given number is taken all the same."""
    spread = histogram(volume(np.full(16, 5, np.uint8)))
    with pytest.raises(FieldError, match="every sample is 5"):
        choose(Auto(), spread)
    assert choose(Number(3.5, "3.5"), spread).isovalue == 3.5


def test_a_volume_without_a_finite_sample_says_so() -> None:
    """Rather than NaN."""
    with pytest.raises(FieldError, match="no finite sample"):
        choose(Otsu(), histogram(volume(np.full(16, np.nan))))


def test_ranges_are_spread_and_doubles_dropped() -> None:
    """A:B:N are N values, both ends included."""
    found = parse_choices(("0:1:5", "0.5", "OTSU", "p99.5"))
    assert [str(choice) for choice in found] == ["0", "0.25", "0.5", "0.75", "1", "otsu", "p99.5"]
    assert found[1:2] + found[-2:] == (Number(0.25, "0.25"), Otsu(), Percentile(99.5, "p99.5"))
    assert parse_choices(()) == (Auto(),)


@pytest.mark.parametrize("text", ["50", "50.0", "1e2", "otsu", "p090.5", "auto"])
def test_a_choice_prints_back_to_its_text(text: str) -> None:
    """Reports and names of outputs say what was asked for, in the words in which it was."""
    assert str(parse_choice(text)) == text


def test_a_range_is_no_single_choice() -> None:
    """Unless it holds one value."""
    assert parse_choice("1:2:1") == Number(1.0, "1")
    with pytest.raises(OptionError, match=r"isovalue 1:2:3: is 3 isovalues"):
        parse_choice("1:2:3")


@pytest.mark.parametrize("text", ["nan", "inf", "p-1", "p101", "1:2:0", "1:nan:3", "", "three", "1:2:999999"])
def test_nonsense_is_refused_by_name(text: str) -> None:
    """The message names the option's value."""
    with pytest.raises(OptionError, match="isovalue"):
        parse_choices((text,))
