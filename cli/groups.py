"""Help in groups: an option says which group it belongs to, and a command shows its options group by group."""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import partial
from typing import Any

import click

#: In the order of the help; options of no group come last.
GROUPS = ("Input", "Isovalue", "Method", "Pieces", "Output", "Batch", "Report")
REST = "Other"


class GroupedOption(click.Option):
    """An option of a group."""

    def __init__(self, *arguments: Any, group: str, **settings: Any) -> None:
        if group not in GROUPS:
            raise ValueError(f"{group}: is none of {', '.join(GROUPS)}")
        super().__init__(*arguments, **settings)
        self.group = group

    def get_help_record(self, context: click.Context) -> tuple[str, str] | None:
        """Names and text; a default that is said in words looks like any other."""
        record = super().get_help_record(context)
        return record and (record[0], re.sub(r"\[default: \((.*)\)(?=; |\]$)", r"[default: \1", record[1]))


class GroupedCommand(click.Command):
    """A command whose help has a section for each group that one of its options belongs to."""

    def format_options(self, context: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the sections."""
        for title, parameters in sections_of(self, context):
            records = [record for one in parameters if (record := one.get_help_record(context)) is not None]
            with formatter.section(title):
                formatter.write_dl(records)


def sections_of(command: click.Command, context: click.Context) -> list[tuple[str, list[click.Parameter]]]:
    """The groups of a command's options, in the order of GROUPS; without any group, all options are one."""
    groups: dict[str, list[click.Parameter]] = {}
    for one in command.get_params(context):
        if isinstance(one, click.Option) and not one.hidden:
            groups.setdefault(one.group if isinstance(one, GroupedOption) else REST, []).append(one)
    if len(groups) == 1:
        return [("Options", parameters) for parameters in groups.values()]
    return [(f"{title} options", groups[title]) for title in (*GROUPS, REST) if title in groups]


def option_of(group: str) -> Callable[..., Callable[..., Any]]:
    """As click.option, for options of this group."""
    return partial(click.option, cls=GroupedOption, group=group)
