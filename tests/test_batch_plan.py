"""Which files a command means, what their surfaces are called, and that nothing is overwritten."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner
from isocore.cli.convert import convert
from small_files import ball, write_nifti

from isocore.batches import places
from isocore.batches.inputs import find_inputs
from isocore.batches.naming import NAME_FIELDS, check_template
from isocore.batches.places import Places, ignores_case
from isocore.errors import OptionError

PROGRAM = [sys.executable, "-P", "-c", "from isocore.cli.main import main; main()", "convert"]
FAST = ("-i", "50", "-b", "mc", "-q")


def isocore(folder: Path, *arguments: object, **settings: Any) -> subprocess.CompletedProcess[str]:
    command = [*settings.pop("before", ()), *PROGRAM, *map(str, arguments)]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=60, check=False, **settings)


def files_in(folder: Path) -> list[str]:
    return sorted(path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file())


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The working folder, with a few scans."""
    monkeypatch.chdir(tmp_path)
    for name in ("s1/T1.nii.gz", "s2/T1.nii.gz", "s2/deep/T1.nii.gz"):
        write_nifti(tmp_path / name, ball())
    return tmp_path


def planned(*arguments: object) -> list[str]:
    """Where the surfaces would go; raises what the command would refuse."""
    result = CliRunner().invoke(convert, [*map(str, arguments), "-i", "50", "--dry-run"], catch_exceptions=True)
    if result.exception is not None and not isinstance(result.exception, SystemExit):
        raise result.exception
    return [line.partition(" -> ")[2].partition(":")[0] for line in result.stdout.splitlines()]


# Names


@pytest.mark.parametrize(
    ("template", "names"),
    [
        ("{relpath}", ["out/s1/T1.ply", "out/s2/T1.ply", "out/s2/deep/T1.ply"]),
        ("{parent}_{stem}", ["out/s1_T1.ply", "out/s2_T1.ply", "out/deep_T1.ply"]),
        ("{relpath}_{isovalue}", ["out/s1/T1_50.ply", "out/s2/T1_50.ply", "out/s2/deep/T1_50.ply"]),
    ],
)
def test_files_by_name_are_told_apart_by_their_folders(here: Path, template: str, names: list[str]) -> None:
    """As `*/T1.nii.gz` gives them; also from a list, by absolute paths and by way of other folders."""
    scans = ["s1/T1.nii.gz", "s2/T1.nii.gz", "s2/deep/T1.nii.gz"]
    assert planned(*scans, "-d", "out", "--name", template) == names
    assert planned(*(here / name for name in scans), "-d", "out", "--name", template) == names
    assert planned("s2/../s1/T1.nii.gz", *(f"./{name}" for name in scans[1:]), "-d", "out", "--name", template) == names
    (here / "list").write_text("\n".join(scans))
    assert planned("--files-from", "list", "-d", "out", "--name", template) == names


def test_the_way_to_one_file_is_its_stem(here: Path) -> None:
    """What is common to all that is named does not stand in any name; below a folder it is the way from there."""
    assert planned("s2/deep/T1.nii.gz", "-d", "out", "--name", "{relpath}") == ["out/T1.ply"]
    assert planned("s2", "-d", "out", "--name", "{relpath}") == ["out/T1.ply", "out/deep/T1.ply"]
    assert planned("s1", "s2/deep", "-d", "out", "--name", "{relpath}") == ["out/s1/T1.ply", "out/s2/deep/T1.ply"]


def test_without_an_output_folder_surfaces_lie_beside_their_inputs(here: Path) -> None:
    """Whatever of their way stands in the template."""
    beside = ["s1/T1.ply", "s2/deep/T1.ply"]
    assert planned("s1/T1.nii.gz", "s2/deep/T1.nii.gz") == beside
    assert planned("s1/T1.nii.gz", "s2/deep/T1.nii.gz", "--name", "{relpath}") == beside
    assert planned("s1/T1.nii.gz", "s2/deep/T1.nii.gz", "--name", "{parent}") == ["s1/s1.ply", "s2/deep/deep.ply"]


