"""The error bound of climbing: kept, measured truly, and said in the units that were asked for."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt
import pytest
from shapes import Shape, padded_shapes

from isocore import _kernels
from isocore.backends import Options, prepare
from isocore.choices import parse_max_error
from isocore.errors import OptionError
from isocore.methods.bounds import bound_for
from isocore.methods.climbing import check_block_size
from isocore.volume import Volume

Points = npt.NDArray[np.float64]


def distances(points: Points, triangles: Points) -> Points:
    """From each of (n, 3) points to the nearest of (t, 3, 3) triangles, by the formulas of the seven regions."""
    a, b, c = triangles[:, 0], triangles[:, 1], triangles[:, 2]
    best = np.full(len(points), np.inf)
    for p, q in ((a, b), (b, c), (c, a)):
        along, off = q - p, points[:, None] - p
        t = np.clip((off * along).sum(-1) / (along * along).sum(-1), 0, 1)
        best = np.minimum(best, np.linalg.norm(off - t[..., None] * along, axis=-1).min(axis=1))
    normal = np.cross(b - a, c - a)
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    above = np.ones((len(points), len(triangles)), bool)
    for p, q in ((a, b), (b, c), (c, a)):
        above &= (np.cross(normal, q - p) * (points[:, None] - p)).sum(-1) >= 0
    height = np.abs(((points[:, None] - a) * normal).sum(-1))
    return np.minimum(best, np.where(above, height, np.inf).min(axis=1))


def wavy(shape: tuple[int, int, int] = (20, 18, 22)) -> npt.NDArray[np.float32]:
    x, y, z = np.indices(shape)
    values = np.sin(0.35 * x) + np.cos(0.3 * y) + np.sin(0.25 * z + 0.1 * x)
    return np.asfortranarray(values.astype(np.float32))


@pytest.mark.parametrize("max_error", [0.05, 0.2, 0.5, math.inf])
@pytest.mark.parametrize("spacing", [(1.0, 1.0, 1.0), (0.5, 1.0, 2.5)])
def test_the_measured_error_is_true(max_error: float, spacing: tuple[float, float, float]) -> None:
    """Recomputed against all triangles, no vertex of marching cubes is further away than the kernel says."""
    samples = wavy()
    stretch = np.array(spacing)
    reference = _kernels.marching_cubes(samples, 0.3)[0]
    vertices, triangles, facts = _kernels.climb(samples, 0.3, False, False, 1, 16, max_error, True, spacing)
    for name, scale in (("error_voxels", np.ones(3)), ("error_world", stretch)):
        found = distances(reference * scale, (vertices * scale)[triangles].astype(np.float64))
        largest, mean, rms = getattr(facts, name)
        assert found.max() <= largest + 1e-6
        assert found.mean() <= mean + 1e-6
        assert np.sqrt((found**2).mean()) <= rms + 1e-6
        assert mean <= 1.2 * found.mean() + 1e-6
    assert facts.error_world.max <= max_error


@pytest.mark.parametrize("max_error", [0.1, 0.5])
def test_no_point_of_our_surface_is_far_from_marching_cubes(max_error: float) -> None:
    """Points sampled on our triangles lie near theirs: the bound is on theirs, ours may add what a chord cuts off."""
    samples = wavy()
    reference_vertices, reference_triangles = _kernels.marching_cubes(samples, 0.3)[:2]
    vertices, triangles, _ = _kernels.climb(samples, 0.3, max_error=max_error)
    weights = np.random.default_rng(0).dirichlet((1, 1, 1), 3)
    points = np.einsum("wc,tcd->twd", weights, vertices[triangles].astype(np.float64)).reshape(-1, 3)
    assert distances(points, reference_vertices[reference_triangles].astype(np.float64)).max() <= 2 * max_error


@pytest.mark.parametrize("shape", padded_shapes(), ids=lambda shape: shape.name)
@pytest.mark.parametrize("bound", ["0.05", "0.5"])
def test_a_backend_keeps_its_bound_and_reports_it(shape: Shape, bound: str) -> None:
    """Through the table of backends, by the report's keys."""
    facts = prepare(shape.volume, "asc", Options(max_error=bound))(shape.isovalue).facts
    assert facts["error"]["max"] <= float(bound)
    assert 0 <= facts["error"]["mean"] <= facts["error"]["rms"] <= facts["error"]["max"]
    assert facts["error"]["bound"] == bound
    assert facts["climbing"]["blocks_visited"] + facts["climbing"]["blocks_skipped"] == facts["climbing"]["blocks"]


