"""Which samples are set aside before an isovalue is chosen, and which are not."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

from isocore.choices import Auto, Otsu, Percentile
from isocore.histogram import Histogram, histogram
from isocore.isovalue import choose, is_two_valued
from isocore.volume import Volume

LOWEST = float(np.finfo(np.float32).min)


def spread_of(samples: npt.NDArray[Any], **scale: float) -> Histogram:
    flat = np.resize(samples.ravel(), (2, 2, -(-samples.size // 4)))
    return histogram(Volume(flat.copy(order="F"), **scale), threads=2)


def scan(dtype: str, size: int = 8000) -> npt.NDArray[Any]:
    """Two heaps of values around 40 and 160, as a scan has them."""
    rng = np.random.default_rng(1)
    return np.concatenate([rng.normal(40, 5, size // 2), rng.normal(160, 9, size // 2)]).astype(dtype)


def filled(dtype: str, share: float, *values: float) -> npt.NDArray[Any]:
    """The scan with a share of its samples, spread evenly, replaced by these values by turns."""
    samples = scan(dtype)
    places = np.linspace(0, len(samples) - 1, max(1, int(share * len(samples)))).astype(int)
    for turn, value in enumerate(values):
        samples[places[turn :: len(values)]] = value
    return samples


@pytest.mark.parametrize("share", [1e-4, 0.03, 0.7])
@pytest.mark.parametrize(
    ("dtype", "values"),
    [
        ("float32", [LOWEST]),
        ("float32", [-LOWEST]),
        ("float32", [1e20]),
        ("float32", [-1e30]),
        ("float32", [9.96921e36]),
        ("float32", [-9999.0]),
        ("float32", [-500_000.0]),
        ("float64", [-1.7976931348623157e308]),
        ("float64", [1e10]),
        ("float64", [1e20, -1e30]),
        ("float64", [1e7, 1e15, 1e30]),
        ("int16", [-32768]),
        ("int16", [-9999]),
        ("int32", [-2147483648]),
        ("int32", [2147483647]),
        ("uint32", [4294967295]),
    ],
)
def test_fill_values_decide_no_isovalue(dtype: str, values: list[float], share: float) -> None:
    """Otsu's threshold lies between the heaps of the data, and one warning for each value says how many there are."""
    samples = filled(dtype, share, *values)
    for choice in (Auto(), Otsu()):
        chosen = choose(choice, spread_of(samples))
        assert 60 < chosen.isovalue < 130
        found = [value for value in values if (samples == np.dtype(dtype).type(value)).any()]
        assert len(chosen.warnings) == len(found)
        for value in found:
            count = int(np.count_nonzero(samples == np.dtype(dtype).type(value)))
            assert any(f"{count:,} sample" in line and "set aside" in line for line in chosen.warnings)


def test_the_data_beside_a_fill_value_have_the_same_threshold() -> None:
    """As the same samples without it, to a bin."""
    data = scan("float32")
    mixed = np.concatenate([data, np.full(12_000, LOWEST, np.float32)])
    bin_width = float(np.ptp(data)) / 4096
    assert choose(Otsu(), spread_of(mixed)).isovalue == pytest.approx(
        choose(Otsu(), spread_of(data)).isovalue, abs=bin_width
    )


def test_a_fill_value_counts_as_stored_or_as_scaled() -> None:
    """-32768 with a slope, and a scaled -9999; with a negative slope the lowest stored is the highest value."""
    stored = filled("int16", 0.3, -32768)
    for slope in (0.5, -0.5):
        chosen = choose(Otsu(), spread_of(stored, slope=slope, intercept=7.0))
        assert 60 < (chosen.isovalue - 7) / slope < 130 and len(chosen.warnings) == 1
        side = "outside" if slope > 0 else "inside"
        assert f"as {side}" in chosen.warnings[0]
    scaled = filled("int16", 0.3, -5000)
    chosen = choose(Otsu(), spread_of(scaled, slope=2.0, intercept=1.0))
    assert 120 < chosen.isovalue < 260 and "-9999" in chosen.warnings[0]


@pytest.mark.parametrize("outlier", [1e6, 1e10, 1e30])
def test_a_hot_voxel_decides_no_isovalue(outlier: float) -> None:
    """One sample in 4,096, far from a single heap around zero."""
    samples = np.random.default_rng(0).normal(size=4096).astype(np.float32)
    samples[0] = outlier
    chosen = choose(Auto(), spread_of(samples))
    assert abs(chosen.isovalue) < 0.5
    assert chosen.warnings[0].startswith(f"1 sample is {outlier:g} (0.024 % of all)")


@pytest.mark.parametrize(
    ("middle", "width", "outlier"), [(300.0, 0.01, 5000.0), (0.0, 1e-9, 1.0), (-101_325.0, 0.5, 0.0)]
)
def test_a_handful_is_far_out_by_the_width_of_the_others(middle: float, width: float, outlier: float) -> None:
    """Whatever the size of the numbers: a thousand times as far as all others are spread."""
    samples = np.random.default_rng(0).uniform(middle - width, middle + width, 4096)
    samples[[7, 700]] = outlier
    chosen = choose(Otsu(), spread_of(samples))
    assert abs(chosen.isovalue - middle) < width and "2 samples are" in chosen.warnings[0]


