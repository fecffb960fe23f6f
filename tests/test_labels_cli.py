"""`isocore convert --labels`: one surface a label, by the names that the file or a table gives them."""

from __future__ import annotations

import json
import pickle
import subprocess
import sys
from pathlib import Path
from typing import Any

import nibabel
import numpy as np
import pytest
from click.testing import CliRunner, Result
from isocore.cli.convert import convert
from nibabel.nifti1 import Nifti1Extension

from isocore.batches.label_targets import LabelRequest
from isocore.batches.plan import Naming, find_inputs, plan
from isocore.job import Job
from isocore.labels import parse_labels
from isocore.pipeline import convert as run_job
from isocore.readers.label_tables import read_label_table

LABELS = Path(__file__).resolve().parents[2] / "shared" / "data" / "labels"
needs_labels = pytest.mark.skipif(not LABELS.is_dir(), reason=f"no label maps in {LABELS}")

TABLE = b"""<?xml version="1.0" encoding="UTF-8"?> <CaretExtension><VolumeInformation Index="0"><LabelTable>
<Label Key="1" Red="1.0" Green="0.0" Blue="0.5" Alpha="1"><![CDATA[spleen]]></Label>
<Label Key="2" Red="0" Green="1" Blue="0" Alpha="1"><![CDATA[left/kidney
..]]></Label></LabelTable></VolumeInformation></CaretExtension>"""


def run(*arguments: object) -> Result:
    return CliRunner().invoke(convert, [*map(str, arguments)])


def program(*arguments: object) -> tuple[int, str]:
    """Exit code and message of the whole program."""
    command = [sys.executable, "-P", "-c", "from isocore.cli.main import main; main()", "convert", *map(str, arguments)]
    found = subprocess.run(command, capture_output=True, timeout=60, check=False, text=True)
    return found.returncode, " ".join(found.stderr.split())


def two_boxes() -> np.ndarray[Any, Any]:
    labels = np.zeros((12, 10, 8), np.int16)
    labels[2:6, 2:8, 2:6] = 1
    labels[6:10, 2:8, 2:6] = 2
    return labels


def write_map(path: Path, labels: Any, *, names: bool = True) -> Path:
    image = nibabel.Nifti1Image(labels, np.diag([2.0, 1.0, 1.0, 1.0]))
    image.header.set_xyzt_units("mm")
    if names:
        image.header.extensions.append(Nifti1Extension(0, TABLE))
    nibabel.save(image, path)
    return path


def records(path: Path) -> list[dict[str, Any]]:
    return json.loads(path.read_text())["outputs"]


def test_every_label_is_a_file_and_a_row(tmp_path: Path) -> None:
    """Names, colours, voxels, neighbours in the record; the name, made safe, in the file's."""
    source = write_map(tmp_path / "seg.nii.gz", two_boxes())
    result = run(source, "--labels", "all", "-d", tmp_path / "out", "--report", tmp_path / "r.json")
    assert result.exit_code == 0, result.output
    names = sorted(path.name for path in (tmp_path / "out").glob("*.ply"))
    assert names == ["seg_left_kidney.ply", "seg_spleen.ply"]
    spleen, kidney = records(tmp_path / "r.json")
    assert spleen["label"] == {
        "value": 1, "name": "spleen", "color": "#ff0080", "voxels": 96, "voxel_volume": 192.0, "neighbours": [0, 2],
    }  # fmt: skip
    assert kidney["label"]["name"] == "left/kidney .."
    assert spleen["isovalue"] is None and spleen["asked"] == "label 1" and spleen["backend"] == "labels"
    for row in (spleen, kidney):
        assert row["surface"]["watertight"] and row["surface"]["euler"] == 2
    assert spleen["surface"]["volume"] == pytest.approx(192, rel=0.1)


