"""What --help says, in groups; the man pages from the same texts; and what a shell is told when it completes."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path
from typing import get_args

import click
import pytest
from click.shell_completion import get_completion_class
from click.testing import CliRunner
from isocore.cli.completion import SHELLS, VARIABLE
from isocore.cli.groups import GROUPS, GroupedOption, sections_of
from isocore.cli.main import COMMANDS, EXIT_CODES, main
from isocore.cli.main import isocore as program
from man_pages import man_pages

from isocore import choices
from isocore.backends import BACKENDS
from isocore.volume import Space

CONTEXT = click.Context(program, info_name="isocore", **program.context_settings)
#: Options that do nothing, or write nothing, unless they are given.
WITHOUT_DEFAULT = {
    "--files-from", "--shape", "--dtype", "--component", "--output", "--ambiguities", "--scheduler", "--depfile",
    "--report", "--require", "--csv", "--markdown", "--plot", "--to", "--fail-if",
}  # fmt: skip


def command(name: str) -> tuple[click.Command, click.Context]:
    found = program.get_command(CONTEXT, name)
    assert found is not None
    return found, click.Context(found, info_name=name, parent=CONTEXT)


def options(name: str) -> list[click.Option]:
    found, context = command(name)
    return [one for one in found.get_params(context) if isinstance(one, click.Option)]


def test_converts_help_has_groups_in_the_order_of_the_work() -> None:
    """From the input to the report, every option in one of them, and only --help beside them."""
    text = CliRunner().invoke(program, ["convert", "--help"]).output
    titles = re.findall(r"^(\w+) options:$", text, re.MULTILINE)
    assert titles == [*GROUPS, "Other"]
    ungrouped = [one for one in options("convert") if not isinstance(one, GroupedOption)]
    assert [one.opts[-1] for one in ungrouped] == ["--help"]
    for option, group in (("--shape", "Input"), ("--max-error", "Method"), ("--if-changed", "Batch")):
        after = text.split(f"{group} options:")[1].split(" options:")[0]
        assert re.search(rf"^  {option} ", after, re.MULTILINE)


@pytest.mark.parametrize("name", COMMANDS)
def test_every_option_says_its_values_and_its_default(name: str) -> None:
    """A sentence for all; for one that takes a value its form, and the default or what it is without."""
    _, context = command(name)
    for option in options(name):
        names, text = option.get_help_record(context) or ("", "")
        sentence, _, default = text.partition("  [default: ")
        assert sentence.endswith("."), f"{names}: {text}"
        if not option.is_flag:
            assert len(names.split()) > len(option.opts), f"{names}: takes a value of no form"
        if option.secondary_opts or not (option.is_flag or option.opts[-1] in WITHOUT_DEFAULT):
            assert default and not default.startswith("("), f"{names}: {text}"


def test_the_names_in_the_help_are_those_of_the_tables() -> None:
    """Which it does not import, to be quick."""
    assert ("auto", *BACKENDS) == choices.BACKEND_NAMES
    assert set(choices.SPACES) == set(get_args(Space))


def test_help_ends_with_the_exit_codes() -> None:
    """Of all commands, below the list of them."""
    text = CliRunner().invoke(program, ["--help"]).output
    for code, meaning in EXIT_CODES.items():
        assert re.search(rf"^  {code} +{meaning}$", text, re.MULTILINE)


@pytest.mark.parametrize("space", ["RAS", "Lps", "index"])
def test_a_word_is_taken_in_any_case(space: str) -> None:
    """As the field writes the names of its spaces."""
    (option,) = [one for one in options("convert") if one.name == "space"]
    assert option.type_cast_value(CONTEXT, space) == space.lower()


@pytest.mark.parametrize("name", ["", *COMMANDS])
def test_a_man_page_says_what_the_help_says(name: str) -> None:
    """Every option with its text, and roff finds nothing to complain about."""
    page = man_pages()[f"isocore-{name}.1" if name else "isocore.1"]
    found, context = command(name) if name else (program, CONTEXT)
    for _, parameters in sections_of(found, context):
        for option in parameters:
            names, text = option.get_help_record(context) or ("", "")
            for part in (names, " ".join(text.split())):
                assert part.replace("-", "\\-").replace("'", "\\(aq").replace("`", "\\(ga") in page
    assert ".SH EXIT STATUS" in page and ".SH EXAMPLES" in page
    if groff := shutil.which("groff"):
        shown = subprocess.run([groff, "-man", "-Tascii", "-ww", "-z"], input=page, capture_output=True, text=True)
        assert shown.returncode == 0 and not shown.stderr


def test_man_pages_are_made_without_numpy_or_compiled_modules(tmp_path: Path) -> None:
    """As when a wheel is built: from the source folder, with click alone."""
    root = Path(__file__).resolve().parent.parent
    script = root / "docs" / "man_pages.py"
    made = []
    for missing in (["numpy", "rich", "isocore._kernels"], []):
        folder = tmp_path / ("without" if missing else "with")
        code = (
            f"import sys, runpy; sys.modules |= dict.fromkeys({missing!r})\n"
            f"sys.argv = ['', {str(folder)!r}]; runpy.run_path({str(script)!r}, run_name='__main__')"
        )
        folder.mkdir()
        done = subprocess.run([sys.executable, "-P", "-c", code], capture_output=True, text=True, cwd=tmp_path)
        assert done.returncode == 0, done.stderr
        made.append({path.name: path.read_text(encoding="utf-8") for path in folder.iterdir()})
    assert made[0] == made[1] and set(made[0]) == set(man_pages())


def completed(shell: str, words: tuple[str, ...], patch: pytest.MonkeyPatch) -> list[str]:
    """What a shell is told when the last word is to be completed."""
    patch.setenv("COMP_WORDS", " ".join(["isocore", *words]))
    patch.setenv("COMP_CWORD", words[-1] if shell == "fish" else str(len(words)))
    found = get_completion_class(shell)
    assert found is not None
    return found(program, {}, "isocore", VARIABLE).complete().split()


@pytest.mark.parametrize("shell", SHELLS)
def test_a_shell_completes_commands_options_and_values(shell: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Also words that are only some of an option's values."""
    answers = {
        ("con",): "convert",
        ("convert", "--max-"): "--max-error",
        ("convert", "--space", "l"): "lps",
        ("convert", "-b", "th"): "thinning",
        ("convert", "-i", "o"): "otsu",
        ("convert", "--require", "manifold,non"): "manifold,nonempty",
        ("completion", "z"): "zsh",
    }
    for words, answer in answers.items():
        found = [word.removeprefix("plain,") for word in completed(shell, words, monkeypatch)]
        assert answer in found, f"{words}: {found}"


