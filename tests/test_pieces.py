"""`--keep-largest`, `--min-piece`, `--fill-bubbles`: which pieces of a surface are kept, and what the report says."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from click.testing import CliRunner, Result
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from isocore.cli.convert import convert
from small_files import ball, write_nifti

import isocore
from isocore import _kernels
from isocore.errors import OptionError
from isocore.job import Options
from isocore.piece_sizes import FewestTriangles, SmallestVolume, parse_min_piece
from isocore.pieces import keep_pieces

Mask = npt.NDArray[np.uint8]
masks = arrays(np.uint8, st.tuples(*[st.integers(3, 7)] * 3), elements=st.integers(0, 1), fill=st.nothing())


def extract(samples: npt.NDArray[Any], *, cap: bool = True, **asked: Any) -> isocore.Surface:
    volume = isocore.Volume(np.asfortranarray(samples), unit="mm")
    return isocore.extract(volume, 0.5, backend="mc", options=Options(cap=cap, **asked))


def boxes(*sides: int, hollow: tuple[int, ...] = ()) -> Mask:
    """Cubes of these sides, one beside the other; those in `hollow` have an empty sample in their middle."""
    samples = np.zeros((sum(sides) + len(sides) + 1, max(sides) + 2, max(sides) + 2), np.uint8)
    at = 1
    for number, side in enumerate(sides):
        samples[at : at + side, 1 : side + 1, 1 : side + 1] = 1
        if number in hollow:
            samples[at + side // 2, 1 + side // 2, 1 + side // 2] = 0
        at += side + 1
    return samples


def nest() -> Mask:
    """A ball in a shell in a shell, and a small box beside them."""
    distance = np.abs(np.mgrid[-8:9, -6:7, -6:7]).max(0)
    samples = np.isin(distance, [0, 1, 3, 5]).astype(np.uint8)
    samples[15:16, 2:4, 2:4] = 1
    return samples


def volume_of(surface: isocore.Surface) -> float:
    return isocore.measure(surface).volume or 0.0


def run(*arguments: object) -> Result:
    return CliRunner().invoke(convert, [str(argument) for argument in arguments])


def record(tmp_path: Path, *arguments: object) -> dict[str, Any]:
    result = run(*arguments, "-d", tmp_path / "out", "--report", tmp_path / "run.json", "-q")
    assert result.exit_code in (0, 1), result.output
    found: dict[str, Any] = json.loads((tmp_path / "run.json").read_text())["outputs"][0]
    return found


def corners(surface: isocore.Surface) -> set[tuple[Any, ...]]:
    return {tuple(map(tuple, triangle)) for triangle in surface.vertices[surface.triangles].tolist()}


@given(samples=masks, number=st.integers(1, 4), fill=st.booleans())
@settings(max_examples=60, deadline=None)
def test_what_is_kept_is_solids_and_the_largest(samples: Mask, number: int, fill: bool) -> None:
    """A part of the surface, still closed, of so many pieces; no piece that is left out is larger."""
    whole = extract(samples)
    kept = keep_pieces(whole, Options(keep_largest=number, fill_bubbles=fill))
    facts, surface = kept.facts, kept.surface
    assert facts is not None and corners(surface) <= corners(whole)
    measured = isocore.measure(surface)
    assert measured.boundary_edges == measured.nonmanifold_edges == 0
    assert facts.kept + facts.dropped + facts.swallowed == facts.found
    assert facts.kept + facts.swallowed == min(number, facts.found)
    assert facts.triangles_dropped == len(whole.triangles) - len(surface.triangles)
    assert len(np.unique(surface.triangles)) == len(surface.vertices)
    after = volume_of(whole) - facts.volume_dropped + facts.volume_filled
    assert volume_of(surface) == pytest.approx(after, abs=1e-6)
    shells = _kernels.shells(surface.vertices, surface.triangles)
    own = [shells.volumes[shells.piece == n].sum() for n in np.unique(shells.piece)]
    everything = _kernels.shells(whole.vertices, whole.triangles)
    sizes = sorted((everything.volumes[everything.piece == n].sum() for n in np.unique(everything.piece)), reverse=True)
    if fill:
        assert (shells.volumes > 0).all() and (shells.around < 0).all() | (facts.swallowed == 0)
    else:
        assert sorted(own, reverse=True) == pytest.approx(sizes[:number])


@given(samples=masks, fewest=st.integers(0, 40))
@settings(max_examples=40, deadline=None)
def test_the_smallest_piece_counts_its_bubbles_triangles(samples: Mask, fewest: int) -> None:
    """No piece that is kept has fewer triangles, none that is left out as many."""
    whole = extract(samples)
    shells = _kernels.shells(whole.vertices, whole.triangles)
    counts = [int(shells.triangles[shells.piece == n].sum()) for n in np.unique(shells.piece)]
    kept = keep_pieces(whole, Options(min_piece=FewestTriangles(fewest, str(fewest))))
    assert len(kept.surface.triangles) == sum(count for count in counts if count >= fewest)
    assert kept.facts is not None and kept.facts.kept == sum(count >= fewest for count in counts)


def test_the_largest_keeps_its_bubble() -> None:
    """Which takes from its volume: what is solid counts."""
    surface = extract(boxes(3, 5, 4, hollow=(1,)), keep_largest=1)
    assert _kernels.shells(surface.vertices, surface.triangles).piece.tolist() == [0, 0]
    assert volume_of(surface) == pytest.approx(volume_of(extract(boxes(5, hollow=(0,)))))


def test_filled_bubbles_swallow_what_is_inside() -> None:
    """Of the nest its outermost shell is left, and the box beside it."""
    kept = keep_pieces(extract(nest()), Options(fill_bubbles=True))
    facts = kept.facts
    assert facts is not None
    assert (facts.found, facts.kept, facts.swallowed, facts.dropped, facts.bubbles_filled) == (4, 2, 2, 0, 2)
    assert _kernels.shells(kept.surface.vertices, kept.surface.triangles).around.tolist() == [-1, -1]
    largest = extract(nest(), keep_largest=1, fill_bubbles=True)
    assert _kernels.measure(largest.vertices, largest.triangles).components == 1


def test_a_solid_in_a_bubble_stays_where_bubbles_do() -> None:
    """Two largest of the nest: its two outer solids with their bubbles."""
    surface = extract(nest(), keep_largest=2)
    assert _kernels.shells(surface.vertices, surface.triangles).piece.tolist() == [0, 0, 2, 2]


@pytest.mark.parametrize("spacing", [1.0, 0.7])
def test_of_equal_pieces_the_first_are_kept(spacing: float) -> None:
    """Also where rounded coordinates make them differ in the last digits."""
    samples = np.asfortranarray(np.concatenate([boxes(2, 2, 2, 2)] * 2))
    volume = isocore.Volume.from_array(samples, spacing=spacing, origin=(1000.1, -3, 7))
    kept = isocore.extract(volume, 0.5, backend="mc", keep_largest=3, cap=True)
    first = isocore.extract(isocore.Volume.from_array(samples[:10], spacing=spacing, origin=(1000.1, -3, 7)), 0.5,
                            backend="mc", cap=True)  # fmt: skip
    assert kept.vertices[:, 0].max() == first.vertices[:, 0].max()
    assert len(kept.triangles) == len(first.triangles)


def test_where_a_piece_is_open_area_decides() -> None:
    """The plate at the border encloses nothing, and closed less than the box, but has the larger area."""
    samples = np.zeros((20, 14, 14), np.uint8)
    samples[0, 1:13, 1:13] = 1
    samples[6:11, 3:8, 3:8] = 1
    kept = keep_pieces(extract(samples, cap=False), Options(keep_largest=1))
    assert kept.surface.vertices[:, 0].max() == 0.5
    assert "1 piece is open, so that nothing is enclosed: --keep-largest goes by area; --cap" in kept.warnings[0]
    closed = keep_pieces(extract(samples), Options(keep_largest=1))
    assert closed.warnings == () and closed.surface.vertices[:, 0].min() == 5.5


def test_an_open_piece_is_not_too_small_by_volume() -> None:
    """It encloses none; a warning says so."""
    samples = np.zeros((12, 8, 8), np.uint8)
    samples[0, 3, 3] = samples[5, 3, 3] = 1
    samples[8:11, 3:6, 3:6] = 1
    kept = keep_pieces(extract(samples, cap=False), Options(min_piece="5mm3"))
    assert kept.facts is not None
    assert (kept.facts.found, kept.facts.kept, kept.facts.open) == (3, 2, 1)
    assert "--min-piece 5mm3 keeps it" in kept.warnings[0]


def test_normals_and_vertices_stay_together() -> None:
    """Each vertex keeps its own normal."""
    samples = boxes(3, 5, 4).astype(np.float32)
    whole, largest = (extract(samples, normals=True, **asked) for asked in ({}, {"keep_largest": 1}))
    assert whole.normals is not None and largest.normals is not None
    known = dict(zip(map(tuple, whole.vertices.tolist()), whole.normals.tolist(), strict=True))
    assert [known[place] for place in map(tuple, largest.vertices.tolist())] == largest.normals.tolist()


@pytest.mark.parametrize(
    ("text", "means"),
    [
        ("20", FewestTriangles(20, "20")),
        ("20mm3", SmallestVolume(20, "mm", "20mm3")),
        ("0.5 mm^3", SmallestVolume(0.5, "mm", "0.5 mm^3")),
        ("3e2µm³", SmallestVolume(300, "µm", "3e2µm³")),
        ("13", FewestTriangles(13, "13")),
        ("0", FewestTriangles(0, "0")),
    ],
)
def test_a_size_is_triangles_or_a_volume(text: str, means: object) -> None:
    """With a unit it is a volume; it prints as it was written."""
    assert parse_min_piece(text) == means and str(means) == text


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("20mm", "is a length; write a volume"),
        ("2.5", "triangles are whole"),
        ("-3", "not negative"),
        ("1e999mm3", "must be finite"),
        ("nanmm3", "is no size"),
        ("3kg3", "kg is no unit known here"),
        ("lots", "is no size"),
        ("", "is no size"),
        ("20mm2", "is no size"),
    ],
)
def test_nonsense_is_no_size(text: str, says: str) -> None:
    """One line that says what to write."""
    with pytest.raises(OptionError, match=says):
        parse_min_piece(text)


def test_a_volume_needs_a_unit(tmp_path: Path) -> None:
    """Of a raw file lengths mean nothing; triangles can be counted."""
    raw = tmp_path / "boxes.raw"
    raw.write_bytes(boxes(3, 5).tobytes(order="F"))
    shape = ",".join(map(str, boxes(3, 5).shape))
    found = record(tmp_path, raw, "--shape", shape, "--dtype", "uint8", "--min-piece", "20mm3")
    assert "--min-piece 20mm3: the input does not say its unit; give a number of triangles" in found["message"]
    assert record(tmp_path, raw, "--shape", shape, "--dtype", "uint8", "--min-piece", 20)["status"] == "done"
    with pytest.raises(OptionError, match=r"min_piece 20mm3: the input does not say"):
        isocore.extract(isocore.Volume(np.asfortranarray(boxes(3))), 0.5, min_piece="20mm3")


@pytest.mark.parametrize("backend", ["asc", "mc", "thinning"])
def test_every_backend_reports_its_pieces(tmp_path: Path, backend: str) -> None:
    """What was found, kept and dropped; the reference and the ratio are those of all pieces."""
    path = write_nifti(tmp_path / "nest.nii", nest())
    whole = record(tmp_path, path, "--cap", "-b", backend)
    assert "pieces" in whole and whole["pieces"] is None
    found = record(tmp_path, path, "--cap", "-b", backend, "--keep-largest", 1, "--fill-bubbles", "-f", "obj")
    pieces, after = found["pieces"], found["surface"]
    assert (pieces["found"], pieces["kept"], pieces["dropped"], pieces["bubbles_filled"]) == (4, 1, 3, 1)
    assert pieces["triangles_dropped"] == whole["surface"]["triangles"] - after["triangles"]
    assert pieces["vertices_dropped"] == whole["surface"]["vertices"] - after["vertices"]
    assert after["volume"] == pytest.approx(
        whole["surface"]["volume"] - pieces["volume_dropped"] + pieces["volume_filled"]
    )
    assert found["reference"]["triangles"] == whole["reference"]["triangles"]
    assert found["reference"]["vertices"] == whole["reference"]["vertices"]
    assert found["ratio"]["triangles"] == whole["ratio"]["triangles"]
    assert found["options"]["keep_largest"] == 1 and found["options"]["fill_bubbles"] is True


def test_a_mesh_has_pieces_too(tmp_path: Path) -> None:
    """As many as there are components; a unit is not known."""
    torus = Path(__file__).resolve().parents[1] / "sample_volumes" / "torus.vtu"
    found = record(tmp_path, torus, "-i", 0.1, "--keep-largest", 1)
    assert found["status"] == "done" and found["pieces"]["kept"] == found["surface"]["components"] == 1
    assert found["pieces"]["found"] == record(tmp_path, torus, "-i", 0.1)["surface"]["components"]
    assert "does not say its unit" in record(tmp_path, torus, "-i", 0.1, "--min-piece", "1mm3")["message"]


def test_every_label_keeps_its_own_largest_piece(tmp_path: Path) -> None:
    """The stage is the same for labels."""
    path = write_nifti(tmp_path / "seg.nii", boxes(2, 4))
    assert record(tmp_path, path, "--labels", "all")["surface"]["components"] == 2
    found = record(tmp_path, path, "--labels", "all", "--keep-largest", 1)
    assert found["surface"]["components"] == 1 and found["pieces"]["dropped"] == 1
    assert found["surface"]["bounds"][0][0] == 3.5


def test_an_error_measured_again_is_that_of_the_whole_surface(tmp_path: Path) -> None:
    """STL's rounding of vertices far away must not make what was dropped an error."""
    samples = np.zeros((40, 20, 20), np.float32)
    samples[:20] = ball(20, radius=7)
    samples[26:34, 6:14, 6:14] = ball(8, radius=3)
    path = write_nifti(tmp_path / "balls.nii", samples)
    for more in ((), ("--keep-largest", 1)):
        found = record(tmp_path, path, "-i", 50, "--cap", "-f", "stl", "--offset", "-5e6,0.3,0.7", *more)
        assert found["error"]["max"] < 1.0
    assert found["pieces"]["dropped"] >= 1


