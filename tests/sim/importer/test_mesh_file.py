import struct
from pathlib import Path

import numpy as np
import pytest

from kinesic.body.config import ConfigError
from kinesic.sim.importer import mesh_file as module
from kinesic.sim.importer.mesh_file import (
    Triangles,
    _keep_outermost,
    _merge_vertices,
    _number_rows,
    read_mesh,
    simplify,
)


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


def test_stl_in_text_form_has_the_triangles_of_the_binary_form(tmp_path: Path):
    mesh = ball(6)
    facets = [
        "facet normal 0 0 0\nouter loop\n"
        + "".join(f"vertex {' '.join(f'{value:.9g}' for value in mesh.vertices[k])}\n" for k in triangle)
        + "endloop\nendfacet\n"
        for triangle in mesh.corners
    ]
    (tmp_path / "text.stl").write_text("  solid ball\n" + "".join(facets) + "endsolid ball\n")
    (tmp_path / "binary.stl").write_bytes(b"solid".ljust(80) + stl(mesh)[80:])
    text, binary = (read_mesh(tmp_path / name, folder=tmp_path) for name in ("text.stl", "binary.stl"))
    np.testing.assert_allclose(text.vertices[text.corners], mesh.vertices[mesh.corners], atol=1e-8)
    np.testing.assert_allclose(binary.vertices[binary.corners], mesh.vertices[mesh.corners], atol=1e-6)


def test_obj_faces_may_have_any_number_of_corners(tmp_path: Path):
    path = tmp_path / "plate.obj"
    path.write_text("# a plate\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvn 0 0 1\nf 1//1 2//1 3//1 4//1\nf -4 -3 -2\n")
    mesh = read_mesh(path, folder=tmp_path)
    assert mesh.corners.tolist() == [[0, 1, 2], [0, 2, 3], [0, 1, 2]]


@pytest.mark.parametrize(
    ("name", "data", "why"),
    [
        ("a.ply", b"ply", "only .stl, .obj, .dae are read"),
        ("a.dae", b"<xml/>", "no triangles"),
        ("a.dae", b"<COLLADA>", "not a readable DAE"),
        ("a.stl", b"solid ascii\n" + bytes(100), "no triangles"),
        ("a.stl", b"solid a\nvertex 0 0 0\nvertex 1 0 0\n" + bytes(80), "not three for each triangle"),
        ("a.stl", b"solid a\nvertex 0 0\nvertex 1 0 0\nvertex 1 0 0\n" + bytes(80), "not a readable STL"),
        ("a.stl", bytes(80) + struct.pack("<I", 4_000_000_000), "and it is no text either"),
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
def test_vertices_of_a_simplified_ball_keep_60_to_100_percent_of_its_radius(most: int):
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


def test_only_the_outward_face_of_two_mesh_faces_with_equal_corners_is_kept():
    """Keep one of two coincident walls that result from merged vertices."""
    vertices = np.array([[0.0, 0, 1], [1, 0, 1], [0, 1, 1], [0, 0, -3]])
    outside, inside = [0, 1, 2], [2, 1, 0]
    for corners in ([outside, inside], [inside, outside]):
        assert _keep_outermost(vertices, np.array(corners)).tolist() == [outside]
    both = [[0, 1, 2], [0, 1, 3], [1, 3, 0]]
    assert _keep_outermost(vertices, np.array(both)).tolist() == [[0, 1, 2], [0, 1, 3]]


def test_vertices_of_one_cell_become_their_mean_and_flat_triangles_disappear():
    vertices = np.array([[0.0, 0, 0], [0.2, 0, 0], [1, 0, 0], [0, 1, 0], [0, 1.3, 0.1]])
    surface = Triangles(vertices, np.array([[0, 2, 3], [0, 1, 2], [2, 0, 1], [1, 3, 4], [3, 4, 2], [1, 2, 4]]))
    merged = _merge_vertices(surface, 1.0)
    corners = merged.vertices[merged.corners]
    assert len(merged.vertices) == 3
    assert len(corners) == 1
    places = np.array(sorted(corners[0].round(6).tolist()))
    np.testing.assert_allclose(places, [[0.0, 1.15, 0.05], [0.1, 0.0, 0.0], [1.0, 0.0, 0.0]])


def test_grid_cells_are_numbered_uniquely_in_any_order_of_rows():
    rows = np.array([[0, 0, 0], [0, 0, 2], [0, 1, 0], [1, 0, 0], [2, 1, 2], [2, 1, 1], [0, 0, 2]])
    assert _number_rows(rows).tolist() == [0, 2, 3, 6, 17, 16, 2]


@pytest.mark.parametrize("most", [12, 11])
def test_mesh_is_simplified_only_above_the_limit(most: int):
    corner = np.array(np.meshgrid([0.0, 1], [0, 1], [0, 1])).reshape(3, -1).T
    faces = np.array([[k % 8, (k + 1) % 8, (k + 3) % 8] for k in range(12)])
    few = simplify(Triangles(corner, faces), most)
    assert (len(few.corners) == 12) is (most == 12)
    assert len(few.corners) <= most


def test_triangles_with_a_coordinate_of_100_metres_or_more_are_removed():
    vertices = np.array([[0.0, 0, 0], [99.9, 0, 0], [0, -99.9, 0], [0, -100.0, 0]])
    mesh = Triangles(vertices, np.array([[0, 1, 2], [0, 1, 3]]))
    assert simplify(mesh, 9).corners.tolist() == [[0, 1, 2]]


def test_mesh_without_size_or_vertices_is_returned_unchanged():
    point = Triangles(np.zeros((3, 3)), np.array([[0, 1, 2]] * 5))
    assert len(simplify(point, 2).corners) == 5
    assert len(simplify(Triangles(np.zeros((0, 3)), np.zeros((0, 3), int)), 0).corners) == 0


def test_mesh_files_up_to_20_megabytes_are_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    sizes: list[int] = []
    monkeypatch.setattr(module, "read_inside", lambda *_, max_size: sizes.append(max_size) or stl(ball(4)))
    read_mesh(tmp_path / "a.stl", folder=tmp_path)
    assert sizes == [20_000_000]


def test_unused_values_and_lines_of_an_obj_file_are_ignored_and_invalid_faces_rejected(tmp_path: Path):
    path = tmp_path / "a.obj"
    path.write_text("v 1 2 3 0.5 0.5 0.5\nvt 9 9\nv 4 5 6\nv 7 8 10\ns off\nf 1/1/1 2/2/2 3/3/3\nf -1 -2 -3\n")
    mesh = read_mesh(path, folder=tmp_path)
    assert mesh.vertices.tolist() == [[1, 2, 3], [4, 5, 6], [7, 8, 10]]
    assert mesh.corners.tolist() == [[0, 1, 2], [2, 1, 0]]
    path.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 -4\n")
    with pytest.raises(ConfigError, match="invalid vertex index"):
        read_mesh(path, folder=tmp_path)
    path.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2\n")
    with pytest.raises(ConfigError, match="no triangles"):
        read_mesh(path, folder=tmp_path)
