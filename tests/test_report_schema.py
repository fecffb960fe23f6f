"""Damaged reports and stamps: every value is checked where it is loaded, and nothing after that meets a wrong type."""

from __future__ import annotations

import copy
import json
import random
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner, Result
from isocore.cli.convert import convert
from isocore.cli.report import report
from shapes import SAMPLES
from small_files import ball, write_nifti

from isocore.batches.stamps import reason_to_run, stamp_path
from isocore.errors import InputError
from isocore.job import Job, Target
from isocore.report import RENDERERS, BatchReport, load_report, merged, save_report
from isocore.report.compare import compared, comparison_rows, faults
from isocore.report.keys import run_as_dict, run_from_dict
from isocore.report.limits import parse_limit
from isocore.report.schema import parsed
from isocore.report.summary import summary_row

IDENTITY: dict[str, Any] = {"source": "a.nii", "output": "b.ply", "status": "done"}
#: What a value may become.
ODD = (None, True, 0, -1, 3.5, 1e300, 2**70, 10**400, "", "x\x1b\n", "\ud800", [], [None], ["a"], {}, {"a": [1]})
LIMITS = [parse_limit(text) for text in ("triangles>+2%", "seconds>1", "error.max<-5%", "surface.watertight<1")]


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """A report with every section, of a volume and of a mesh, and a failed run."""
    folder = tmp_path_factory.mktemp("schema")
    scan = write_nifti(folder / "ball.nii", ball(8))
    (folder / "bad.nii").write_bytes(b"junk")
    outputs = []
    for source, isovalue in ((scan, 50), (SAMPLES / "torus.vtu", 0.1), (folder / "bad.nii", 1)):
        words = [source, "-i", isovalue, "-d", folder, "--report", folder / "r.json", "-q", "--max-triangles", 3]
        CliRunner().invoke(convert, [str(word) for word in words])
        whole: dict[str, Any] = json.loads((folder / "r.json").read_text())
        outputs += whole["outputs"]
    return whole | {"outputs": outputs}


def loaded(folder: Path, whole: Any) -> BatchReport:
    (folder / "x.json").write_text(json.dumps(whole))
    return load_report(folder / "x.json")


def used(batch: BatchReport, folder: Path) -> None:
    """Everything that is done with a report."""
    for suffix in RENDERERS:
        save_report(batch, folder / f"y{suffix}")
    save_report(batch, folder / "bench.json")
    comparison_rows(compared(batch, batch))
    faults(compared(batch, batch), LIMITS)
    merged([batch, batch])
    again = load_report(folder / "y.json")
    assert [run_as_dict(run) for run in again.outputs] == [run_as_dict(run) for run in batch.outputs]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"isovalue": "x"}, 'outputs[0].isovalue is "x", which is not a number'),
        ({"isovalue": True}, "outputs[0].isovalue is true, which is not a number"),
        ({"isovalue": 10**400}, "outputs[0].isovalue is 1000000000000000000000000000000000000000..., which is not a"),
        ({"surface": [1]}, "outputs[0].surface is [1], which is not an object"),
        ({"surface": {"triangles": "many"}}, 'outputs[0].surface.triangles is "many", which is not a whole number'),
        ({"surface": {"triangles": 2**63}}, "outputs[0].surface.triangles is 9223372036854775808, which is not a"),
        ({"surface": {"watertight": 1}}, "outputs[0].surface.watertight is 1, which is not true or false"),
        ({"surface": {"bounds": [[0, 0, 0]]}}, "outputs[0].surface.bounds is [[0, 0, 0]], which is not a list of 2"),
        ({"surface": {"bounds": [[0, 0, 0], [0, "1", 0]]}}, 'outputs[0].surface.bounds[1][1] is "1", which is not'),
        ({"warnings": ["a", 5]}, "outputs[0].warnings[1] is 5, which is not a text"),
        ({"status": "ok"}, 'outputs[0].status is "ok", which is not one of done, empty, skipped, failed'),
        ({"status": None}, "lacks outputs[0].status"),
        ({"source": None}, "lacks outputs[0].source"),
        ({"facts": [1]}, "outputs[0].facts is [1], which is not an object"),
        ({"facts": {"a": {"b": 2**64}}}, 'outputs[0].facts."a"."b" is 18446744073709551616, which is not'),
        ({"kind": "mesh", "histogram": {"counts": 3}}, "outputs[0].histogram.counts is 3, which is not a list"),
    ],
)
def test_a_value_of_the_wrong_type_is_named_with_its_place(
    tmp_path: Path, change: dict[str, Any], message: str
) -> None:
    """One line: the file, the key, what it is and what it should be."""
    with pytest.raises(InputError) as caught:
        loaded(tmp_path, {"schema": 1, "outputs": [IDENTITY | change]})
    assert str(caught.value).startswith(f"{tmp_path / 'x.json'}: {message}") and "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('{"schema": 1, "outputs": [], "arguments": [NaN]}', "is not JSON (NaN is no number of JSON)"),
        ('{"schema": 1, "outputs": [], "totals": {"seconds": 1e999}}', "totals.seconds is Infinity, which is not a"),
        ('{"schema": 1, "outputs": {}}', "lacks outputs, a list"),
        ('{"schema": 1, "outputs": [7]}', "outputs[0] is 7, which is not an object"),
        ('{"schema": 1, "outputs": [], "tool": 5}', "tool is 5, which is not an object"),
        ('{"schema": true, "outputs": []}', "is not a report of schema 1"),
        ("[" * 100_000, "is nested too deeply"),
        ('{"schema": 1, "outputs": ' + "1" * 5000 + "}", "is not JSON (Exceeds the limit"),
        ('{"schema": 1, "outputs": [], "host": ' + '{"a": ' * 20 + "1" + "}" * 21, "is nested too deeply"),
        ("\ufeff[]", "is not a report of schema 1"),
        ("\x00\x01", "is not JSON"),
    ],
    ids=lambda part: part[:30].encode("unicode_escape").decode(),
)
def test_what_is_no_report_is_said_in_one_line(tmp_path: Path, text: str, message: str) -> None:
    """Whatever it is."""
    (tmp_path / "x.json").write_text(text, encoding="utf-8")
    result = CliRunner().invoke(report, [str(tmp_path / "x.json")])
    assert isinstance(result.exception, InputError) and str(result.exception).isprintable()
    assert message in str(result.exception) and str(result.exception).startswith(str(tmp_path / "x.json"))