@pytest.mark.parametrize(
    ("arguments", "template"),
    [
        (("s1/T1.nii.gz", "s2/T1.nii.gz"), "{relpath}"),
        (("s1/T1.nii.gz", "s1/T1.nii"), "{name}"),
        (("s1/T1.nii.gz", "s1/T1.nii", "s2/T1.nii.gz"), "{parent}_{name}"),
        (("s1/T1.nii.gz", "s1/T1.nii", "s2/T1.nii.gz", "x/s2/T1.nii.gz"), "{relpath}_{name}"),
        (("s1/T1.nii.gz", "-i", "60", "--name", "{stem}"), "{stem}_{isovalue}"),
        (("s1/T1.nii.gz", "s2/T1.nii.gz", "--name", "bone"), "{relpath}_bone"),
        (("s1/T1.nii.gz", "s2/T1.nii.gz", "--name", "a_{stem}", "-i", "60"), "a_{relpath}_{isovalue}"),
        (("series.nii", "--volume", "all", "--name", "{stem}"), "{stem}_v{volume}"),
    ],
)
def test_a_clash_names_a_template_that_works(here: Path, arguments: tuple[str, ...], template: str) -> None:
    """The one it recommends is taken."""
    import numpy as np

    for name in ("s1/T1.nii", "x/s2/T1.nii.gz"):
        write_nifti(here / name, ball())
    write_nifti(here / "series.nii", np.stack([ball(), ball(radius=3)], axis=3))
    with pytest.raises(OptionError, match="would be written by") as refusal:
        planned(*arguments, "-d", "out")
    recommended = str(refusal.value).partition("tell them apart with --name ")[2]
    assert recommended == template
    outputs = planned(*arguments, "-d", "out", "--name", recommended)
    assert len(outputs) == len(set(outputs)) > 1


def test_a_recommended_name_overwrites_nothing(here: Path) -> None:
    """A template whose surfaces would lie over a report is not recommended."""
    arguments = ("s1/T1.nii.gz", "s2/T1.nii.gz", "-d", "out")
    with pytest.raises(OptionError) as refusal:
        planned(*arguments, "--depfile", "out/s2/T1.ply")
    assert str(refusal.value).endswith("tell them apart with --name {parent}_{stem}")


@pytest.mark.parametrize("template", ["{stem:d}", "{stem!x}", "{stem!r}", "{stem:{name}}", "{", "{}", "{stem.x}"])
def test_a_template_that_makes_no_name_is_refused(here: Path, template: str) -> None:
    """One line and exit code 2, before any work."""
    made = isocore(here, "s1/T1.nii.gz", "-d", "out", "--name", template)
    assert made.returncode == 2 and made.stderr.count("\n") == 1 and f"--name {template}" in made.stderr
    assert not (here / "out").exists()


def test_numbers_of_volumes_take_digits(here: Path) -> None:
    """So that files sort; a file with one volume has none."""
    import numpy as np

    write_nifti(here / "series.nii", np.stack([ball(), ball(radius=3)], axis=3))
    arguments = ("--volume", "all", "-d", "out", "--name", "{stem}_{volume:03}")
    names = ["out/series_000.ply", "out/series_001.ply", "out/T1_.ply"]
    assert planned("series.nii", "s1/T1.nii.gz", *arguments) == names


def test_every_field_makes_a_name(here: Path) -> None:
    """Those that the message lists."""
    for field in NAME_FIELDS:
        check_template(f"a{{{field}}}")
        assert len(planned("s1/T1.nii.gz", "-d", "out", "--name", f"a{{{field}}}")) == 1


# Lists


@pytest.mark.parametrize(
    ("data", "more"),
    [
        (b"s1/T1.nii.gz\ns2/T1.nii.gz\n", ()),
        (b"s1/T1.nii.gz\r\n\r\ns2/T1.nii.gz", ()),
        (b"s1/T1.nii.gz\0s2/T1.nii.gz\0", ("-0",)),
        (b"s1/T1.nii.gz\0s2/T1.nii.gz", ("--null",)),
        (b"\xef\xbb\xbfs1/T1.nii.gz\ns2/T1.nii.gz\n", ()),
        ("s1/T1.nii.gz\r\ns2/T1.nii.gz\r\n".encode("utf-16"), ()),
    ],
)
def test_a_list_is_read_however_it_was_written(here: Path, data: bytes, more: tuple[str, ...]) -> None:
    """Ends of lines of any system, NUL on request, byte order marks; from a file and from stdin."""
    (here / "list").write_bytes(data)
    arguments = ("-d", "out", "--name", "{relpath}", "--dry-run", *more, "--files-from")
    with (here / "list").open("rb") as opened:
        found = [isocore(here, *arguments, "list"), isocore(here, *arguments, "-", stdin=opened)]
    for made in found:
        assert made.returncode == 0 and [line.split(" ")[0] for line in made.stdout.splitlines()] == [
            "s1/T1.nii.gz",
            "s2/T1.nii.gz",
        ]


