"""The man pages, from the texts of --help: one for isocore and one for each command.

Building the wheel runs `python docs/man_pages.py FOLDER`; it needs click, and nothing that is compiled.
"""

from __future__ import annotations

import re
import sys
from pathlib import Path

import click

ROOT = Path(__file__).resolve().parent.parent


def man_pages() -> dict[str, str]:
    """The pages by their files' names."""
    from isocore.cli.main import COMMANDS, EXIT_CODES, isocore

    context = click.Context(isocore, info_name="isocore", **isocore.context_settings)
    about = {"isocore": "volumes and meshes to isosurfaces, many files at a time"}
    about |= {f"isocore-{name}": text for name, text in COMMANDS.items()}
    commands = [("COMMANDS", [(f"isocore {name}", text) for name, text in COMMANDS.items()])]
    codes = ("EXIT STATUS", [(str(code), meaning) for code, meaning in EXIT_CODES.items()])
    made = {"isocore.1": page(isocore, context, about, commands, codes)}
    for name in COMMANDS:
        command = isocore.get_command(context, name)
        assert command is not None, name
        inner = click.Context(command, info_name=name, parent=context)
        made[f"isocore-{name}.1"] = page(command, inner, about, [], codes)
    return made


Section = tuple[str, list[tuple[str, str]]]


def page(
    command: click.Command, context: click.Context, about: dict[str, str], further: list[Section], codes: Section
) -> str:
    """One page. about: of every page what it is for; further: sections before the options."""
    from isocore.cli.groups import sections_of

    from isocore.version import __version__

    name = context.command_path.replace(" ", "-")
    text, examples = described(command)
    pieces = " ".join(command.collect_usage_pieces(context))
    lines = [f'.TH {name.upper()} 1 "" "isocore {__version__}" "User Commands"']
    lines += [".SH NAME", f"{name} \\- {roff(about[name])}"]
    lines += [".SH SYNOPSIS", f".B {roff(context.command_path)}", roff(pieces)]
    lines += [".SH DESCRIPTION", roff(text)]
    for title, items in [*further, *options(sections_of(command, context), context), codes]:
        lines.append(f".SH {roff(title.upper())}")
        for head, body in items:
            lines += [".TP", f"\\fB{roff(head)}\\fR", roff(body)]
    lines += [".SH EXAMPLES", ".nf", *map(roff, examples), ".fi"]
    lines += [".SH SEE ALSO", ", ".join(f"\\fB{roff(other)}\\fR(1)" for other in about if other != name)]
    return "\n".join(lines) + "\n"


def described(command: click.Command) -> tuple[str, list[str]]:
    """A command's text, and the commands to try that stand in it on lines of their own."""
    text, _, examples = (command.help or "").partition("\b")
    return " ".join(text.split()), [line.strip() for line in examples.splitlines() if line.strip()]


def options(sections: list[tuple[str, list[click.Parameter]]], context: click.Context) -> list[Section]:
    """The options with their values, texts and defaults, as --help has them."""
    found = []
    for title, parameters in sections:
        records = [record for one in parameters if (record := one.get_help_record(context)) is not None]
        found.append((title, [(names, " ".join(text.split())) for names, text in records]))
    return found


def roff(text: str) -> str:
    """A text as roff shows it: hyphens stay hyphens, and no line is taken for a request."""
    text = text.replace("\\", "\\e").replace("-", "\\-").replace("'", "\\(aq").replace("`", "\\(ga")
    return re.sub(r"^(?=\.)", r"\\&", text, flags=re.MULTILINE)


def main(folder: Path) -> None:
    """Write the pages."""
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in man_pages().items():
        (folder / name).write_text(text, encoding="utf-8")


if __name__ == "__main__":
    sys.path.insert(0, str(ROOT))
    import isocore

    # In the source folder the command line lies beside the package; installed, it is a part of it.
    isocore.__path__.append(str(ROOT))
    main(Path(sys.argv[1]))