def places(value: Any, way: tuple[str | int, ...] = ()) -> Iterator[tuple[str | int, ...]]:
    """The way to every value inside, the whole first."""
    yield way
    if isinstance(value, (dict, list)):
        for key, item in value.items() if isinstance(value, dict) else enumerate(value):
            yield from places(item, (*way, key))


def mutated(value: Any, dice: random.Random) -> Any:
    """A copy in which a few values are odd, gone, moved, or twice as many."""
    changed = {"whole": copy.deepcopy(value)}
    for _ in range(dice.choice((1, 1, 1, 2, 4))):
        way = dice.choice(list(places(changed["whole"])))
        *before, last = ("whole", *way)
        holder: Any = changed
        for key in before:
            holder = holder[key]
        kind = dice.random()
        if kind < 0.7:
            holder[last] = copy.deepcopy(dice.choice(ODD))
        elif kind < 0.85 and before:
            del holder[last]
        elif isinstance(holder, list):
            holder.append(copy.deepcopy(holder[last]))
        elif isinstance(holder, dict):
            holder[dice.choice([*holder, "other"])] = copy.deepcopy(holder[last])
    return changed["whole"]


def test_a_damaged_report_is_refused_or_of_use_in_every_format(tmp_path: Path, written: dict[str, Any]) -> None:
    """Mutations by structure: an InputError of one line, or records that all renderers take."""
    dice = random.Random(14)
    refused = 0
    for _ in range(400):
        whole = mutated(written, dice)
        try:
            batch = loaded(tmp_path, whole)
        except InputError as error:
            assert str(error).isprintable() and str(error).startswith(str(tmp_path / "x.json"))
            refused += 1
        else:
            used(batch, tmp_path)
    assert 100 < refused < 350


def test_each_key_of_each_record_is_checked(tmp_path: Path, written: dict[str, Any]) -> None:
    """An object of the wrong kind fits nowhere but where keys are free."""
    odd = {"a": {"b": 1}}
    for way in places(written):
        whole = copy.deepcopy(written)
        if not way or {"facts", "tool", "host", "totals"} & set(way):
            continue
        holder = whole
        for key in way[:-1]:
            holder = holder[key]
        if holder[way[-1]] is None or isinstance(holder[way[-1]], dict):
            continue
        holder[way[-1]] = odd
        with pytest.raises(InputError):
            loaded(tmp_path, whole)


def test_numbers_of_another_writer_are_taken(tmp_path: Path) -> None:
    """50 for 50.0 and 3.0 for 3; a mark of byte order before it all."""
    record = IDENTITY | {"isovalue": 50, "surface": {"triangles": 3.0}}
    (tmp_path / "x.json").write_text("\ufeff" + json.dumps({"schema": 1, "outputs": [record]}), encoding="utf-8")
    (run,) = load_report(tmp_path / "x.json").outputs
    assert run.isovalue == 50.0 and isinstance(run.isovalue, float)
    assert run.triangles == 3 and isinstance(run.triangles, int)


def test_a_report_does_not_become_of_this_program_and_machine(tmp_path: Path) -> None:
    """What it does not say stays unsaid."""
    batch = loaded(tmp_path, {"schema": 1, "outputs": [], "tool": None})
    assert batch.tool == {} and batch.host == {} and batch.arguments == () and batch.seconds == 0
    used(batch, tmp_path)


