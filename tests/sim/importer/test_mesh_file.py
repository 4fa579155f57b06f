import struct
from pathlib import Path

import numpy as np
import pytest

from kinesic.body.config import ConfigError
from kinesic.sim.importer import mesh_file as module
from kinesic.sim.importer.mesh_file import Triangles, read_mesh, simplify


def ball(rings: int) -> Triangles:
    """Return a sphere of radius 1."""
    rise, turn = np.linspace(-np.pi / 2, np.pi / 2, rings + 1), 2 * np.pi * np.arange(rings) / rings
    up, around = np.meshgrid(rise, turn, indexing="ij")
    places = np.stack([np.cos(up) * np.cos(around), np.cos(up) * np.sin(around), np.sin(up)], axis=-1).reshape(-1, 3)
    low = np.arange(rings)[:, None] * rings + np.arange(rings)
    after = np.arange(rings)[:, None] * rings + (np.arange(rings) + 1) % rings
    halves = ((low, after, after + rings), (low, after + rings, low + rings))
    corners = np.concatenate([np.stack(half, axis=-1).reshape(-1, 3) for half in halves])
    return Triangles(places, corners)


def stl(mesh: Triangles) -> bytes:
    rows = mesh.vertices[mesh.corners].astype("<f4").reshape(-1, 9)
    return bytes(80) + struct.pack("<I", len(rows)) + b"".join(bytes(12) + row.tobytes() + bytes(2) for row in rows)


def test_stl_is_read_with_merged_vertices(tmp_path: Path):
    mesh = ball(12)
    (tmp_path / "ball.STL").write_bytes(stl(mesh))
    result = read_mesh(tmp_path / "ball.STL", folder=tmp_path)
    np.testing.assert_allclose(result.vertices[result.corners], mesh.vertices[mesh.corners], atol=1e-6)
    assert len(result.vertices) < 0.3 * 3 * len(result.corners)


def test_obj_faces_may_have_any_number_of_corners(tmp_path: Path):
    path = tmp_path / "plate.obj"
    path.write_text("# a plate\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvn 0 0 1\nf 1//1 2//1 3//1 4//1\nf -4 -3 -2\n")
    mesh = read_mesh(path, folder=tmp_path)
    assert mesh.corners.tolist() == [[0, 1, 2], [0, 2, 3], [0, 1, 2]]


@pytest.mark.parametrize(
    ("name", "data", "why"),
    [
        ("a.dae", b"<xml/>", "only .stl and .obj are read"),
        ("a.stl", b"solid ascii\n" + bytes(100), "must be a binary STL"),
        ("a.stl", bytes(80) + struct.pack("<I", 4_000_000_000), "must be a binary STL"),
        ("a.stl", bytes(84), "no triangles"),
        ("a.obj", b"v 0 0 0\nf 1 2 3\n", "an invalid vertex index"),
        ("a.obj", b"v 0 0 nan\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "not finite"),
        ("a.obj", b"v 0 0 zero\n", "not a readable OBJ"),
        ("a.obj", b"v 0 0\nv 1 0 0\nf 1 2 1\n", "not a readable OBJ"),
    ],
)
def test_invalid_mesh_is_rejected_with_the_reason(tmp_path: Path, name: str, data: bytes, why: str):
    (tmp_path / name).write_bytes(data)
    with pytest.raises(ConfigError, match=why):
        read_mesh(tmp_path / name, folder=tmp_path)


def test_huge_mesh_file_is_rejected(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(module, "MAX_MESH_SIZE", 1000)
    (tmp_path / "ball.stl").write_bytes(stl(ball(12)))
    with pytest.raises(ConfigError, match=r"ball.stl has 14484 bytes; at most 1000"):
        read_mesh(tmp_path / "ball.stl", folder=tmp_path)


@pytest.mark.parametrize("most", [40, 500])
def test_simplified_mesh_keeps_the_shape(most: int):
    few = simplify(ball(60), most)
    assert 0.3 * most < len(few.corners) <= most
    sizes = np.linalg.norm(few.vertices[few.corners], axis=2)
    assert sizes.max() <= 1.0 + 1e-9
    assert sizes.min() > 0.6
    a, b, c = (few.vertices[few.corners[:, k]] for k in range(3))
    assert (np.einsum("ti,ti->t", np.cross(b - a, c - a), a + b + c) > 0.0).mean() > 0.95, "they face outward"


def test_mesh_below_the_triangle_limit_is_not_simplified():
    mesh = ball(6)
    assert len(simplify(mesh, 1000).corners) == len(mesh.corners)


def test_triangles_far_outside_a_robot_are_removed():
    mesh = Triangles(np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [1e6, 0, 0]]), np.array([[0, 1, 2], [0, 1, 3]]))
    assert simplify(mesh, 1000).corners.tolist() == [[0, 1, 2]]