def test_labels_that_are_not_there_are_empty_and_the_others_are_made(tmp_path: Path) -> None:
    """Not a failure: an organ outside of the scan is no mistake."""
    source = write_map(tmp_path / "seg.nii", two_boxes(), names=False)
    result = run(source, "--labels", "2,7-8", "-d", tmp_path, "--report", tmp_path / "r.json")
    assert result.exit_code == 0
    rows = records(tmp_path / "r.json")
    assert [(row["label"]["value"], row["status"], row["label"]["voxels"]) for row in rows] == [
        (2, "done", 96), (7, "empty", 0), (8, "empty", 0),
    ]  # fmt: skip
    assert rows[1]["message"].endswith("no sample is label 7")
    assert (tmp_path / "seg_label_2.ply").is_file()


def test_a_list_asks_for_the_same_meshes_as_all(tmp_path: Path) -> None:
    """Labels that are not asked for take part all the same."""
    source = write_map(tmp_path / "seg.nii", two_boxes())
    assert run(source, "--labels", "all", "-d", tmp_path / "all").exit_code == 0
    assert run(source, "--labels", "1", "-d", tmp_path / "one").exit_code == 0
    assert (tmp_path / "one/seg_spleen.ply").read_bytes() == (tmp_path / "all/seg_spleen.ply").read_bytes()


def test_the_background_is_a_choice(tmp_path: Path) -> None:
    """Another label may be none; 0 then is a label as others are."""
    source = write_map(tmp_path / "seg.nii", two_boxes(), names=False)
    assert run(source, "--labels", "all", "--background", 1, "-d", tmp_path / "out").exit_code == 0
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == ["seg_label_0.ply", "seg_label_2.ply"]


def test_two_labels_of_one_name_both_get_their_number(tmp_path: Path) -> None:
    """Otherwise one file would be the other's."""
    table = tmp_path / "names.csv"
    table.write_text("label,name\n1,tumor\n2,Tumor\n")
    source = write_map(tmp_path / "seg.nii", two_boxes())
    assert run(source, "--labels", "all", "--names", table, "-d", tmp_path / "out").exit_code == 0
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == ["seg_Tumor_2.ply", "seg_tumor_1.ply"]


TABLES = {
    "freesurfer.txt": "#No. Label Name: R G B A\n  0  Unknown  0 0 0 0\n 17  Left-Hippocampus   220 216 20  0\n",
    "snap.label": '# ITK-SnAP Label\n 0 0 0 0 0 0 0 "Clear Label"\n 17 220 216 20 1 1 1 "Left-Hippocampus"\n',
    "slicer.ctbl": "# Color table\n17 Left-Hippocampus 220 216 20 255\n",
    "dseg.tsv": "index\tname\tcolor\n17\tLeft-Hippocampus\t#dcd814\n",
    "parts.tsv": "index\tname\tr\tg\tb\n17\tLeft-Hippocampus\t220\t216\t20\n",
    "plain.csv": "17,Left-Hippocampus,220,216,20\n",
    "semicolons.csv": "Label;Name;Red;Green;Blue\n17;Left-Hippocampus;220;216;20\n",
}


@pytest.mark.parametrize("name", TABLES)
def test_tables_name_and_colour(tmp_path: Path, name: str) -> None:
    """FreeSurfer, ITK-SNAP, Slicer, BIDS and CSV."""
    path = tmp_path / name
    path.write_text(TABLES[name])
    label = read_label_table(path)[17]
    assert (label.name, label.colour) == ("Left-Hippocampus", (220, 216, 20))


def test_names_alone_are_enough(tmp_path: Path) -> None:
    """A number and a name with blanks, without a colour."""
    (tmp_path / "names.txt").write_text("17 Left Hippocampus\n18 Amygdala\n")
    found = read_label_table(tmp_path / "names.txt")
    assert {value: label.name for value, label in found.items()} == {17: "Left Hippocampus", 18: "Amygdala"}
    assert found[17].colour is None