@pytest.mark.skipif(not shutil.which("bash"), reason="there is no bash")
def test_bash_completes_by_the_printed_script(tmp_path: Path) -> None:
    """In a real bash, with a program of that name on the path."""
    (tmp_path / "isocore").write_text(
        f"#!{sys.executable} -P\nfrom isocore.cli.main import main\nmain()\n", encoding="utf-8"
    )
    (tmp_path / "isocore").chmod(0o755)
    script = CliRunner().invoke(program, ["completion", "bash"]).output
    ask = "COMP_WORDS=(isocore convert --topo); COMP_CWORD=2; _isocore_completion isocore; echo \"${COMPREPLY[@]}\""
    done = subprocess.run(
        ["bash", "--norc", "-c", f"{script}\n{ask}"],
        env=os.environ | {"PATH": f"{tmp_path}:{os.environ['PATH']}"},
        capture_output=True,
        text=True,
    )
    assert done.stdout.split() == ["--topology"] and not done.stderr


@pytest.mark.parametrize(
    ("shell", "place"),
    [
        ("bash", ".local/share/bash-completion/completions/isocore"),
        ("zsh", ".zfunc/_isocore"),
        ("fish", ".config/fish/completions/isocore.fish"),
    ],
)
def test_completion_is_installed_where_the_shell_looks(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, shell: str, place: str
) -> None:
    """The very script that is printed without --install, and the place is said."""
    monkeypatch.setenv("HOME", str(tmp_path))
    for name in ("XDG_DATA_HOME", "XDG_CONFIG_HOME"):
        monkeypatch.delenv(name, raising=False)
    printed = CliRunner().invoke(program, ["completion", shell]).output
    done = CliRunner().invoke(program, ["completion", shell, "--install"])
    assert done.exit_code == 0 and done.output.startswith(f"{tmp_path / place}: ")
    assert (tmp_path / place).read_text() == printed and VARIABLE in printed


def test_the_frames_of_all_calls_fit_the_piece_of_memory_of_the_first() -> None:
    """Else CPython asks the system for 16 KB and gives them back, thousands of times while modules are imported."""
    assert 8 * main.__code__.co_stacksize >= 8 * 16 * 1024