def test_a_bound_of_nothing_is_marching_cubes_where_the_surface_bends() -> None:
    """With no error allowed only flat parts are joined."""
    samples = wavy()
    assert _kernels.climb(samples, 0.3, max_error=0.0).facts.error_voxels.max == 0


def test_a_flat_surface_costs_next_to_nothing() -> None:
    """A plane through 32^3 samples: two triangles a block face, whatever the bound."""
    x = np.indices((33, 33, 33))[2].astype(np.float32)
    _, triangles, facts = _kernels.climb(np.asfortranarray(x), 10.25, max_error=0.001)
    assert len(triangles) == 8
    assert facts.error_voxels.max < 1e-5  # floats tell it to some 1e-7 of the box's 32 voxels


def test_a_smaller_bound_never_takes_fewer_triangles() -> None:
    """From none to a twentieth of a voxel."""
    counts = [len(_kernels.climb(wavy(), 0.3, max_error=e)[1]) for e in (0.5, 0.2, 0.1, 0.05)]
    assert counts == sorted(counts)


def volume(spacing: tuple[float, float, float] = (1, 1, 1), unit: str = "mm") -> Volume:
    return Volume(wavy(), affine=np.diag([*spacing, 1.0]), unit=unit)


def test_millimetres_are_measured_in_the_world() -> None:
    """Anisotropic voxels: the bound in millimetres holds for world distances, the bound in voxels for index ones."""
    coarse = volume((0.5, 1.0, 2.5))
    in_world = prepare(coarse, "asc", Options(max_error="0.4mm"))(0.3).facts["error"]
    assert in_world["max_world"] <= 0.4 < in_world["max_world"] + 0.2
    in_voxels = prepare(coarse, "asc", Options(max_error="0.4"))(0.3).facts["error"]
    assert in_voxels["max"] <= 0.4
    assert bound_for(coarse, parse_max_error("400um")).distance == pytest.approx(0.4)


def test_sheared_axes_shrink_the_bound() -> None:
    """World distances are at most sqrt(1 + cos) times those along stretched axes, and the bound allows for it."""
    affine = np.eye(4)
    affine[0, 1] = 0.5
    sheared = Volume(wavy(), affine=affine, unit="mm")
    assert bound_for(sheared, parse_max_error("0.4mm")).distance < 0.4 * 0.9
    assert bound_for(volume(), parse_max_error("0.4mm")).distance == pytest.approx(0.4, rel=1e-9)


@pytest.mark.parametrize("text", ["-1", "nan", "inf", "mm", "0.5 parsec", "", "a"])
def test_a_bound_that_makes_no_sense_is_refused(text: str) -> None:
    """One line, with the option first and what to write instead."""
    with pytest.raises(OptionError, match=r"^--max-error .*") as caught:
        parse_max_error(text)
    assert "\n" not in str(caught.value)


def test_millimetres_need_a_unit() -> None:
    """A volume that does not say its unit cannot be measured in millimetres."""
    with pytest.raises(OptionError, match="does not say its unit"):
        prepare(volume(unit=""), "asc", Options(max_error="0.3mm"))


@pytest.mark.parametrize("size", [0, 3, 64, -2])
def test_a_block_size_that_is_no_power_of_two_is_refused(size: int) -> None:
    """The message lists those there are."""
    with pytest.raises(OptionError, match=r"--block-size .* 1, 2, 4, 8, 16, 32"):
        check_block_size(size)