@pytest.mark.parametrize("text", ["", "no table at all\n", "\0\1\2"])
def test_a_table_without_labels_is_refused(tmp_path: Path, text: str) -> None:
    """One line that starts with the path, and exit code 2."""
    (tmp_path / "names.txt").write_text(text)
    source = write_map(tmp_path / "seg.nii", two_boxes())
    code, message = program(source, "--labels", "all", "--names", tmp_path / "names.txt")
    assert code == 2 and "names no label" in message


def test_slicers_segments_name_themselves(tmp_path: Path) -> None:
    """A .seg.nrrd, its segments in two layers: each layer is a volume, and names its own."""
    import nrrd

    layers = np.zeros((2, 12, 10, 8), np.uint8)
    layers[0, 2:6, 2:8, 2:6] = 1
    layers[1, 4:9, 3:7, 3:6] = 1
    header = {
        "kinds": ["list", "domain", "domain", "domain"],
        "space": "left-posterior-superior",
        "space directions": np.array([[np.nan] * 3, [1, 0, 0], [0, 1, 0], [0, 0, 1]]),
        "space origin": [0, 0, 0],
        "Segment0_ID": "Segment_1", "Segment0_Name": "tumour", "Segment0_LabelValue": "1", "Segment0_Layer": "0",
        "Segment0_Color": "1 0 0",
        "Segment1_ID": "Segment_2", "Segment1_Name": "oedema", "Segment1_LabelValue": "1", "Segment1_Layer": "1",
        "Segment1_Color": "0 0.5 0",
    }  # fmt: skip
    nrrd.write(str(tmp_path / "case.seg.nrrd"), layers, header)
    result = run(
        tmp_path / "case.seg.nrrd", "--labels", "all", "--volume", "all", "-d", tmp_path / "out",
        "--report", tmp_path / "r.json",
    )  # fmt: skip
    assert result.exit_code == 0, result.output
    found = [(row["label"]["name"], row["label"]["color"]) for row in records(tmp_path / "r.json")]
    assert found == [("tumour", "#ff0000"), ("oedema", "#008000")]


def test_floats_that_hold_whole_numbers_are_labels_and_nan_is_background(tmp_path: Path) -> None:
    """Counted and said; fractions are refused."""
    labels = two_boxes().astype(np.float32)
    labels[0, 0, 0] = np.nan
    source = write_map(tmp_path / "seg.nii", labels)
    assert run(source, "--labels", "all", "-d", tmp_path / "out", "--report", tmp_path / "r.json").exit_code == 0
    assert any("1 sample is NaN" in warning for warning in records(tmp_path / "r.json")[0]["warnings"])
    labels[0, 0, 0] = 0.25
    result = run(write_map(tmp_path / "odd.nii", labels), "--labels", "all", "-d", tmp_path / "odd")
    assert result.exit_code == 1
    assert "odd.nii: holds 0.25, which is no label" in " ".join(result.output.split())


def test_if_changed_leaves_labels_alone_that_are_up_to_date(tmp_path: Path) -> None:
    """Each label has its own stamp; another number of rounds makes them anew."""
    source = write_map(tmp_path / "seg.nii", two_boxes())
    arguments = (source, "--labels", "all", "-d", tmp_path / "out", "--if-changed", "--report", tmp_path / "r.json")
    for more, statuses in (((), {"done"}), ((), {"skipped"}), (("--smooth", 5), {"done"})):
        assert run(*arguments, *more).exit_code == 0
        assert {row["status"] for row in records(tmp_path / "r.json")} == statuses


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("--labels", "all", "-i", "1"), "does not go with -i"),
        (("--labels", "all", "-b", "asc"), "does not go with -b"),
        (("--labels", "1-"), "is no list of labels"),
        (("--labels", "9-1"), "must run upwards"),
        (("--background", "3"), "is about label maps"),
        (("--labels", "all", "--block-size", "4"), "is not an option of labels"),
    ],
)
def test_requests_that_make_no_sense_are_refused(tmp_path: Path, arguments: tuple[str, ...], words: str) -> None:
    """Before anything is read."""
    code, message = program(tmp_path / "missing.nii", *arguments)
    assert code == 2 and words in message


