"""`isocore completion`: what makes a shell complete isocore's commands, options and their values."""

from __future__ import annotations

import os
from pathlib import Path

import click
from click.shell_completion import ShellComplete, get_completion_class

from .groups import GroupedCommand

SHELLS = ("bash", "zsh", "fish")
#: The variable by which a shell asks for words; click derives it from the program's name.
VARIABLE = "_ISOCORE_COMPLETE"


@click.command(cls=GroupedCommand, short_help="What makes a shell complete isocore's commands and options.")
@click.argument("shell", type=click.Choice(SHELLS))
@click.option("--install", is_flag=True, help="Write it where the shell looks for it, and say where that is.")
def completion(shell: str, install: bool) -> None:
    """Print a script that makes SHELL (bash, zsh or fish) complete commands, options and their values, or install it.

    \b
    isocore completion bash --install
    eval "$(isocore completion zsh)"         # in ~/.zshrc, after compinit
    isocore completion fish | source
    """
    script = script_of(shell)
    if not install:
        click.echo(script)
        return
    from isocore.whole_file import whole_file

    target, advice = place_of(shell)
    with whole_file(target) as stream:
        stream.write(f"{script}\n".encode())
    click.echo(f"{target}: {advice}")


def script_of(shell: str) -> str:
    """The script, without asking whether the shell is there; it calls isocore for the words."""
    from .main import isocore

    found = get_completion_class(shell)
    assert found is not None, f"click knows {shell}"
    return ShellComplete.source(found(isocore, {}, "isocore", VARIABLE)).strip()


def place_of(shell: str) -> tuple[Path, str]:
    """Where this user's shell looks for scripts, and what remains to be done."""
    home = Path.home()
    if shell == "bash":
        data = Path(os.environ.get("XDG_DATA_HOME") or home / ".local" / "share")
        return data / "bash-completion" / "completions" / "isocore", "bash loads it from its next start on"
    if shell == "fish":
        config = Path(os.environ.get("XDG_CONFIG_HOME") or home / ".config")
        return config / "fish" / "completions" / "isocore.fish", "fish loads it from its next start on"
    target = home / ".zfunc" / "_isocore"
    return target, "put `fpath+=~/.zfunc; autoload -Uz compinit; compinit` at the end of ~/.zshrc"