@pytest.mark.parametrize(
    ("size", "says"),
    [
        ("9999", "no piece is left: the largest of 2 pieces has 140 triangles, --min-piece is 9999"),
        ("500mm3", "no piece is left: the largest of 2 pieces encloses"),
    ],
)
def test_where_all_is_too_small_the_output_is_empty(tmp_path: Path, size: str, says: str) -> None:
    """The message says by how much."""
    found = record(tmp_path, write_nifti(tmp_path / "boxes.nii", boxes(2, 5)), "-b", "mc", "--cap", "--min-piece", size)
    assert found["status"] == "empty" and says.split(" has ")[0] in found["message"], found["message"]
    assert found["pieces"]["kept"] == 0 and found["surface"]["triangles"] == 0


def test_stamps_count_what_is_asked_of_pieces(tmp_path: Path) -> None:
    """Another number, another output."""
    path = write_nifti(tmp_path / "boxes.nii", boxes(2, 5, 3))
    asked = ((), ("--keep-largest", 1), ("--keep-largest", 2), ("--min-piece", 50), ("--min-piece", "20mm3"))
    for more in (*asked, ("--fill-bubbles",)):
        statuses = [record(tmp_path, path, "-b", "mc", "--if-changed", *more)["status"] for _ in range(2)]
        assert statuses == ["done", "skipped"], more


@pytest.mark.parametrize("option", [("--keep-largest", 0), ("--min-piece", "20mm"), ("--min-piece", "x")])
def test_a_wrong_size_is_a_wrong_command(tmp_path: Path, option: tuple[object, ...]) -> None:
    """Before any file is read."""
    result = run(tmp_path / "none.nii", *option)
    assert result.exit_code == 2 or isinstance(result.exception, OptionError)


def test_files_from_python_take_the_same(tmp_path: Path) -> None:
    """As arguments of the same names."""
    path = write_nifti(tmp_path / "boxes.nii", boxes(2, 5, 3))
    batch = isocore.convert_files(path, tmp_path / "out", keep_largest=2, min_piece="20mm3", fill_bubbles=True)
    pieces = batch.outputs[0].findings.pieces
    assert pieces is not None and (pieces.found, pieces.kept) == (3, 1)
