"""Tests that the G-buffer unpacks to the drawn geometry."""

import numpy as np
import pytest
from scipy.spatial import cKDTree

from kinesic.face.assets.action_units import deform
from kinesic.face.assets.mesh import MESH_PARTS
from kinesic.face.render.camera import Camera
from kinesic.face.render.geometry import PositionPass
from kinesic.face.render.portrait import Portrait

SMILE_UNITS = {"26": 0.7, "12": 0.4}


@pytest.mark.parametrize("yaw", [0.0, 70.0])
def test_g_buffer_pixels_lie_on_their_reported_part(portrait: Portrait, yaw: float):
    geometry, camera = portrait.pipeline.geometry, Camera(yaw_deg=yaw)
    with geometry.context:
        geometry.draw(SMILE_UNITS, camera)
        parts, positions = geometry.parts(), geometry.positions()
    assert set(np.unique(parts)) <= {*range(len(MESH_PARTS)), len(MESH_PARTS) + 1}  # the last index means locks of hair
    view, mesh = camera.view(), portrait.mesh
    corners = deform(mesh, SMILE_UNITS)[mesh.triangles]
    surface = np.einsum("bk,tkc->tbc", np.random.default_rng(1).dirichlet((1.0, 1.0, 1.0), 24), corners)
    for number in range(MESH_PARTS.index("lashes")):  # lashes and later parts are drawn over the picture
        seen = positions[parts == number + 1]
        assert len(seen) > 20 or yaw > 0.0 or MESH_PARTS[number] == "cloth"
        part = surface[mesh.parts[mesh.triangles[:, 0]] == number].reshape(-1, 3)
        away, _ = cKDTree(part).query((seen - view[:3, 3]) @ view[:3, :3])
        assert not len(away) or np.percentile(away, 99) < (0.006 if number == 0 else 0.002)  # [m] hair stands off


@pytest.mark.parametrize("pixels", [1, 2])
def test_position_unpacking_at_low_resolution_uses_the_middle_pixel_of_each_tile(portrait: Portrait, pixels: int):
    geometry = portrait.pipeline.geometry
    with geometry.context as context:
        geometry.draw(SMILE_UNITS, Camera(yaw_deg=20.0))
        parts, positions, whole = geometry.parts(), geometry.positions(), geometry.target.read(0)
        unpacked = PositionPass(context, geometry, pixels)
        unpacked.draw()
        seen, normal = (unpacked.target.read(number) for number in (0, 1))
    rows, columns = slice(pixels - 1 - pixels // 2, None, pixels), slice(pixels // 2, None, pixels)  # from top and left
    np.testing.assert_array_equal(seen[..., 3], parts[rows, columns])
    head = parts[rows, columns] > 0
    np.testing.assert_allclose(seen[head, :3], positions[rows, columns][head], atol=1e-6)
    np.testing.assert_array_equal(normal[head, :3], whole[rows, columns][head, :3])


def test_hair_is_drawn_over_the_scalp_but_not_the_face(portrait: Portrait):
    geometry = portrait.pipeline.geometry
    with geometry.context:
        geometry.draw({}, Camera())
        front = geometry.parts() == len(MESH_PARTS) + 1
        geometry.draw({}, Camera(yaw_deg=180.0))
        back = geometry.parts()
    side = portrait.size[0]
    assert front[: side // 6].any()
    assert not front[side // 4 : 3 * side // 4, 2 * side // 5 : 3 * side // 5].any()
    assert (back == len(MESH_PARTS) + 1).sum() > 0.6 * (back[: side // 2] > 0).sum()
