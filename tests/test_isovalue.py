"""How an isovalue is chosen."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest
from click.testing import CliRunner
from hypothesis import assume, given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from isocore.cli.convert import convert
from small_files import ball, write_nifti

from isocore.choices import Auto, Number, Otsu, Percentile, parse_choice, parse_choices
from isocore.digits import counted, exact, legible
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
    assert int(found.counts.sum()) + sum(group.count for group in found.apart) == finite.size
    if finite.size:
        assert found.range == (float(finite.min()), float(finite.max()))


def spread_samples(name: str) -> st.SearchStrategy[npt.NDArray[np.generic]]:
    """Samples of a type over all its magnitudes: its own extremes, tiny ones, heaps of equal ones."""
    if name.startswith("float"):
        width = 32 if name == "float32" else 64
        elements: st.SearchStrategy[float] = st.floats(width=width, allow_nan=False, allow_infinity=False)
        elements |= st.tuples(st.floats(-9, 9, width=32), st.integers(-30, 30)).map(
            lambda pair: float(np.dtype(name).type(pair[0] * 10.0 ** pair[1]))
        )
        elements |= st.sampled_from([0.0, -0.0, 1.0, 1e10, -1e20])
    else:
        ends = np.iinfo(name)
        elements = st.integers(int(ends.min), int(ends.max)) | st.integers(0, 5)
    return hnp.arrays(name, st.integers(2, 60).map(lambda n: 4 * n), elements=elements)


@given(
    st.sampled_from(TYPES).flatmap(spread_samples),
    st.floats(0, 100) | st.integers(0, 100).map(float),
    st.sampled_from([(1.0, 0.0), (2.008, -7.5), (-0.25, 3.0)]),
)
def test_a_percentile_is_numpys(values: npt.NDArray[np.generic], percent: float, scale: tuple[float, float]) -> None:
    """To the last bit, whatever the type, the range, and the sign of the slope."""
    source = volume(values, slope=scale[0], intercept=scale[1])
    with np.errstate(over="ignore", invalid="ignore"):
        scaled = scale[0] * source.samples.astype(np.float64).ravel() + scale[1]
        assume(np.isfinite(scaled).all())
        wanted = float(np.percentile(scaled, percent))
    found = percentile(histogram(source, threads=2), percent)
    if np.isfinite(wanted):
        assert found == wanted
    else:  # numpy's difference of two samples is too large
        assert scaled.min() <= found <= scaled.max()


def test_a_percentile_is_rounded_as_numpys() -> None:
    """Interpolated from the nearer of two samples."""
    values = np.random.default_rng(5).normal(size=1000)
    spread = histogram(volume(values))
    for percent in np.random.default_rng(6).uniform(0, 100, 300).tolist():
        assert percentile(spread, percent) == np.percentile(values, percent)


@given(
    st.sampled_from(TYPES).flatmap(spread_samples),
    st.sampled_from([(1.0, 0.0), (2.008, -7.5), (-0.25, 3.0), (1e-3, 0.0), (-1e6, 1e9)]),
)
def test_a_chosen_isovalue_divides_the_samples(values: npt.NDArray[np.generic], scale: tuple[float, float]) -> None:
    """Whatever they are, some of those that were not set aside lie below it and some do not."""
    source = volume(values, slope=scale[0], intercept=scale[1])
    spread = histogram(source, threads=2)
    assume(spread.low < spread.high)
    with np.errstate(over="ignore", invalid="ignore"):
        scaled = scale[0] * source.samples.astype(np.float64) + scale[1]
    assume(np.isfinite(scaled).all() and len(np.unique(scaled)) == len(np.unique(source.samples)))
    low, high = spread.kept_range or (0.0, 0.0)
    assert low < choose(Auto(), spread).isovalue <= high and low < choose(Otsu(), spread).isovalue <= high
    assert int(spread.counts.sum()) + sum(group.count for group in spread.apart) == spread.finite


@pytest.mark.parametrize("outlier", [1e6, 1e10, -1e20, 1e30, float(np.finfo(np.float32).max)])
def test_one_outlier_moves_no_percentile(outlier: float) -> None:
    """One wild voxel in 4,096: the 90th percentile is what numpy says of all samples."""
    values = np.random.default_rng(0).normal(size=4096).astype(np.float32)
    values[0] = outlier
    assert percentile(histogram(volume(values)), 90) == np.percentile(values.astype(np.float64), 90)


def test_a_percentile_leaves_samples_out_that_are_not_finite() -> None:
    """NaN of either sign and both infinities."""
    values = np.array([3, 1, np.nan, 2, -np.nan, np.inf, 4, -np.inf], np.float32)
    spread = histogram(volume(values))
    assert [percentile(spread, percent) for percent in (0, 50, 100)] == [1.0, 2.5, 4.0]


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


@pytest.mark.parametrize(("value", "isovalue"), [(0, 0.5), (5, 2.5), (-4, -2)])
@pytest.mark.parametrize("choice", [Auto(), Otsu()])
def test_a_constant_volume_is_taken_for_a_mask(value: int, isovalue: float, choice: Auto | Otsu) -> None:
    """An empty mask has its isovalue where any mask has it; a given number is taken all the same."""
    spread = histogram(volume(np.full(16, value, np.int8)))
    chosen = choose(choice, spread)
    assert (chosen.isovalue, chosen.why) == (isovalue, f"every sample is {value}, so none divides them")
    assert choose(Number(3.5, "3.5"), spread).isovalue == 3.5


def test_a_volume_without_a_finite_sample_says_so() -> None:
    """Rather than NaN."""
    assert choose(Otsu(), histogram(volume(np.full(16, np.nan)))).why.startswith("no sample is finite")


def test_an_isovalue_is_a_finite_number() -> None:
    """Where the slope takes the samples beyond all doubles, the choice is refused."""
    with pytest.raises(FieldError, match="p50 is no finite number"):
        choose(Percentile(50, "p50"), histogram(volume(np.linspace(1e307, 1e308, 16), slope=1e10)))


def test_ranges_are_spread_and_doubles_dropped() -> None:
    """A:B:N are N values, both ends included."""
    found = parse_choices(("0:1:5", "0.5", "OTSU", "p99.5"))
    assert [str(choice) for choice in found] == ["0", "0.25", "0.5", "0.75", "1", "otsu", "p99.5"]
    assert found[1:2] + found[-2:] == (Number(0.25, "0.25"), Otsu(), Percentile(99.5, "p99.5"))
    assert parse_choices(()) == (Auto(),)


@pytest.mark.parametrize(
    ("text", "names"),
    [
        ("101325:101325.0001:3", ["101325", "101325.00005", "101325.0001"]),
        ("614454275.5:614454276.5:2", ["614454275.5", "614454276.5"]),
        ("0.1:0.3:3", ["0.1", "0.2", "0.3"]),
        ("3:-3:4", ["3", "1", "-1", "-3"]),
        ("0:1:4", ["0", "0.3333333333333333", "0.6666666666666666", "1"]),
        ("1e300:1.5e300:2", ["1e+300", "1.5e+300"]),
        ("-1.7e308:1.7e308:3", ["-1.7e+308", "0", "1.7e+308"]),
        ("100:400:+100", ["100", "200", "300", "400"]),
        ("100:399.9:+100", ["100", "200", "300"]),
        ("0.1:0.5:+0.1", ["0.1", "0.2", "0.3", "0.4", "0.5"]),
        ("-1:-3:+1", ["-1", "-2", "-3"]),
        ("7:7:+5", ["7"]),
        ("0:10:+2.5e0", ["0", "2.5", "5", "7.5", "10"]),
    ],
)
def test_a_range_keeps_all_digits(text: str, names: list[str]) -> None:
    """Each number is the one that is meant, and its name reads back as the number."""
    choices = parse_choices((text,))
    assert [str(choice) for choice in choices] == names
    assert [parse_choice(name) for name in names] == list(choices)


@pytest.mark.parametrize("text", ["1:1:3", "1:1.0000000000000002:3"])
def test_a_range_of_equal_numbers_is_refused(text: str) -> None:
    """None is dropped without a word."""
    with pytest.raises(OptionError, match="not all different"):
        parse_choices((text,))


@pytest.mark.parametrize(
    ("text", "advice"),
    [
        ("50%", "p50 is the value below which 50 percent"),
        ("p50%", "p50 is the value"),
        ("100,200", "each of several isovalues by itself"),
        ("0,5", "decimals with a point"),
        ("1:2", "A:B:N for N values"),
        ("1:2:2.5", "A:B:+S for steps"),
        ("1:2:+0", "the step must lie above 0"),
        ("1:2:+-1", "the step must lie above 0"),
        ("0:1:+1e-9", "ask for 1 to 10000"),
        ("loud", "is not a number, otsu, pNN, A:B:N or A:B:+S"),
    ],
)
def test_what_is_no_isovalue_is_answered_with_what_to_write(text: str, advice: str) -> None:
    """In one line that begins with the text."""
    with pytest.raises(OptionError) as caught:
        parse_choice(text)
    assert str(caught.value).startswith(f"isovalue {text}: ") and advice in str(caught.value)


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


@pytest.mark.parametrize(
    ("values", "texts"),
    [
        ((101325.0, 101325.00005, 101325.0001), ("101325", "101325.00005", "101325.0001")),
        ((0.0, 1.0, 0.5), ("0", "1", "0.5")),
        ((152.054443359375, 130.0, 200.0), ("152.054", "130", "200")),
        ((0.1, 0.1, 0.30000000000000004), ("0.1", "0.1", "0.3")),
        ((0.3, 0.30000000000000004), ("0.3", "0.30000000000000004")),
        ((-0.0, 1e300), ("0", "1e+300")),
    ],
)
def test_different_numbers_look_different(values: tuple[float, ...], texts: tuple[str, ...]) -> None:
    """With six digits, or as many more as they need."""
    assert legible(*values) == texts


def test_counts_are_shown_in_full() -> None:
    """A gate says 1,234,567, not 1.23457e+06."""
    assert counted(1_234_567.0, 1_234_568.0) == ("1,234,567", "1,234,568")
    assert counted(0.25, 2.0) == ("0.25", "2")


@given(st.floats(allow_nan=False, allow_infinity=False))
def test_an_exact_text_reads_back(value: float) -> None:
    """Whatever the number, and without a needless .0."""
    assert float(exact(value)) == value and not exact(value).endswith(".0")


def test_an_isovalue_asked_for_twice_is_drawn_once_and_told(tmp_path: Path) -> None:
    """Not dropped without a word; ranges that meet count, too."""
    path = write_nifti(tmp_path / "ball.nii", ball())
    arguments = [str(path), "-i", "40", "-i", "40:60:3", "-i", "60", "-d", str(tmp_path / "out")]
    result = CliRunner().invoke(convert, arguments)
    assert result.exit_code == 0 and "-i 40, 60: asked for more than once, drawn once" in result.stderr
    made = sorted(path.name for path in (tmp_path / "out").glob("*.ply"))
    assert made == ["ball_40.ply", "ball_50.ply", "ball_60.ply"]