def test_hot_voxels_of_many_values_are_set_aside_together() -> None:
    """Half a per cent of them, each with a value of its own."""
    samples = scan("float32")
    samples[::200] = np.geomspace(1e7, 1e12, len(samples[::200]))
    chosen = choose(Otsu(), spread_of(samples))
    assert 60 < chosen.isovalue < 130 and "from 1e+07 to 1e+12" in chosen.warnings[0]


def test_a_mask_with_a_fill_value_is_a_mask() -> None:
    """The middle of the two values that are left."""
    mask = np.resize(np.array([0, 1, 1, 0, -9999], np.float32), 400)
    spread = spread_of(mask)
    assert is_two_valued(spread) and choose(Auto(), spread).isovalue == 0.5


@pytest.mark.parametrize(
    "samples",
    [
        np.concatenate([np.full(4000, -1024), np.linspace(-1000, 3000, 4000)]).astype(np.int16),
        np.concatenate([np.full(4000, -1024), np.linspace(-1000, 3000, 4000)]).astype(np.float32),
        np.concatenate([np.full(6000, -2000), np.linspace(-1000, 3000, 2000)]).astype(np.int16),
        np.concatenate([np.zeros(4000), np.linspace(200, 255, 4000)]).astype(np.uint8),
        np.concatenate([np.linspace(0, 50, 4000), np.full(4000, 255)]).astype(np.uint8),
        np.concatenate([np.linspace(0, 1000, 7990), np.full(10, 65535)]).astype(np.uint16),
        np.concatenate([np.full(4000, -128), np.linspace(0, 50, 4000)]).astype(np.int8),
        np.resize(np.array([0, 255], np.uint8), 8000),
        np.resize(np.array([-32768, 32767], np.int16), 8000),
        np.resize(np.array([0.0, 1e20]), 8000),
        np.random.default_rng(2).lognormal(0, 3, 8000),
        np.random.default_rng(2).lognormal(0, 3, 8000).astype(np.float32) * 1e6,
        np.concatenate([np.zeros(7990), np.linspace(1, 2, 10)]),
        np.concatenate([np.random.default_rng(3).normal(0, 1e-12, 6000), np.linspace(1, 2, 2000)]),
        np.concatenate([np.random.default_rng(3).normal(0, 1e-12, 6000), np.ones(2000)]),
        np.random.default_rng(4).normal(101_325, 50, 8000),
        np.linspace(-32768, 32767, 8000).astype(np.int16),
        np.linspace(-1, 1, 8000) * 1e308,
    ],
    ids=lambda samples: f"{samples.dtype}-{samples.min():g}-{samples.max():g}",
)
def test_what_may_well_be_data_is_never_set_aside(samples: npt.NDArray[Any]) -> None:
    """Padding beside air, background of a mask, saturation, heavy tails, small objects, noise around nothing."""
    assert spread_of(samples).apart == ()


def test_a_percentile_counts_what_lies_apart_and_says_so() -> None:
    """Where it is more than one sample in a thousand."""
    samples = filled("float32", 0.3, 1e20)
    chosen = choose(Percentile(50, "p50"), spread_of(samples))
    assert chosen.isovalue == np.percentile(samples.astype(np.float64), 50)
    assert "percentiles count them; --ignore 1e+20" in chosen.warnings[0]
    assert not choose(Percentile(50, "p50"), spread_of(filled("float32", 1e-4, 1e20))).warnings


@pytest.mark.parametrize("scale", [1e160, 1e306, 5e307])
def test_values_near_the_largest_double_have_a_threshold(scale: float) -> None:
    """Between two heaps at -3 and 3, of samples whose squares, or even differences, no double holds."""
    rng = np.random.default_rng(0)
    heaps = np.concatenate([rng.normal(-3, 0.1, 4000), rng.normal(3, 0.1, 4000)])
    spread = spread_of(heaps * scale)
    for choice in (Auto(), Otsu(), Percentile(50, "p50")):
        assert abs(choose(choice, spread).isovalue) < 2.9 * scale
    bars = spread.coarse()
    assert sum(bars.counts) == 8000 and bars.low == heaps.min() * scale and bars.high == heaps.max() * scale


def test_the_smallest_doubles_are_told_apart() -> None:
    """0 and the smallest one above it: inside is from the isovalue on, which must be above 0."""
    spread = spread_of(np.resize(np.array([0.0, 5e-324]), 80))
    assert choose(Auto(), spread).isovalue == choose(Otsu(), spread).isovalue == 5e-324


def test_the_drawn_histogram_leaves_out_what_lies_apart() -> None:
    """Its bars are those of the data, not one bar at either end."""
    bars = spread_of(filled("float32", 0.5, LOWEST)).coarse()
    assert bars.low is not None and bars.low > 0 and sum(count > 0 for count in bars.counts) > 20