def test_a_mask_is_smoothed_by_marching_cubes(tmp_path: Path) -> None:
    """Same topology, the same number of triangles, less area; the record says so."""
    mask = (two_boxes() > 0).astype(np.uint8)
    source = write_map(tmp_path / "mask.nii", mask)
    assert run(source, "-b", "mc", "-d", tmp_path / "a", "--report", tmp_path / "a.json").exit_code == 0
    assert run(source, "--smooth", 20, "-d", tmp_path / "b", "--report", tmp_path / "b.json").exit_code == 0
    rough, smooth = records(tmp_path / "a.json")[0], records(tmp_path / "b.json")[0]
    assert smooth["backend"] == "mc" and smooth["options"]["smooth"] == 20
    assert rough["surface"]["triangles"] == smooth["surface"]["triangles"]
    assert rough["surface"]["euler"] == smooth["surface"]["euler"]
    assert smooth["surface"]["area"] < rough["surface"]["area"]


@needs_labels
def test_totalsegmentators_map_names_its_organs(tmp_path: Path) -> None:
    """Without any option."""
    result = run(LABELS / "totalsegmentator_42.nii.gz", "--labels", "all", "-d", tmp_path, "--require", "watertight")
    assert result.exit_code == 0
    assert (tmp_path / "totalsegmentator_42_spleen.ply").is_file()


def test_the_background_has_no_surface_and_the_message_says_so(tmp_path: Path) -> None:
    """Asked for by its number, and in a map that holds nothing else."""
    path, empty = write_map(tmp_path / "seg.nii", two_boxes()), write_map(tmp_path / "e.nii", 0 * two_boxes())
    for file, asked in ((path, "0"), (empty, "all")):
        run(file, "--labels", asked, "-d", tmp_path / "out", "--report", tmp_path / "r.json")
        (row,) = records(tmp_path / "r.json")
        assert row["status"] == "empty"
        assert row["message"] == "label 0 is the background, which has no surface; --background names another"


def test_samples_that_are_ignored_are_not_counted_as_nan(tmp_path: Path) -> None:
    """They are background because they were named, which is no news; one NaN is a sample."""
    samples = two_boxes().astype(np.float32)
    samples[3, 3, 3] = np.nan
    run(write_map(tmp_path / "seg.nii", samples), "--labels", "all", "--ignore", 2, "-d", tmp_path / "out",
        "--report", tmp_path / "r.json")  # fmt: skip
    (row,) = records(tmp_path / "r.json")
    assert "1 sample is NaN and counts as background" in row["warnings"] and row["ignored"] == 96


@pytest.mark.parametrize("more", [0, 1])
def test_a_map_of_100000_labels_is_the_largest(tmp_path: Path, more: int) -> None:
    """The background not counted; of what is refused the values are counted."""
    samples = np.zeros(47 * 47 * 48, np.int32)
    samples[: 100_000 + more] = np.arange(1, 100_001 + more)
    path = write_map(tmp_path / "many.nii", samples.reshape(47, 47, 48), names=False)
    run(path, "--labels", 5, "-d", tmp_path / "out", "--report", tmp_path / "r.json")
    (row,) = records(tmp_path / "r.json")
    assert row["status"] == ("failed" if more else "done")
    assert more == 0 or "holds 100,002 values, and a label map has at most 100,000 labels" in row["message"]


