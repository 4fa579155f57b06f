import numpy as np
import pytest

from kinesic.body.choices import Variant
from kinesic.face.assets.chart import (
    CHART_WIDTH,
    LIP_DEPTH,
    WINDOW_LEFT_RIGHT,
    WINDOW_LOW_HIGH,
    compute_chart_window,
    compute_vertex_chart,
    measure_hairline_height,
    measure_mouth_depth,
    unroll_mesh,
)
from kinesic.face.assets.mesh import FACE_VARIANTS, MESH_PARTS, load_head


@pytest.mark.parametrize("variant", FACE_VARIANTS)
def test_painting_mask_is_zero_behind_the_head(variant: Variant):
    mesh = load_head(variant)
    place, skin = compute_vertex_chart(mesh), mesh.vertices("skin")
    forward = mesh.positions[skin, 0] / (mesh.eyes[0, 1] - mesh.eyes[1, 1])
    assert np.all(place[skin, 2][forward < -0.6] <= 0.0)
    outside = measure_mouth_depth(mesh)[skin] == 0.0
    assert np.all(place[skin, 2][(forward > -0.4) & outside] == 1.0)
    assert np.all(place[skin, 2][measure_mouth_depth(mesh)[skin] > LIP_DEPTH] < 1.0)


def test_head_mesh_is_split_along_the_chart_seam():
    """Prevent triangles that squeeze the whole painting into the seam."""
    mesh = load_head()
    place = compute_vertex_chart(mesh)
    skin = mesh.parts[mesh.triangles[:, 0]] == 0
    assert (np.ptp(place[mesh.triangles[skin], 0], axis=1) > CHART_WIDTH / 2).sum() > 20
    sources, cut, triangles = unroll_mesh(place, mesh.triangles, skin)
    np.testing.assert_array_equal(sources[triangles], mesh.triangles)
    moved = cut - place[sources]
    assert set(np.unique(moved[:, 0])) <= {0.0, CHART_WIDTH}
    assert np.all(moved[:, 1:] == 0.0)
    wide = np.ptp(cut[triangles[skin], 0], axis=1) > CHART_WIDTH / 2
    heights = mesh.positions[mesh.triangles[skin][wide], 2]
    assert wide.sum() < 8
    assert np.all(heights > 0.08)  # only around the crown, the pole of the chart


def test_teeth_are_not_split_at_the_chart_seam():
    """Allow chart attributes of teeth [mm] beyond the skin chart's width."""
    mesh = load_head()
    place = compute_vertex_chart(mesh)
    first = mesh.triangles[:, 0]
    sources, _, triangles = unroll_mesh(place, mesh.triangles, mesh.parts[first] == MESH_PARTS.index("skin"))
    teeth = mesh.parts[first] == MESH_PARTS.index("teeth")
    assert np.ptp(place[mesh.triangles[teeth], 0], axis=1).max() > CHART_WIDTH / 2
    np.testing.assert_array_equal(triangles[teeth], mesh.triangles[teeth])
    assert np.all(mesh.parts[sources[len(mesh.positions) :]] == MESH_PARTS.index("skin"))


def test_mesh_faces_with_painted_skin_do_not_cross_the_seam_of_the_texture_chart():
    mesh = load_head()
    place = compute_vertex_chart(mesh)
    corners = place[mesh.faces]
    shown = (corners[..., 2].max(axis=1) > 0.0) & (mesh.parts[mesh.faces[:, 0]] == 0)
    assert np.ptp(corners[shown, :, 0], axis=1).max() < 1.0


def test_texture_chart_of_eye_vertices_contains_unit_directions():
    mesh = load_head()
    eyes = compute_vertex_chart(mesh)[mesh.vertices("eyes")]
    np.testing.assert_allclose(np.linalg.norm(eyes[:, :3], axis=1), 1.0)


def test_painted_range_of_the_texture_chart_maps_to_the_unit_square():
    scale_a, scale_y, offset_a, offset_y = compute_chart_window()
    np.testing.assert_allclose(np.array(WINDOW_LEFT_RIGHT) * scale_a + offset_a, (0, 1), atol=1e-12)
    np.testing.assert_allclose(np.array(WINDOW_LOW_HIGH) * scale_y + offset_y, (0, 1), atol=1e-12)


def test_hairline_height_is_positive_on_the_scalp_and_negative_on_the_face():
    actual = measure_hairline_height(np.array([[-1.2, 0.0, 1.8], [-2.9, 0.0, 0.0], [0.4, 0.0, 0.5], [0.0, 0.9, -0.5]]))
    assert (actual > 0).tolist() == [True, True, False, False]


def test_mouth_depth_is_positive_inside_the_mouth_and_zero_at_nose_chin_and_back_of_head():
    mesh = load_head()
    inside = measure_mouth_depth(mesh)
    forward, left, up = (mesh.positions / (mesh.eyes[0, 1] - mesh.eyes[1, 1])).T
    assert (inside > 0.5).sum() > 30
    assert np.all(inside[forward < -1.0] == 0.0)
    nose, chin = np.argmax(forward), np.argmax(np.where((np.abs(left) < 0.05) & (up < -1.5), forward, -9.0))
    assert inside[nose] == inside[chin] == 0.0
    lips = (np.abs(left) < 0.3) & (np.abs(up + 1.09) < 0.25) & (forward > 0.45)
    assert np.all(inside[lips] < 0.5)