def test_a_list_holds_any_name(here: Path) -> None:
    """Names that are not UTF-8, with spaces around, with a line break, and with what only Python takes for one."""
    names = [b"M\xfcller.nii", b" a b .nii", "a\u2028b\x0c.nii".encode()]
    for name in (*names, b"c\nd.nii"):
        shutil.copy(b"s1/T1.nii.gz", name + b".gz")
    (here / "list").write_bytes(b"".join(name + b".gz\n" for name in names))
    made = isocore(here, "--files-from", "list", "-d", "out", *FAST)
    assert made.returncode == 0
    assert {os.fsencode(name) for name in files_in(here / "out")} == {name[:-4] + b".ply" for name in names}
    (here / "list").write_bytes(b"c\nd.nii.gz\0")
    assert isocore(here, "--files-from", "list", "-0", "-d", "out", *FAST).returncode == 0
    assert (here / "out" / "c\nd.ply").is_file()


@pytest.mark.parametrize(
    ("data", "told"),
    [(b"a\0b.nii\n", "give -0"), (b"", "names no file"), (b"\n \n", "names no file"), (b"\xff\xfea", "UTF-16")],
)
def test_a_list_that_makes_no_sense_is_refused(here: Path, data: bytes, told: str) -> None:
    """One line and exit code 2; so is a list that is not there."""
    (here / "list").write_bytes(data)
    made = isocore(here, "--files-from", "list", "-d", "out")
    assert made.returncode == 2 and told in made.stderr and "Traceback" not in made.stderr
    assert isocore(here, "--files-from", "none", "-d", "out").returncode == 2


# Folders


def test_a_folder_that_cannot_be_searched_is_a_failed_row(here: Path) -> None:
    """Exit code 1, a message, and the rest converted; in the report, on a dry run and not in the depfile."""
    before: list[str] = []
    if os.geteuid() == 0:
        if shutil.which("setpriv") is None:
            pytest.skip("runs as root and has no setpriv to drop root's right to read everything")
        before = ["setpriv", "--bounding-set=-all", "--inh-caps=-all"]
    (here / "s2" / "deep").chmod(0)
    arguments = (".", "-d", "out", "-i", 50, "-i", 60, "-b", "mc", "-q")
    try:
        made = isocore(here, *arguments, "--report", "r.json", "--depfile", "deps", before=before)
        dry = isocore(here, *arguments, "--dry-run", before=before)
        whole = isocore(here, "s2/deep", *FAST, "-d", "out", before=before)
    finally:
        (here / "s2" / "deep").chmod(0o755)
    assert made.returncode == 1
    assert made.stderr.startswith("isocore: s2/deep: this folder cannot be searched (Permission denied); check its")
    assert made.stderr.count("\n") == 1
    assert files_in(here / "out") == ["s1/T1_50.ply", "s1/T1_60.ply", "s2/T1_50.ply", "s2/T1_60.ply"]
    rows = json.loads((here / "r.json").read_text())["outputs"]
    assert [(row["source"], row["output"]) for row in rows if row["status"] == "failed"] == [("s2/deep", "out/s2/deep")]
    assert "deep" not in (here / "deps").read_text()
    assert "fail: s2/deep: this folder cannot be searched" in dry.stdout
    assert whole.returncode == 1 and "s2/deep: this folder cannot be searched" in whole.stderr


def test_links_are_followed_once_and_never_in_circles(here: Path) -> None:
    """A folder behind a link is searched, unless it was or the link leads up; a link to nothing is a row."""
    for name in ("root/real", "elsewhere"):
        (here / name).mkdir(parents=True)
    for name in ("root/a.nii", "root/real/b.nii", "elsewhere/c.nii"):
        write_nifti(here / name, ball())
    links = {"again": "real", "up": "..", "here": ".", "out": "../elsewhere"}
    for name, to in (links | {"lost.nii": "nothing", "self.nii": "self.nii"}).items():
        (here / "root" / name).symlink_to(to)
    (here / "elsewhere" / "back").symlink_to("../root")
    found = [str(item.path.relative_to(here)) for item in find_inputs([here / "root"])]
    assert found == ["root/a.nii", "root/lost.nii", "root/self.nii", "root/real/b.nii", "root/out/c.nii"]
    made = isocore(here, "root", "-d", "made", *FAST)
    assert made.returncode == 1 and made.stderr.count("\n") == 2
    assert "lost.nii" in made.stderr and "self.nii" in made.stderr
    assert files_in(here / "made") == ["a.ply", "out/c.ply", "real/b.ply"]


