"""The group, and the only place that turns errors into exit codes."""

from __future__ import annotations

import os
import signal
import sys
from importlib import import_module
from types import FrameType

import click

from isocore.errors import IsocoreError, OptionError, printable

from .console import say, unarmed
from .names import speak_any_name

#: Each command is a file of its name, imported only when it is called or described.
COMMANDS = {
    "convert": "volumes and meshes to surfaces, one file or a whole folder",
    "info": "what a file holds, and which isovalues make sense",
    "index": "thin meshes now, and keep the index beside them",
    "bench": "the papers' tables on your own data",
    "report": "turn JSON reports into tables and CI formats; compare two",
    "completion": "what makes bash, zsh or fish complete commands and options",
}

FAILED, WRONG_COMMAND, MISSED, INTERRUPTED, TERMINATED = 1, 2, 3, 130, 143
#: What the codes mean, for people.
EXIT_CODES = {
    0: "all done, or up to date",
    FAILED: "some input failed",
    WRONG_COMMAND: "the command line is wrong",
    MISSED: "a requirement was missed",
    INTERRUPTED: "interrupted",
    TERMINATED: "terminated",
}


class Terminated(BaseException):
    """SIGTERM, as an exception that cleans up on its way out."""


class _LateGroup(click.Group):
    """A group that knows its commands' names and help before it imports them."""

    def list_commands(self, context: click.Context) -> list[str]:
        return list(COMMANDS)

    def get_command(self, context: click.Context, name: str) -> click.Command | None:
        if name not in COMMANDS:
            return None
        command: click.Command = getattr(import_module(f".{name}", __package__), name)
        return command

    def format_commands(self, context: click.Context, formatter: click.HelpFormatter) -> None:
        with formatter.section("Commands"):
            formatter.write_dl(list(COMMANDS.items()))
        with formatter.section("Exit codes"):
            formatter.write_dl([(str(code), meaning) for code, meaning in EXIT_CODES.items()])


def _show_version(context: click.Context, _: click.Parameter, wanted: bool) -> None:
    if wanted:
        from isocore import _kernels
        from isocore.version import __version__

        click.echo(f"isocore {__version__} (kernels: {_kernels.BUILD})")
        context.exit()


@click.group(cls=_LateGroup, context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 110})
@click.option(
    "--version",
    is_flag=True,
    is_eager=True,
    expose_value=False,
    callback=_show_version,
    help="Print the version, and which kernels run.",
)
def isocore() -> None:
    """Turn volumes and meshes into isosurfaces, many files at a time, and say what was done.

    \b
    isocore convert sample_volumes/knot.nii.gz -i 200 -o knot.ply
    """


def main() -> None:
    """The entry point: run a command and exit with its code."""
    signal.signal(signal.SIGTERM, _terminate)
    speak_any_name()
    try:
        code = isocore.main(standalone_mode=False, prog_name="isocore")
    except click.exceptions.Exit as wish:
        code = wish.exit_code
    except click.ClickException as error:
        error.message = unarmed(printable(error.message))
        error.show()
        code = WRONG_COMMAND
    except OptionError as error:
        say(f"isocore: {error}")
        code = WRONG_COMMAND
    except IsocoreError as error:
        say(f"isocore: {error}")
        code = FAILED
    except ImportError as error:
        if error.name != "isocore._kernels":
            raise
        say(f"isocore: {error}")
        code = FAILED
    except (KeyboardInterrupt, click.exceptions.Abort):
        click.echo("isocore: interrupted", err=True)
        code = INTERRUPTED
    except Terminated:
        click.echo("isocore: terminated", err=True)
        code = TERMINATED
    except BrokenPipeError:
        # Whoever read our output has left; point stdout elsewhere so that Python does not complain at exit.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        code = FAILED
    sys.exit(code or 0)


def _terminate(number: int, frame: FrameType | None) -> None:
    raise Terminated
