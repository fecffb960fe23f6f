"""Time `measure` against the extraction of the surface it measures: both are paid for every isovalue.

The two take turns in one process, as in run.py; figures are medians.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator

from run import SHARED, ours, take_turns, volumes

import isocore
from isocore.backends import Options, prepare
from isocore.measurements import measure
from isocore.volume import Volume

TEMPLATE = SHARED / "mni" / "MNI152_2009_template.nii.gz"


def fields() -> Iterator[tuple[str, Volume, float]]:
    """The bench's volumes, and a second brain: name, volume, stored isovalue."""
    if TEMPLATE.exists():
        template = isocore.read(TEMPLATE)
        assert isinstance(template, Volume)
        yield "MNI 2009", template, template.stored_isovalue(70.0)
    yield from volumes()


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rounds", type=int, default=15)
    rounds = parser.parse_args().rounds
    print(f"{'volume':14}{'threads':>8}{'triangles':>12}{'extract ms':>12}{'measure ms':>12}{'ratio':>8}")
    for name, volume, stored in fields():
        for threads in (1, 2):
            surface = prepare(volume, "mc", Options(threads=threads))(volume.scaled(stored)).surface

            def run(surface: isocore.Surface = surface, threads: int = threads) -> int:
                return measure(surface, threads).triangles

            timed = take_turns({"extract": ours(volume, stored, "mc", threads), "measure": run}, rounds)
            extract, own = timed["extract"], timed["measure"]
            row = f"{name:14}{threads:>8}{own.triangles:>12,}{1e3 * extract.seconds:>12.1f}{1e3 * own.seconds:>12.1f}"
            print(f"{row}{own.ratio(extract):>8.2f}")


if __name__ == "__main__":
    main()
