"""GIFTI: surfaces that nibabel reads, in RAS."""

from __future__ import annotations

import json
from pathlib import Path

import nibabel as nib
import nrrd
import numpy as np
import pytest
import shapes_mesh
from click.testing import CliRunner, Result
from isocore.cli.convert import convert
from small_files import ball, write_nifti

from isocore.surface import Part, Surface
from isocore.volume import Space
from isocore.writers import write

#: Signs from each space to RAS.
SIGNS: dict[Space, tuple[int, int, int]] = {"ras": (1, 1, 1), "lps": (-1, -1, 1), "las": (-1, 1, 1)}


def run(*arguments: object) -> Result:
    return CliRunner().invoke(convert, [str(argument) for argument in arguments])


def enclosed(vertices: np.ndarray, triangles: np.ndarray) -> float:
    a, b, c = (vertices[triangles[:, corner]].astype(np.float64) for corner in range(3))
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6)


@pytest.mark.parametrize("space", [*SIGNS, "native"])
def test_vertices_are_in_ras_and_triangles_turn_outward(tmp_path: Path, space: Space) -> None:
    """Whatever space the surface is in; of one in no known space nothing is claimed."""
    torus = shapes_mesh.torus()
    normals = torus.vertices / np.linalg.norm(torus.vertices, axis=1)[:, None]
    surface = Surface(torus.vertices, torus.triangles, normals.astype(np.float32), space, "mm")
    write(surface, tmp_path / "a.surf.gii")
    image = nib.load(tmp_path / "a.surf.gii")
    vertices, triangles, found_normals = image.agg_data()
    signs = np.array(SIGNS.get(space, (1, 1, 1)), np.float32)
    assert np.array_equal(vertices, torus.vertices * signs) and np.allclose(found_normals, normals * signs, atol=1e-6)
    assert enclosed(vertices, triangles) == pytest.approx(enclosed(torus.vertices, torus.triangles))
    place = image.get_arrays_from_intent("NIFTI_INTENT_POINTSET")[0].coordsys
    assert place.dataspace == place.xformspace == (0 if space == "native" else 1)
    assert np.array_equal(place.xform, np.eye(4))


def test_an_offset_is_the_transform_to_the_world(tmp_path: Path) -> None:
    """So that nibabel finds the place again."""
    torus = shapes_mesh.torus()
    surface = Surface(torus.vertices, torus.triangles, space="lps", offset=(448000.5, 5412000.25, 7.0))
    write(surface, tmp_path / "a.gii")
    (points,) = nib.load(tmp_path / "a.gii").get_arrays_from_intent("NIFTI_INTENT_POINTSET")
    assert np.array_equal(points.coordsys.xform[:3, 3], [-448000.5, -5412000.25, 7])
    assert (points.coordsys.dataspace, points.coordsys.xformspace) == (0, 1)


def test_labels_have_a_table_with_names_and_colours(tmp_path: Path) -> None:
    """And every vertex its label; a name that would end its quotation does not."""
    one, two = shapes_mesh.cube(), shapes_mesh.tetrahedron()
    counts = [{"vertices": len(s.vertices), "triangles": len(s.triangles)} for s in (one, two)]
    parts = (
        Part(name="left ]]> <b>", colour=(255, 0, 51), label=17, **counts[0]),
        Part(name="right", label=53, **counts[1]),
    )
    vertices = np.concatenate([one.vertices, two.vertices])
    triangles = np.concatenate([one.triangles, two.triangles + len(one.vertices)]).astype(np.int32)
    write(Surface(vertices, triangles, space="las", parts=parts), tmp_path / "a.gii")
    image = nib.load(tmp_path / "a.gii")
    assert image.labeltable.get_labels_as_dict() == {17: "left ] ]> <b>", 53: "right"}
    assert image.labeltable.labels[0].rgba == pytest.approx((1.0, 0.0, 0.2, 1.0))
    (labels,) = image.get_arrays_from_intent("NIFTI_INTENT_LABEL")
    assert np.array_equal(labels.data, [17] * len(one.vertices) + [53] * len(two.vertices))


def test_a_scan_in_lps_becomes_a_surface_in_ras(tmp_path: Path) -> None:
    """And the report says so; another space by request is refused before any work."""
    header = {"space": "LPS", "space directions": np.eye(3), "space origin": [10.0, 20.0, 30.0]}
    nrrd.write(str(tmp_path / "ball.nrrd"), ball(), header, index_order="F")
    target, report = tmp_path / "ball.surf.gii", tmp_path / "run.json"
    assert run(tmp_path / "ball.nrrd", "-i", 50, "-o", target, "--report", report).exit_code == 0
    (record,) = json.loads(report.read_text())["outputs"]
    vertices = nib.load(target).agg_data("NIFTI_INTENT_POINTSET")
    low, high = record["surface"]["bounds"]
    found = [vertices.min(axis=0), vertices.max(axis=0)]
    assert record["space"] == "ras" and np.allclose(found, [low, high], atol=1e-4)
    assert high[0] < -10 and high[1] < -20 and record["surface"]["volume"] > 0
    refused = run(tmp_path / "ball.nrrd", "-i", 50, "-d", tmp_path / "out", "-f", "gii", "--space", "lps")
    assert refused.exit_code != 0 and "GIFTI is in RAS" in str(refused.output) + str(refused.exception)
    assert not (tmp_path / "out").exists()


def test_normals_are_in_the_file_by_default(tmp_path: Path) -> None:
    """As in PLY and OBJ; without them on request."""
    source = write_nifti(tmp_path / "ball.nii", ball())
    for flag, arrays in (("--normals", 3), ("--no-normals", 2)):
        assert run(source, "-i", 50, "-o", tmp_path / "b.gii", flag).exit_code == 0
        assert len(nib.load(tmp_path / "b.gii").darrays) == arrays
    assert run(source, "-i", 50, "-o", tmp_path / "b.gii").exit_code == 0
    assert len(nib.load(tmp_path / "b.gii").darrays) == 3
