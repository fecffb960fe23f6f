"""What `isocore convert` may be asked, in the groups of its help: what it means, its values and its default."""

from __future__ import annotations

import click

from isocore.choices import FORMATS, SPACES
from isocore.requirements import REQUIREMENTS

from .groups import GROUPS, option_of
from .options import OFFSETS, OUTPUT_FILE, PATH, reading_and_offset_options
from .steps import StepNumbers, Times
from .values import Colour, Isovalue, Jobs, LabelList, Memory, Words

_input, _isovalue, _, _, _output, _batch, _report = map(option_of, GROUPS)

INPUT = (
    click.argument("inputs", nargs=-1, type=PATH, metavar="INPUT..."),
    _input("--files-from", type=PATH, metavar="FILE|-", help="Further inputs, one a line of FILE or of stdin (-)."),
    _input("-0", "--null", is_flag=True, help="Names in that file end in NUL, as find -print0 writes them."),
    reading_and_offset_options,
    _input(
        "--steps",
        type=StepNumbers(),
        metavar="A:B:C",
        show_default="all",
        help="Of a series: every C-th step from A to B, both included, counted from 0; -1 is the last. Also lists, "
        "as 0,5,10:20.",
    ),
    _input("--times", type=Times(), metavar="LIST", show_default="all", help="Of a series: the steps of these times."),
)

ISOVALUE = (
    _isovalue(
        "-i",
        "--isovalue",
        "isovalues",
        multiple=True,
        type=Isovalue(),
        metavar="V",
        show_default="auto",
        help="A number; otsu; pNN, the percentile NN; A:B:N, N values from A to B; A:B:+S, in steps of S; auto, the "
        "middle of a mask's two values, else otsu. Repeatable.",
    ),
)

LABELS = (
    _isovalue(
        "--labels",
        type=LabelList(),
        metavar="all|LIST",
        show_default="none: isovalues",
        help="Of a label map: one surface for each label (all), or for some, as 1,5-9. Neighbours share their border.",
    ),
    _isovalue(
        "--background",
        type=int,
        metavar="K",
        show_default="0",
        help="With --labels: the label that is none.",
    ),
    _isovalue(
        "--names",
        "label_table",
        type=PATH,
        metavar="FILE",
        show_default="names inside the file",
        help="With --labels: names and colours, as FreeSurfer, ITK-SNAP and Slicer write them, a .tsv (BIDS) or .csv.",
    ),
)

OUTPUT = (
    _output("-o", "--output", type=OUTPUT_FILE, metavar="FILE", help="Of one input and one isovalue; - is stdout."),
    _output(
        "-d",
        "--output-dir",
        type=PATH,
        metavar="DIR",
        show_default="beside the input",
        help="Where surfaces go; the folders of an input folder are made in it too.",
    ),
    _output(
        "-f",
        "--format",
        type=click.Choice(FORMATS, case_sensitive=False),
        show_default=f"by the suffix of -o, else {FORMATS[0]}",
        help="What surfaces are written as, binary where the format can be.",
    ),
    _output("--merge-isovalues", is_flag=True, help="One file of all isovalues of an input, each a part of it."),
    _output("--compress", is_flag=True, help="Pack the arrays of vtp, by zlib."),
    _output(
        "--name",
        metavar="TEMPLATE",
        show_default="{stem}, with _{isovalue} where there are several, or _{label_name}",
        help="Of the output, without suffix; also {name} {parent} {relpath} {isovalue} {label} {label_name} {backend} "
        "{volume} {step} {time}.",
    ),
    _output(
        "--space",
        type=click.Choice(SPACES, case_sensitive=False),
        default="native",
        show_default=True,
        help="World of the vertices: right-anterior-superior, left-posterior-superior, left-anterior-superior, the "
        "file's own, or samples counted from 0.",
    ),
    OFFSETS,
    _output(
        "--normals/--no-normals",
        default=None,
        show_default="on where the format has them: not in stl",
        help="Write vertex normals, from the field's gradient.",
    ),
    _output(
        "--color",
        "colour",
        type=Colour(),
        metavar="'#rrggbb'",
        show_default="none",
        help="Of the surface, in ply, obj (with a .mtl beside) and glb. Labels have their own.",
    ),
    _output(
        "--ambiguities",
        type=PATH,
        metavar="FILE",
        help="Write the cell faces that could be drawn in two ways, as points, PLY.",
    ),
)

BATCH = (
    _batch(
        "-j",
        "--jobs",
        type=Jobs(),
        default=1,
        show_default=True,
        metavar="N|auto",
        help="Inputs at once, each in a process of its own; auto: as many as processors.",
    ),
    _batch(
        "--threads",
        type=click.IntRange(min=1),
        metavar="N",
        show_default="processors / inputs at once",
        help="Threads inside one input.",
    ),
    _batch(
        "--timeout",
        type=click.FloatRange(min=0, min_open=True),
        metavar="SECONDS",
        show_default="none",
        help="Give up an input after so long.",
    ),
    _batch(
        "--memory-limit",
        type=Memory(),
        metavar="SIZE",
        show_default="what is free",
        help="For all inputs at once, as 500M or 4G.",
    ),
    _batch("--scheduler", metavar="ADDRESS", help="Send inputs to a dask scheduler instead, as tcp://host:8786."),
    _batch("--if-changed", is_flag=True, help="Skip outputs that are up to date."),
    _batch("--force", is_flag=True, help="Convert also what --if-changed would skip."),
    _batch("--fail-fast", is_flag=True, help="Stop at the first input that fails."),
    _batch("--dry-run", is_flag=True, help="Only say what would be done, why, and in how much memory."),
    _batch("--depfile", type=PATH, metavar="FILE", help="Write make rules: which outputs need which files."),
)

REPORT = (
    _report(
        "--report",
        "reports",
        multiple=True,
        type=PATH,
        metavar="FILE",
        help="Save the report: .json .jsonl .csv .md .html .xml (JUnit) or bench.json. Repeatable.",
    ),
    _report(
        "--page-size",
        type=Memory(),
        metavar="SIZE",
        default="16M",
        show_default=True,
        help="Room for the surfaces in an HTML report, as 500K or 64M.",
    ),
    _report("--json", "as_json", is_flag=True, help="The JSON report on stdout."),
    _report(
        "--reference/--no-reference",
        default=True,
        show_default=True,
        help="Run marching cubes too, to compare.",
    ),
    _report(
        "--self-intersections/--no-self-intersections",
        default=True,
        show_default=True,
        help="Count the pairs of triangles that meet each other.",
    ),
    _report(
        "--require",
        type=Words(REQUIREMENTS),
        metavar="LIST",
        help=f"What each surface must be: any of {' '.join(REQUIREMENTS)}, with commas; a miss is exit code 3.",
    ),
    _report(
        "--max-triangles",
        type=click.IntRange(min=0),
        metavar="N",
        show_default="no limit",
        help="What each surface may have; more is exit code 3.",
    ),
    _report("-q", "--quiet", is_flag=True, help="Only errors and warnings."),
    _report("-v", "--verbose", is_flag=True, help="A line for each output as it is done, and each of its warnings."),
    _report("--no-progress", is_flag=True, help="No live progress bar."),
)
