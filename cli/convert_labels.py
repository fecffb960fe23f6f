"""What `--labels` and its companions ask for, checked against the other options."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from isocore.errors import InputError

if TYPE_CHECKING:
    from isocore.batches.label_targets import LabelRequest

    from .convert_options import ConvertOptions


def label_request(options: ConvertOptions) -> LabelRequest | None:
    """The labels asked for, or None where isovalues are; the table of names is read. Raises UsageError for nonsense."""
    if options.labels is None:
        for given, name in ((options.background is not None, "background"), (options.label_table is not None, "names")):
            if given:
                raise click.UsageError(f"--{name}: is about label maps; give --labels all, or a list of them")
        return None
    for given, option in (
        (bool(options.isovalues), "-i"),
        (options.backend != "auto", "-b"),
        (options.ambiguities is not None, "--ambiguities"),
        (options.cap, "--cap"),
        (options.merge_isovalues, "--merge-isovalues"),
    ):
        if given:
            raise click.UsageError(f"--labels {options.labels}: does not go with {option}; leave one of them out")
    from isocore.batches.label_targets import LabelRequest
    from isocore.readers.label_tables import read_label_table

    names = None
    if options.label_table is not None:
        try:
            names = read_label_table(options.label_table)
        except InputError as error:
            raise click.UsageError(f"--names {error}") from error
    return LabelRequest(labels=options.labels, background=options.background or 0, names=names)
