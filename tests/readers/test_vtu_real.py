"""The VTU files of other programs: read as meshio reads them, or refused for a reason that is true."""

from __future__ import annotations

import io
from contextlib import redirect_stderr
from importlib.util import find_spec
from mmap import ACCESS_READ, mmap
from pathlib import Path

import meshio
import numpy as np
import pytest

from isocore.errors import FieldError, OptionError
from isocore.readers import ReadOptions, read
from isocore.readers.vtu import vtu_fields
from isocore.readers.vtu_arrays import ArrayReader
from isocore.readers.vtu_layout import scan

MESHES = Path(__file__).parents[3] / "shared" / "data" / "meshes"
pytestmark = pytest.mark.skipif(
    not MESHES.is_dir(), reason="the real data lies beside the repository, not in it"
)

NO_FIELD = (FieldError, "holds no point or cell field")
QUADS = (FieldError, "holds only surface cells (9 quads)")
POLYGONS = (FieldError, "holds only surface cells (6 polygons)")
#: file: field, component, and what comes of it: tetrahedra and hexahedra, or a refusal.
TABLE = {
    "k3d/output_fem.vtu": ("p", None, (113_252, 0)),
    "mayavi/fire_ug.vtu": ("uvw", "magnitude", (0, 10_462)),
    "meshio/vtu/00_raw_binary.vtu": ("m", "2", (162, 0)),
    "meshio/vtu/01_raw_binary_int64.vtu": ("m", "2", (162, 0)),
    "meshio/vtu/02_raw_compressed.vtu": ("m", "2", (162, 0)),
    "mfem-vtu/quad_append_b64.vtu": (None, None, NO_FIELD),
    "mfem-vtu/quad_append_b64_compress.vtu": (None, None, NO_FIELD),
    "mfem-vtu/quad_append_raw.vtu": ("Polynomial", None, QUADS),
    "mfem-vtu/quad_append_raw_compress.vtu": ("Polynomial", None, QUADS),
    "mfem-vtu/quad_ascii.vtu": (None, None, NO_FIELD),
    "mfem-vtu/quad_attribute.vtu": (None, None, QUADS),
    "mfem-vtu/quad_binary.vtu": (None, None, NO_FIELD),
    "mfem-vtu/quad_binary_compress.vtu": (None, None, NO_FIELD),
    "mfem-vtu/quad_material_attribute.vtu": ("material", None, QUADS),
    "vtk-data/Hexahedron.vtu": (None, None, (0, 7)),
    "vtk-data/QuadraticTetra.vtu": ("DistanceToCenter", None, (768, 0)),
    "vtk-data/Tetrahedron.vtu": ("DistanceToCenter", None, (96, 0)),
    "vtk-data/Wedge.vtu": ("DistanceToCenter", None, (48, 0)),
    "vtk-data/can.vtu": ("EQPS", None, (0, 4_800)),
    "vtk-data/polyhedron2pieces.vtu": (None, None, NO_FIELD),
    "vtkio/box.vtu": ("pressure", None, POLYGONS),
    "vtkio/box_para.vtu": ("pressure", None, POLYGONS),
    "vtkio/hexahedron.vtu": (None, None, NO_FIELD),
    "vtkio/hexahedron_ascii.vtu": (None, None, (OptionError, "holds 6 point fields")),
    "vtkio/hexahedron_binary.vtu": (None, None, NO_FIELD),
    "vtkio/hexahedron_inline_binary.vtu": ("float32x1", None, (0, 1)),
    "vtkio/hexahedron_lz4.vtu": (None, None, NO_FIELD),
    "vtkio/hexahedron_lz4_inline_binary.vtu": (None, None, NO_FIELD),
    "vtkio/hexahedron_lzma_inline_binary.vtu": (None, None, NO_FIELD),
    "vtkio/hexahedron_parallel_0.vtu": (None, None, NO_FIELD),
    "vtkio/hexahedron_parallel_lzma_0.vtu": (None, None, NO_FIELD),
    "vtkio/hexahedron_zlib.vtu": (None, None, NO_FIELD),
    "vtkio/hexahedron_zlib_binary.vtu": (None, None, NO_FIELD),
    "vtkio/hexahedron_zlib_inline_binary.vtu": (None, None, NO_FIELD),
    "vtkio/hexahedron_zlib_para.vtu": (None, None, NO_FIELD),
    "vtkio/pygmsh/ascii.vtu": (None, None, NO_FIELD),
    "vtkio/pygmsh/lzma.vtu": (None, None, NO_FIELD),
    "vtkio/pygmsh/no-compression.vtu": (None, None, NO_FIELD),
    "vtkio/pygmsh/zlib.vtu": (None, None, NO_FIELD),
    "vtkio/tet.vtu": (None, None, (1, 0)),
}
#: What meshio itself cannot read: unknown version, several pieces, gaps in the appended data, LZ4.
NOT_FOR_MESHIO = ("quad_material_attribute", "can", "polyhedron2pieces", "box", "lz4")
#: Files that hold one mesh in several encodings.
FAMILIES = ("meshio/vtu/*.vtu", "mfem-vtu/quad_*.vtu", "vtkio/hexahedron*.vtu", "vtkio/pygmsh/*.vtu")