def test_a_name_that_is_too_long_for_a_file_is_cut(tmp_path: Path) -> None:
    """In the file's name only; two that then agree get their numbers."""
    names = ["ä" * 300 + "left", "ä" * 300 + "right"]
    (tmp_path / "names.csv").write_text("".join(f"{n},{name}\n" for n, name in enumerate(names, 1)), encoding="utf-8")
    path = write_map(tmp_path / "seg.nii", two_boxes(), names=False)
    run(path, "--labels", "all", "--names", tmp_path / "names.csv", "-d", tmp_path, "--report", tmp_path / "r.json")
    rows = records(tmp_path / "r.json")
    assert [row["label"]["name"] for row in rows] == names
    assert [Path(row["output"]).name for row in rows] == [f"seg_{'ä' * 50}_{n}.ply" for n in (1, 2)]


def test_labels_are_simplified_together_where_a_bound_is_given(tmp_path: Path) -> None:
    """Fewer triangles, within the bound both ways; with --no-simplify all of them; a list gives the same meshes."""
    source = write_map(tmp_path / "map.nii", two_boxes())
    report = tmp_path / "r.json"
    asked: dict[str, tuple[str, ...]] = {
        "all": ("--max-error", "0.4"),
        "none": ("--max-error", "0.4", "--no-simplify"),
        "mm": ("--simplify", "--max-error", "0.4mm"),
    }
    rows = {}
    for name, options in asked.items():
        result = run(source, "--labels", "all", "-d", tmp_path / name, "--report", report, *options)
        assert result.exit_code == 0, result.output
        rows[name] = records(report)
    for row, whole in zip(rows["all"], rows["none"], strict=True):
        fewer, error = row["simplification"], row["error"]
        assert fewer["triangles_before"] == whole["surface"]["triangles"]
        assert row["surface"]["triangles"] == fewer["triangles_before"] - 2 * fewer["collapses"] < 250
        assert 0 < error["mean"] <= error["rms"] <= error["max"] <= 0.4 and 0 < error["back_max"] <= 0.4
        assert row["surface"]["watertight"] and row["surface"]["euler"] == 2
        assert whole["simplification"] is None and whole["error"] is None
    assert all(0 < row["error"]["max_world"] <= 0.4 for row in rows["mm"])
    assert run(source, "--labels", "2", "-d", tmp_path / "list", "--max-error", "0.4").exit_code == 0
    name = "map_left_kidney.ply"
    assert (tmp_path / "list" / name).read_bytes() == (tmp_path / "all" / name).read_bytes()


def test_a_number_of_triangles_is_that_of_all_labels_together(tmp_path: Path) -> None:
    """Each triangle between two labels counts once; where a given bound forbids fewer, a warning says so."""
    source = write_map(tmp_path / "map.nii", two_boxes(), names=False)
    report = tmp_path / "r.json"
    arguments = (source, "--labels", "all", "-o", tmp_path / "all.ply", "--triangles", "60", "--report", report)
    assert run(*arguments).exit_code == 0
    both = sum(row["surface"]["triangles"] for row in records(report))
    assert 60 < both < 60 + 30  # what lies between the two is in both
    bounded = run(*arguments, "--max-error", "0.01")
    assert bounded.exit_code == 0 and "--triangles 60" in bounded.stderr and "--max-error 0.01" in bounded.stderr


def test_a_map_is_read_once(tmp_path: Path) -> None:
    """What planning reads to know the labels is converted, even if the file is gone; a job that is sent reads again."""
    source = write_map(tmp_path / "map.nii", two_boxes())
    request = LabelRequest(labels=parse_labels("all"))
    pattern = Job(source=Path(), targets=())
    jobs = [plan(find_inputs([source]), (), pattern, Naming(output_dir=tmp_path), labels=request)[0] for _ in range(2)]
    sent = pickle.loads(pickle.dumps(jobs[0]))
    source.unlink()
    runs = list(run_job(jobs[1]))
    assert [one.status for one in runs] == ["done", "done"]
    assert runs[0].seconds is not None and runs[0].seconds.read > 0
    assert [one.status for one in run_job(jobs[1])] == ["failed", "failed"]  # it is not kept for longer
    assert [one.status for one in run_job(sent)] == ["failed", "failed"]