@pytest.mark.parametrize("complete", [False, True])
def test_a_record_comes_back_as_it_was(written: dict[str, Any], complete: bool) -> None:
    """Every key of every section."""
    for record in written["outputs"]:
        assert run_as_dict(run_from_dict(record, complete=complete)) == record


@pytest.mark.parametrize("key", ["message", "warnings", "bytes", "shape", "asked", "facts", "chosen"])
def test_a_complete_record_lacks_no_key(written: dict[str, Any], key: str) -> None:
    """One of this version is damaged without it; a report of another version is not."""
    record = {name: value for name, value in written["outputs"][0].items() if name != key}
    run_from_dict(record)
    with pytest.raises(InputError, match=f"lacks {key}"):
        run_from_dict(record, complete=True)


def stamped(tmp_path: Path) -> tuple[Path, Path]:
    """An output with its stamp."""
    source = write_nifti(tmp_path / "in" / "ball.nii", ball(8))
    assert if_changed(source).exit_code == 0
    return source, stamp_path(tmp_path / "out" / "ball.ply")


def if_changed(source: Path, *more: str) -> Result:
    folder = source.parent.parent
    words = [str(source.parent), "-i", "50", "-d", str(folder / "out"), "--report", str(folder / "r.json")]
    return CliRunner().invoke(convert, [*words, "--no-simplify", "--if-changed", *more])


def status(tmp_path: Path) -> str:
    (run,) = json.loads((tmp_path / "r.json").read_text())["outputs"]
    return str(run["status"])


def test_a_gate_does_not_pass_by_a_digit_lost_on_the_disk(tmp_path: Path) -> None:
    """The record in a stamp has its own hash; where that does not hold, the output is made again."""
    source, stamp = stamped(tmp_path)
    assert if_changed(source).exit_code == 0 and status(tmp_path) == "skipped"
    text = stamp.read_text()
    assert '"triangles": 96' in text
    stamp.write_text(text.replace('"triangles": 96', '"triangles": 6', 1))
    assert if_changed(source, "--max-triangles", "50").exit_code == 3 and status(tmp_path) == "done"
    assert if_changed(source, "--max-triangles", "50").exit_code == 3 and status(tmp_path) == "skipped"


def test_a_damaged_stamp_makes_its_output_again(tmp_path: Path) -> None:
    """Mutations by structure, and bytes that are no JSON: never an error, never another's record."""
    source, path = stamped(tmp_path)
    job = Job(source=source, targets=(Target("50", tmp_path / "out" / "ball.ply"),))
    whole = json.loads(path.read_text())
    assert reason_to_run(job, job.targets[0], whole["input"])[0] in ("", "options changed")
    dice = random.Random(8)
    for text in (b"", b"[]", b"7", b'"x"', b"null", b"{}", b"\xff", b"[" * 100_000, b'{"version": NaN}'):
        path.write_bytes(text)
        assert reason_to_run(job, job.targets[0], whole["input"])[1] is None
    for _ in range(600):
        changed = mutated(whole, dice)
        path.write_text(json.dumps(changed))
        reason, run = reason_to_run(job, job.targets[0], whole["input"])
        assert reason.isprintable() and (run is None or run_as_dict(run) == whole["run"])


def test_a_stamp_that_cannot_be_written_costs_a_warning(tmp_path: Path) -> None:
    """The output is there, and is made again the next time."""
    source, path = stamped(tmp_path)
    path.unlink()
    path.mkdir()
    result = if_changed(source)
    assert result.exit_code == 0 and status(tmp_path) == "done"
    assert f"{path.name}: is a folder" in result.stderr and "makes the output again" in result.stderr


def test_parsing_is_strict() -> None:
    """What Python alone takes for JSON is none."""
    for text in ("NaN", "[Infinity]", "{'a': 1}", "[1,]", "", "\x00"):
        with pytest.raises(InputError):
            parsed(text)


def test_an_end_of_a_range_may_be_null(written: dict[str, Any], tmp_path: Path) -> None:
    """JSON has no infinities, so that a report says null; the isovalue that was chosen is shown all the same."""
    whole = copy.deepcopy(written)
    whole["outputs"][0] |= {"range": [None, 7.0], "isovalue": 2.5, "chosen": "Otsu's threshold"}
    batch = loaded(tmp_path, whole)
    for suffix, render in RENDERERS.items():
        assert render(batch) is not None, suffix
    assert summary_row(batch.outputs[0], "a")[1] == "2.5"


def test_colours_without_a_map_leave_the_page_without_them(tmp_path: Path) -> None:
    """As a report says that was cut, or written by another version."""
    batch = loaded(tmp_path, {"schema": 1, "outputs": [IDENTITY | {"colors": {"source": None}}]})
    used(batch, tmp_path)
