import numpy as np
import pytest

from kinesic.body.choices import Variant
from kinesic.face.assets.chart import (
    CHART_WIDTH,
    LEFT_RIGHT,
    LIP,
    LOW_HIGH,
    chart_window,
    hair,
    mouth,
    unroll,
    vertex_chart,
)
from kinesic.face.assets.mesh import VARIANTS, load_head


@pytest.mark.parametrize("variant", VARIANTS)
def test_the_mask_is_nothing_at_every_vertex_behind(variant: Variant):
    mesh = load_head(variant)
    place, skin = vertex_chart(mesh), mesh.vertices("skin")
    forward = mesh.positions[skin, 0] / (mesh.eyes[0, 1] - mesh.eyes[1, 1])
    assert np.all(place[skin, 2][forward < -0.6] <= 0.0)
    outside = mouth(mesh)[skin] == 0.0
    assert np.all(place[skin, 2][(forward > -0.4) & outside] == 1.0)
    assert np.all(place[skin, 2][mouth(mesh)[skin] > LIP] < 1.0)


def test_the_seam_is_cut_open():
    """Painting and hair must not be squeezed into the triangles where the chart's ends meet."""
    mesh = load_head()
    place = vertex_chart(mesh)
    skin = mesh.parts[mesh.triangles[:, 0]] == 0
    assert (np.ptp(place[mesh.triangles[skin], 0], axis=1) > CHART_WIDTH / 2).sum() > 20
    sources, cut, triangles = unroll(place, mesh.triangles)
    np.testing.assert_array_equal(sources[triangles], mesh.triangles)
    moved = cut - place[sources]
    assert set(np.unique(moved[:, 0])) <= {0.0, CHART_WIDTH}
    assert np.all(moved[:, 1:] == 0.0)
    wide = np.ptp(cut[triangles[skin], 0], axis=1) > CHART_WIDTH / 2
    heights = mesh.positions[mesh.triangles[skin][wide], 2]
    assert wide.sum() < 8
    assert np.all(heights > 0.08)  # only round the crown, where the chart has its pole


def test_no_face_that_the_mask_lets_through_crosses_the_seam():
    mesh = load_head()
    place = vertex_chart(mesh)
    corners = place[mesh.faces]
    shown = (corners[..., 2].max(axis=1) > 0.0) & (mesh.parts[mesh.faces[:, 0]] == 0)
    assert np.ptp(corners[shown, :, 0], axis=1).max() < 1.0


def test_eyes_are_told_by_direction():
    mesh = load_head()
    eyes = vertex_chart(mesh)[mesh.vertices("eyes")]
    np.testing.assert_allclose(np.linalg.norm(eyes[:, :3], axis=1), 1.0)


def test_the_window_is_the_unit_square():
    scale_a, scale_y, offset_a, offset_y = chart_window()
    np.testing.assert_allclose(np.array(LEFT_RIGHT) * scale_a + offset_a, (0, 1), atol=1e-12)
    np.testing.assert_allclose(np.array(LOW_HIGH) * scale_y + offset_y, (0, 1), atol=1e-12)


def test_hair_grows_on_top_and_behind_but_not_on_the_face():
    found = hair(np.array([[-1.2, 0.0, 1.8], [-2.9, 0.0, 0.0], [0.4, 0.0, 0.5], [0.0, 0.9, -0.5]]))
    assert (found > 0).tolist() == [True, True, False, False]


def test_the_mouth_is_inside_the_face():
    mesh = load_head()
    inside = mouth(mesh)
    forward, left, up = (mesh.positions / (mesh.eyes[0, 1] - mesh.eyes[1, 1])).T
    assert (inside > 0.5).sum() > 30
    assert np.all(inside[forward < -1.0] == 0.0)
    nose, chin = np.argmax(forward), np.argmax(np.where((np.abs(left) < 0.05) & (up < -1.5), forward, -9.0))
    assert inside[nose] == inside[chin] == 0.0
    lips = (np.abs(left) < 0.3) & (np.abs(up + 1.09) < 0.25) & (forward > 0.45)
    assert np.all(inside[lips] < 0.5)
