"""Mesh files of imported robots: where they are found, their scale, frame and limits."""

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from kinesic.sim.importer import mesh_reader as module
from kinesic.sim.importer.mesh_reader import MeshReader
from kinesic.sim.importer.reading.model_text import MeshReference

TETRAHEDRON = "v 0 0 0\nv 1 0 0\nv 0 2 0\nv 0 0 3\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
PLAIN = SimpleNamespace(scale=(1, 1, 1), refpos=(0, 0, 0), refquat=(1, 0, 0, 0))


def framed(**values):
    return SimpleNamespace(**{**vars(PLAIN), **values})


def mesh_at(folder: Path, name: str = "a.obj", text: str = TETRAHEDRON) -> MeshReference:
    (folder / name).parent.mkdir(parents=True, exist_ok=True)
    (folder / name).write_text(text, encoding="utf-8")
    return MeshReference(name, Path(name).stem, "")


@pytest.fixture
def reader(tmp_path: Path) -> MeshReader:
    return MeshReader(tmp_path / "r.xml")


def test_mesh_is_scaled_then_moved_by_its_position_then_rotated(tmp_path: Path, reader: MeshReader):
    half = np.sqrt(0.5)
    mesh = framed(scale=(2, 3, -4), refpos=(1, 0, 0), refquat=(half, 0, 0, half))
    found = reader.read(mesh_at(tmp_path), mesh)
    rotation = np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1]])
    expected = [rotation.T @ point for point in ([-1, 0, 0], [1, 0, 0], [-1, 6, 0], [-1, 0, -12])]
    np.testing.assert_allclose(found.vertices, expected, atol=1e-12)
    assert found.corners.tolist() == [[1, 2, 0], [3, 1, 0], [2, 3, 0], [3, 2, 1]], (
        "a mirrored mesh is turned inside out"
    )


def test_mesh_with_two_mirrored_axes_keeps_its_outside(tmp_path: Path, reader: MeshReader):
    found = reader.read(mesh_at(tmp_path), framed(scale=(-1, -1, 1)))
    assert found.corners[0].tolist() == [0, 2, 1]


@pytest.mark.parametrize(("size", "scale", "extent"), [(9.9, 1, 9.9), (10.1, 1, 0.0101), (10.1, 2, 20.2)])
def test_mesh_of_more_than_ten_metres_without_a_scale_is_in_millimetres(tmp_path, reader, size, scale, extent):
    reference = mesh_at(tmp_path, text=TETRAHEDRON.replace("v 0 0 3", f"v 0 0 {size}"))
    found = reader.read(reference, framed(scale=(scale,) * 3))
    assert np.ptp(found.vertices[:, 2]) == pytest.approx(extent)
    expected = ["a.obj: 10 m large without a scale, so it is taken as millimetres"] if extent < 1 else []
    assert reader.notes == expected


def test_mesh_is_read_once_for_each_scale(tmp_path: Path, reader: MeshReader, monkeypatch: pytest.MonkeyPatch):
    reads: list[Path] = []
    original = module.read_mesh
    monkeypatch.setattr(
        module, "read_mesh", lambda path, *, folder: reads.append(path) or original(path, folder=folder)
    )
    reference = mesh_at(tmp_path)
    first = reader.read(reference, PLAIN)
    assert reader.read(reference, PLAIN) is first
    assert len(reads) == 1
    for other in (framed(scale=(2, 1, 1)), framed(refpos=(0, 0, 1)), framed(refquat=(0, 1, 0, 0))):
        assert reader.read(reference, other) is not first
    assert len(reads) == 4


def test_note_on_an_unreadable_mesh_is_given_once(tmp_path: Path, reader: MeshReader):
    missing = MeshReference("lost.obj", "lost", "")
    assert [reader.read(missing, mesh) for mesh in (PLAIN, PLAIN, framed(scale=(2, 2, 2)))] == [None, None, None]
    assert reader.read(MeshReference("", "inline", ""), PLAIN) is None
    lost, inline = reader.notes
    assert lost == f"lost.obj: not in the folder {tmp_path.name}; copy it there, or the robot's file above it"
    assert inline.startswith("mesh inline: without a file; only .stl, .obj")


def test_mesh_files_beyond_the_largest_number_are_not_read(tmp_path, reader, monkeypatch):
    monkeypatch.setattr(module, "MAX_MESH_FILES", 2)
    references = [mesh_at(tmp_path, f"{k}.obj") for k in range(3)]
    assert [reader.read(reference, PLAIN) is None for reference in references] == [False, False, True]
    assert reader.notes == ["2.obj: more than 2 mesh files"]


def test_mesh_files_of_exactly_the_largest_total_size_are_read(tmp_path, reader, monkeypatch):
    monkeypatch.setattr(module, "MAX_MESH_BYTES", 2 * len(TETRAHEDRON))
    references = [mesh_at(tmp_path, f"{k}.obj") for k in range(3)]
    assert [reader.read(reference, PLAIN) is None for reference in references] == [False, False, True]
    assert reader.notes == ["2.obj: more than 0 MB of meshes"]


def test_robot_may_have_300_mesh_files_of_200_megabytes_and_3000_triangles_each():
    limits = (module.MAX_MESH_FILES, module.MAX_MESH_BYTES, module.MAX_MESH_TRIANGLES)
    assert limits == (300, 200_000_000, 3000)


@pytest.mark.parametrize(
    "reference",
    ["package://robot/meshes/a.obj", "/opt/robots/meshes/a.obj", "meshes\\a.obj", "model://x://meshes/a.obj", "a.obj"],
)
def test_mesh_file_is_found_by_the_end_of_its_reference(tmp_path: Path, reader: MeshReader, reference: str):
    mesh_at(tmp_path, "a.obj" if reference == "a.obj" else "meshes/a.obj")
    assert reader.read(MeshReference(reference, "a", ""), PLAIN) is not None


def test_mesh_with_the_longest_matching_reference_is_read(tmp_path: Path, reader: MeshReader):
    mesh_at(tmp_path, "left/a.obj")
    mesh_at(tmp_path, "a.obj", TETRAHEDRON.replace("v 0 0 3", "v 0 0 5"))
    found = reader.read(MeshReference("package://robot/left/a.obj", "a", ""), PLAIN)
    assert np.ptp(found.vertices[:, 2]) == 3


def test_package_name_of_a_reference_is_no_folder_of_the_neighbouring_package(tmp_path: Path):
    for name in ("pkg", "other"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "package.xml").write_text("<package/>")
    mesh_at(tmp_path / "other", "a.obj")
    reader = MeshReader(tmp_path / "pkg" / "r.urdf")
    assert reader.read(MeshReference("package://other/a.obj", "a", ""), PLAIN) is not None
    assert reader.read(MeshReference("package://other/../r.urdf", "a", ""), PLAIN) is None


def test_mesh_with_more_triangles_than_the_limit_is_simplified(tmp_path, reader, monkeypatch):
    monkeypatch.setattr(module, "MAX_MESH_TRIANGLES", 2)
    assert len(reader.read(mesh_at(tmp_path), PLAIN).corners) <= 2


def test_mesh_behind_a_cycle_of_links_is_left_out_with_a_note(tmp_path: Path, reader: MeshReader):
    (tmp_path / "a.obj").symlink_to(tmp_path / "b.obj")
    (tmp_path / "b.obj").symlink_to(tmp_path / "a.obj")
    assert reader.read(MeshReference("a.obj", "a", ""), PLAIN) is None
    assert len(reader.notes) == 1