def arrays_of(path: Path) -> dict[str, np.ndarray]:
    """Every array of the first piece, decoded, by section and name."""
    with path.open("rb") as file:
        data = mmap(file.fileno(), 0, access=ACCESS_READ)
    layout = scan(str(path), data)
    reader = ArrayReader(str(path), data, layout)
    sections = layout.pieces[0].arrays.items()
    return {f"{section}/{tag.name}": reader.read(tag) for section, tags in sections for tag in tags}


def needs_lz4(path: Path) -> bool:
    return "lz4" in path.name and find_spec("lz4") is None


def test_the_table_names_every_file():
    """A new file needs a line of its own."""
    assert {str(path.relative_to(MESHES)) for path in MESHES.rglob("*.vtu")} == set(TABLE)


@pytest.mark.parametrize("name", TABLE)
def test_a_real_file_is_read_or_refused_for_a_true_reason(name):
    """The counts are those meshio and VTK report, wedges times three."""
    field, component, expected = TABLE[name]
    options = ReadOptions(field=field, component=component)
    if isinstance(expected[0], int):
        mesh = read(MESHES / name, options)
        assert (len(mesh.tets), len(mesh.hexes)) == expected
    else:
        with pytest.raises(expected[0]) as refusal:
            read(MESHES / name, options)
        assert str(refusal.value).startswith(f"{MESHES / name}: {expected[1]}")


@pytest.mark.parametrize("name", [n for n in TABLE if not any(part in n for part in NOT_FOR_MESHIO)])
def test_points_and_fields_are_those_meshio_reads(name):
    """An independent reader, number by number."""
    with redirect_stderr(io.StringIO()):
        theirs = meshio.vtu.read(MESHES / name)
    ours = arrays_of(MESHES / name)
    points = next(values for key, values in ours.items() if key.startswith("Points/"))
    np.testing.assert_array_equal(points.reshape(-1, 3), theirs.points)
    assert [field.name for field in vtu_fields(MESHES / name)] == [*theirs.point_data, *theirs.cell_data]
    for field, values in theirs.point_data.items():
        np.testing.assert_array_equal(ours[f"PointData/{field}"], values.ravel())
    assert len(ours["Cells/types"]) == sum(len(block.data) for block in theirs.cells)


@pytest.mark.parametrize("pattern", FAMILIES)
def test_one_mesh_in_many_encodings_is_one_mesh(pattern):
    """Cells agree exactly over all files of a family, points as far as ascii and float32 go."""
    files = [path for path in sorted(MESHES.glob(pattern)) if not needs_lz4(path)]
    assert len(files) > 1
    expected = arrays_of(files[0])
    for path in files[1:]:
        found = arrays_of(path)
        for key in ("Cells/connectivity", "Cells/offsets", "Cells/types"):
            np.testing.assert_array_equal(found[key], expected[key], err_msg=f"{path.name} {key}")
        points = [
            next(a for key, a in arrays.items() if key.startswith("Points/")) for arrays in (found, expected)
        ]
        np.testing.assert_allclose(*points, rtol=1e-6, atol=1e-7, err_msg=path.name)


@pytest.mark.skipif(find_spec("lz4") is not None, reason="the optional package lz4 is installed")
@pytest.mark.parametrize("name", ["vtkio/hexahedron_lz4.vtu", "vtkio/hexahedron_lz4_inline_binary.vtu"])
def test_lz4_without_its_package_is_refused_with_what_to_do(name):
    """The package is optional."""
    with pytest.raises(Exception, match="is compressed with LZ4; install the Python package lz4"):
        arrays_of(MESHES / name)