def test_a_name_is_an_input_once_and_every_link_is_one(here: Path) -> None:
    """However often and however it is named; links to one file, or to nothing, are inputs of their own."""
    (here / "s1" / "same.nii.gz").symlink_to("T1.nii.gz")
    (here / "s1" / "lost1.nii").symlink_to("nowhere")
    (here / "s1" / "lost2.nii").symlink_to("nowhere")
    (here / "way").symlink_to("s1")
    named = ["s1/T1.nii.gz", "s1", "./s1/T1.nii.gz", str(here / "s1"), "s2/../s1", "way", "way/T1.nii.gz"]
    found = [str(item.path) for item in find_inputs(map(Path, named))]
    assert found == ["s1/T1.nii.gz", "s1/lost1.nii", "s1/lost2.nii", "s1/same.nii.gz"]


# Overwriting


@pytest.fixture
def family(here: Path) -> Path:
    """Inputs of several files: a sidecar, a header's data, an image; and links to them."""
    (here / "s.raw").write_bytes(bytes(range(250)) * 4)
    (here / "s.raw.json").write_text('{"shape": [10, 10, 10], "dtype": "uint8"}')
    (here / "d.bin").write_bytes(ball().tobytes(order="F"))
    header = "NRRD0004\ntype: float\ndimension: 3\nsizes: 12 12 12\nencoding: raw\nendian: little\ndata file: d.bin\n"
    (here / "h.nhdr").write_text(header)
    (here / "link.json").symlink_to("s.raw.json")
    (here / "folder").symlink_to(".")
    (here / "list").write_text("s.raw\n")
    return here


@pytest.mark.parametrize(
    "arguments",
    [
        ("s.raw", "-o", "x.ply", "--report", "s.raw.json"),
        ("s.raw", "-o", "x.ply", "--report", "link.json"),
        ("s.raw", "-o", "x.ply", "--report", "folder/s1/../s.raw.json"),
        ("s.raw", "-o", "x.ply", "--depfile", "s.raw"),
        ("s.raw", "-o", "x.ply", "--ambiguities", "./s.raw"),
        ("s.raw", "-o", "s.raw", "-f", "ply"),
        ("s.raw", "-o", "folder/s.raw.json", "-f", "ply"),
        ("h.nhdr", "-o", "d.bin", "-f", "ply"),
        ("h.nhdr", "-o", "x.ply", "--depfile", "d.bin"),
        ("h.nhdr", "s.raw", "-d", "out", "--report", "folder/s.raw.json"),
        ("s.raw", "-o", "r.json", "-f", "ply", "--report", "r.json"),
        ("s.raw", "-o", "x.ply", "--ambiguities", "x.ply"),
        ("s.raw", "-o", "new/x.ply", "--ambiguities", "folder/new/./x.ply"),
        ("s.raw", "-o", "x.ply", "--report", "r.json", "--report", "./r.json"),
        ("s.raw", "-o", "x.ply", "--report", "r.json", "--depfile", "r.json"),
        ("s.raw", "-o", "x.ply", "--depfile", "a", "--ambiguities", "a"),
        ("--files-from", "list", "-o", "x.ply", "--depfile", "list"),
        ("s.raw", "s1/T1.nii.gz", "-d", "out", "--name", "{stem}", "--report", "out/s.json", "--depfile", "out/T1.ply"),
    ],
)
def test_what_would_overwrite_anything_is_refused_before_any_work(family: Path, arguments: tuple[str, ...]) -> None:
    """Exit code 2, one line, and every file as it was."""
    before = {name: (family / name).read_bytes() for name in files_in(family)}
    made = isocore(family, *arguments, "-i", 50)
    assert made.returncode == 2 and made.stderr.count("\n") == 1 and "choose another" in made.stderr
    assert {name: (family / name).read_bytes() for name in files_in(family)} == before


