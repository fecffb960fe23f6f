"""What the report's page costs a batch: `python tests/bench/page_cost.py [--at-most 1.3]`.

Scans are converted without and with `--report x.html`, in turns, each batch in a process of its own; the workers make
the copies for the page. A figure is the median over the rounds of the ratio of the processor time of one round's two
batches, workers included. Exit code 1 if any is more than --at-most.
"""

from __future__ import annotations

import argparse
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path
from resource import RUSAGE_CHILDREN, getrusage

ROOT = Path(__file__).resolve().parent.parent.parent
SCANS = ROOT.parent / "shared" / "data" / "volumes"
FOLDERS = ("ct", "microct", "mni", "mri", "pyradiomics", "seg3d", "stroke")
SUFFIXES = (".mha", ".nhdr", ".nii.gz", ".nrrd")
PROGRAM = "from isocore.cli.main import main; main()"
LEAST_BYTES = 400_000  # packed: smaller ones are over before the interpreter has started


def scans(folder: Path) -> list[Path]:
    """Scans of a head, a body or a bone."""
    found = [path for name in FOLDERS for path in sorted((folder / name).glob("*")) if path.name.endswith(SUFFIXES)]
    large = [path for path in found if path.suffix == ".nhdr" or path.stat().st_size >= LEAST_BYTES]
    return list({path.name.split(".")[0]: path for path in large}.values())  # one of each name


def seconds(arguments: list[str]) -> float:
    """Of the processor, for `isocore convert` and its workers."""
    before = getrusage(RUSAGE_CHILDREN)
    subprocess.run([sys.executable, "-P", "-c", PROGRAM, "convert", *arguments], check=True, stdout=subprocess.DEVNULL)
    after = getrusage(RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def figure(batch: list[str], rounds: int) -> tuple[float, float]:
    """The time of a batch without the page, and how many times that it takes with it."""
    without, ratios = [], []
    with tempfile.TemporaryDirectory() as folder:
        arguments = [*batch, "-d", folder, "--force", "--quiet"]
        page = ["--report", str(Path(folder) / "run.html")]
        for turn in range(rounds):
            orders = ([], page) if turn % 2 else (page, [])
            spent = {bool(order): seconds([*arguments, *order]) for order in orders}
            without.append(spent[False])
            ratios.append(spent[True] / spent[False])
    return statistics.median(without), statistics.median(ratios)


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scans", nargs="*", type=Path, help="instead of those of ../shared/data")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--at-most", type=float, default=1.3)
    asked = parser.parse_args()
    inputs = [str(path) for path in asked.scans or scans(SCANS)]
    print(f"{len(inputs)} scans\n{'backend':10}{'format':8}{'s without':>12}{'times with':>12}")
    worst = 0.0
    for backend in ("asc", "mc"):
        for suffix in ("ply", "stl"):
            without, ratio = figure([*inputs, "-b", backend, "-f", suffix], asked.rounds)
            worst = max(worst, ratio)
            print(f"{backend:10}{suffix:8}{without:12.2f}{ratio:12.2f}", flush=True)
    if worst > asked.at_most:
        raise SystemExit(f"{worst:.2f}: more than {asked.at_most}")


if __name__ == "__main__":
    main()
