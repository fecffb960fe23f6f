"""Ambiguous faces are listed where they are, with how close the decision was."""

from __future__ import annotations

from pathlib import Path

import meshio
import numpy as np
import pytest
from shapes import integer_noise, volume_of

from isocore import _kernels
from isocore.ambiguities import find_ambiguities
from isocore.volume import Volume
from isocore.writers.ply import write_ply_points


def test_one_face_has_its_saddle() -> None:
    """3 and 1 across from each other, 0 and -2: the saddle is 1 / 2 ... worked out by hand."""
    samples = np.full((2, 2, 2), -9, np.float32)
    samples[:, :, 0] = [[3, -2], [0, 1]]
    found = find_ambiguities(volume_of(samples), 0.5)
    f00, f01, f10, f11 = 2.5, -2.5, -0.5, 0.5
    bend = f00 + f11 - f01 - f10
    assert found.distances == pytest.approx([(f00 * f11 - f01 * f10) / bend])
    assert found.points == pytest.approx(np.array([[(f00 - f01) / bend, (f00 - f10) / bend, 0]]))


def test_faces_are_listed_once_and_counted_by_their_cells() -> None:
    """Marching cubes counts a face in each of its cells; faces in the border belong to one cell only."""
    volume = integer_noise(12, 4)
    counted = _kernels.marching_cubes(volume.samples, 2.0)[2]
    points = find_ambiguities(volume, 2.0).points
    axis_across = (points == np.floor(points)).argmax(axis=1)
    level = points[np.arange(len(points)), axis_across]
    at_border = (level == 0) | (level == 11)
    assert counted == 2 * (~at_border).sum() + at_border.sum()


def test_the_sign_says_how_it_was_decided_also_for_a_negative_slope() -> None:
    """The same values stored upside down give the same places and distances."""
    samples = np.random.default_rng(3).integers(-8, 8, (9, 8, 7)).astype(np.int16)
    plain = find_ambiguities(volume_of(samples), 0.5)
    turned = find_ambiguities(volume_of(-samples, slope=-1.0), 0.5)
    assert plain.points == pytest.approx(turned.points)
    assert plain.distances == pytest.approx(turned.distances)


def test_values_that_are_not_finite_are_left_out() -> None:
    """Nothing was interpolated there."""
    samples = np.array([[[1, 0], [0, np.nan]], [[0, 1], [np.inf, 0]]], np.float32)
    assert np.isfinite(find_ambiguities(volume_of(samples), 0.5).points).all()


@pytest.mark.parametrize("threads", [2, 4])
def test_threads_change_nothing(threads: int) -> None:
    """The same bytes from one thread and from several."""
    one, several = (find_ambiguities(integer_noise(20, 4), 2.0, threads=n) for n in (1, threads))
    assert one.points.tobytes() == several.points.tobytes()
    assert one.distances.tobytes() == several.distances.tobytes()


def test_the_file_is_a_ply_of_points_in_the_world(tmp_path: Path) -> None:
    """Read back with somebody else's reader."""
    affine = np.diag([2.0, 3.0, 4.0, 1.0])
    samples = np.asfortranarray(np.random.default_rng(0).integers(0, 3, (6, 7, 8)).astype(np.uint8))
    found = find_ambiguities(Volume(samples, affine=affine, unit="mm"), 1.0)
    assert len(found.points)
    with (tmp_path / "places.ply").open("wb") as stream:
        write_ply_points(stream, found.points, "saddle_distance", found.distances, space="ras", unit=found.unit)
    back = meshio.read(tmp_path / "places.ply")
    assert back.points == pytest.approx(found.points, rel=1e-6)
    assert back.point_data["saddle_distance"] == pytest.approx(found.distances, rel=1e-6)
    assert b"comment SPACE=RAS\ncomment units mm\n" in (tmp_path / "places.ply").read_bytes()