def test_what_is_not_overwritten_is_not_refused(family: Path) -> None:
    """Outputs of an earlier run, a hard link beside an output, and devices, however often."""
    arguments = ("s.raw", "-o", "x.ply", "--report", "r.json", "--depfile", "deps", "--ambiguities", "a.ply", *FAST)
    for _ in range(2):
        assert isocore(family, *arguments).returncode == 0
    os.link(family / "s.raw", family / "y.ply")
    assert isocore(family, "s.raw", "-o", "y.ply", *FAST).returncode == 0
    assert (family / "s.raw").read_bytes() == bytes(range(250)) * 4
    nowhere = ("--depfile", "/dev/null", "--ambiguities", "/dev/null")
    assert isocore(family, "s.raw", "-o", "x.ply", *nowhere).returncode == 0


def test_names_that_differ_in_case_are_one_where_the_file_system_says_so(
    here: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Known by looking up what is there under its other spelling; also composed and decomposed letters."""
    assert ignores_case(here) == (here / "S1").exists()
    for ignoring in (True, False):
        monkeypatch.setattr(places, "ignores_case", lambda folder, ignoring=ignoring: ignoring)
        held = Places()
        assert held.take(here / "new" / "Ä.ply", "one") is None
        assert held.take(here / "new" / "a\u0308.PLY", "two") == ("one" if ignoring else None)
        assert held.take(here / "new" / "b.ply", "three") is None
        assert held.take(here / "new" / "Ä.ply", "four") == "one"


@pytest.mark.parametrize("targets", [("a.json",), ("./a.json",), ("x.csv", "folder/x.csv")])
def test_isocore_report_overwrites_no_report_that_it_reads(family: Path, targets: tuple[str, ...]) -> None:
    """Nor one of its own."""
    for name in ("a.json", "b.json"):
        assert isocore(family, "s.raw", "-o", "x.ply", "--report", name, *FAST).returncode == 0
    before = (family / "a.json").read_bytes()
    words = [*PROGRAM[:-1], "report", "a.json", "b.json", *(word for path in targets for word in ("--to", path))]
    made = subprocess.run(words, cwd=family, capture_output=True, text=True, timeout=60, check=False)
    assert made.returncode == 2 and "choose another" in made.stderr
    assert (family / "a.json").read_bytes() == before and not (family / "x.csv").exists()


@pytest.mark.parametrize("named", [("--csv", "s1/T1.nii.gz"), ("--csv", "x", "--plot", "folder/x")])
def test_isocore_bench_overwrites_no_volume(family: Path, named: tuple[str, ...]) -> None:
    """Nor one of its own tables by another."""
    before = (family / "s1/T1.nii.gz").read_bytes()
    words = [*PROGRAM[:-1], "bench", "s1/T1.nii.gz", *named]
    made = subprocess.run(words, cwd=family, capture_output=True, text=True, timeout=60, check=False)
    assert made.returncode == 2 and "choose another" in made.stderr and not (family / "x").exists()
    assert (family / "s1/T1.nii.gz").read_bytes() == before


@pytest.mark.parametrize(
    ("fault", "more"),
    [("times_of", ()), ("count_volumes", ("--volume", "all")), ("label_choices", ("--labels", "all"))],
)
def test_what_nobody_foresaw_while_planning_costs_one_row(
    here: Path, monkeypatch: pytest.MonkeyPatch, fault: str, more: tuple[str, ...]
) -> None:
    """The others are planned as ever; the file is converted, or a row says the type of the error."""
    from isocore.batches import label_targets, plan

    module = label_targets if fault == "label_choices" else plan
    true = getattr(module, fault)

    def faulty(path: Path, *arguments: object) -> object:
        if path.parent.name == "s1":
            raise LookupError("odd")
        return true(path, *arguments)

    monkeypatch.setattr(module, fault, faulty)
    result = CliRunner().invoke(convert, ["s1", "s2", "-d", "out", "--name", "{relpath}", "--dry-run", *more])
    lines = result.stdout.splitlines()
    assert result.exit_code == 0 and len(lines) >= 3 and not any("out/s1" in line for line in lines[1:])
    told = "fail: s1/T1.nii.gz: internal error (LookupError: odd); please report it"
    assert lines[0] == told if fault == "label_choices" else lines[0].startswith("s1/T1.nii.gz -> out/s1/T1.ply")
