"""Time `measure` against the extraction of the surface it measures: both are paid for every isovalue.

The two take turns in one process, as in run.py; figures are medians.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator

from run import SHARED, knot_field, ours, take_turns

import isocore
from isocore.backends import Options, prepare
from isocore.measure import measure
from isocore.volume import Volume

TEMPLATES = (
    ("MNI T1", SHARED / "mni" / "mni_icbm152_t1_tal_nlin_sym_09a_converted.nii.gz", 150.0),
    ("MNI 2009", SHARED / "mni" / "MNI152_2009_template.nii.gz", 70.0),
)


def volumes() -> Iterator[tuple[str, Volume, float]]:
    """The brains that are at hand, and a smooth surface: name, volume, stored isovalue."""
    for name, path, isovalue in TEMPLATES:
        if path.exists():
            volume = isocore.read(path)
            assert isinstance(volume, Volume)
            yield name, volume, volume.stored_isovalue(isovalue)
    yield "knot float32", Volume(knot_field(256).astype("float32", order="F")), 200.0


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rounds", type=int, default=15)
    rounds = parser.parse_args().rounds
    print(f"{'volume':14}{'threads':>8}{'triangles':>12}{'extract ms':>12}{'measure ms':>12}{'ratio':>8}")
    for name, volume, stored in volumes():
        for threads in (1, 2):
            surface = prepare(volume, "mc", Options(threads=threads))(volume.scaled(stored)).surface

            def run(surface: isocore.Surface = surface, threads: int = threads) -> int:
                return measure(surface, threads).triangles

            timed = take_turns({"extract": ours(volume, stored, "mc", threads), "measure": run}, rounds)
            (extract, triangles), (seconds, _) = timed["extract"], timed["measure"]
            row = f"{name:14}{threads:>8}{triangles:>12,}{1e3 * extract:>12.1f}{1e3 * seconds:>12.1f}"
            print(f"{row}{seconds / extract:>8.2f}")


if __name__ == "__main__":
    main()
