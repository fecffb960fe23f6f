"""The group, and the only place that turns errors into exit codes."""

from __future__ import annotations

import signal
import sys
from contextlib import suppress
from importlib import import_module
from types import FrameType

import click

from isocore.errors import IsocoreError, OptionError, one_line, printable

from .names import speak_any_name
from .streams import CANNOT_WRITE, UNREAD, open_closed_streams, settle_streams, working_folder_is_there

#: Each command is a file of its name, imported only when it is called or described.
COMMANDS = {
    "convert": "volumes and meshes to surfaces, one file or a whole folder",
    "info": "what a file holds, and which isovalues make sense",
    "index": "thin meshes now, and keep the index beside them",
    "bench": "the papers' tables on your own data",
    "report": "turn JSON reports into tables and CI formats; compare two",
    "completion": "what makes bash, zsh or fish complete commands and options",
}

FAILED, WRONG_COMMAND, MISSED, HUNG_UP, INTERRUPTED, TERMINATED = 1, 2, 3, 129, 130, 143
#: What the codes mean, for people.
EXIT_CODES = {
    0: "all done, or up to date",
    FAILED: "some input failed",
    WRONG_COMMAND: "the command line is wrong",
    MISSED: "a requirement was missed",
    HUNG_UP: "hung up: the terminal or its connection was closed",
    INTERRUPTED: "interrupted",
    UNREAD: "whoever read stdout has left, as head does",
    TERMINATED: "terminated",
}


class Terminated(BaseException):
    """SIGTERM or SIGHUP, as an exception that cleans up on its way out."""

    def __init__(self, number: int) -> None:
        self.code = HUNG_UP if number == getattr(signal, "SIGHUP", None) else TERMINATED
        super().__init__("hung up" if self.code == HUNG_UP else "terminated")


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
    open_closed_streams()
    _listen_to_signals()
    speak_any_name()
    stdout = sys.stdout
    try:
        code = isocore.main(standalone_mode=False, prog_name="isocore")
        if not code:
            sys.stdout.flush()
    except click.exceptions.Exit as wish:
        code = wish.exit_code
    except click.ClickException as error:
        from .console import unarmed

        vars(error)["message"] = unarmed(printable(error.message))
        with suppress(OSError):
            error.show()
        code = WRONG_COMMAND
    except (KeyboardInterrupt, click.exceptions.Abort):
        _say("isocore: interrupted")
        code = INTERRUPTED
    except SystemExit:
        if sys.stdout is stdout:
            raise
        sys.stdout, code = stdout, UNREAD  # a pipe broke: there click puts another in its place, and exits
    except Terminated as end:
        _say(f"isocore: {end}")
        code = end.code
    except Exception as error:
        code = _failure(error)
    settle_streams()
    sys.exit(code or 0)


def _say(line: str) -> None:
    """A line on stderr; what says it is imported late, since most commands end well."""
    from .console import say

    say(line)


def _failure(error: Exception) -> int:
    """Say what went wrong in one line; the code to exit with."""
    if isinstance(error, FileNotFoundError) and not working_folder_is_there():
        _say("isocore: the working folder is gone; change into one that is there")
        return WRONG_COMMAND
    if isinstance(error, BrokenPipeError):
        return UNREAD
    if isinstance(error, OSError) and error.errno in CANNOT_WRITE:  # an output file's error has its name by now
        _say(f"isocore: stdout: cannot be written ({error.strerror or one_line(error)}); check where it leads")
        return FAILED
    if isinstance(error, IsocoreError):
        _say(f"isocore: {error}")
        return WRONG_COMMAND if isinstance(error, OptionError) else FAILED
    if isinstance(error, ImportError):
        _say(f"isocore: {one_line(error)}{'' if error.name == 'isocore._kernels' else '; install isocore again'}")
        return FAILED
    if sys.flags.dev_mode:
        raise error
    import traceback

    place = traceback.extract_tb(error.__traceback__)[-1]
    from pathlib import Path  # late: it takes longer than all of the help

    where = f"{Path(place.filename).name} line {place.lineno}, `python -X dev` shows all of it"
    _say(f"isocore: internal error ({type(error).__name__}: {one_line(error)}; {where}); please report it")
    return FAILED


def _listen_to_signals() -> None:
    """End in order where the system asks for it; a program that was started to outlive its terminal does."""
    for name in ("SIGTERM", "SIGHUP"):
        number = getattr(signal, name, None)
        if number is not None and (name == "SIGTERM" or signal.getsignal(number) is not signal.SIG_IGN):
            signal.signal(number, _terminate)


def _terminate(number: int, frame: FrameType | None) -> None:
    for name in ("SIGTERM", "SIGHUP"):  # once is enough: a second one would end the cleaning up
        if hasattr(signal, name):
            signal.signal(getattr(signal, name), signal.SIG_IGN)
    raise Terminated(number)


#: CPython gets memory for its frames in pieces of 16 KB, and gives the last one back whenever a call returns from it: a
#: loop whose calls happen to cross the end of a piece pays the system for every one of them, thousands while modules
#: are imported. The first frame asks for as much as all others will take (words, of which only used pages are real).
main.__code__ = main.__code__.replace(co_stacksize=1 << 14)
