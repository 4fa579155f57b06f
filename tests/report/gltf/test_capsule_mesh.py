from types import ModuleType

import numpy as np
import pytest

from kinesic.body.skeleton import Capsule
from kinesic.report.gltf.capsule_mesh import capsule_mesh, join_surfaces


@pytest.mark.parametrize("end", [(0.0, 0.0, 0.3), (0.2, -0.1, 0.0), (0.0, 0.0, 0.0)], ids=["upright", "across", "ball"])
def test_capsule_mesh_is_closed_and_faces_outward(trimesh: ModuleType, end: tuple[float, float, float]):
    capsule = Capsule(np.zeros(3), np.array(end), 0.05)
    surface = capsule_mesh(capsule)
    mesh = trimesh.Trimesh(surface.positions, surface.corners)
    length = float(np.linalg.norm(end))
    assert mesh.is_watertight
    assert mesh.volume == pytest.approx(np.pi * 0.05**2 * (length + 4 / 3 * 0.05), rel=0.06)
    nearest = np.clip(surface.positions @ end / max(length**2, 1e-12), 0.0, 1.0)[:, None] * end
    np.testing.assert_allclose(np.linalg.norm(surface.positions - nearest, axis=1), 0.05, atol=1e-12)
    np.testing.assert_allclose(surface.positions - nearest, 0.05 * surface.normals, atol=1e-12)


def test_joined_capsule_meshes_number_their_vertices_consecutively():
    one = capsule_mesh(Capsule(np.zeros(3), np.array([0.0, 0.0, 0.1]), 0.05))
    both = join_surfaces([one, one])
    assert both.corners.max() == 2 * len(one.positions) - 1


def test_triangles_of_a_capsule_run_anticlockwise_seen_from_outside():
    surface = capsule_mesh(Capsule(np.array([0.1, 0.0, 0.0]), np.array([0.1, 0.2, 0.3]), 0.04))
    a, b, c = (surface.positions[surface.corners[:, k]] for k in range(3))
    across = np.cross(b - a, c - a)
    outward = surface.normals[surface.corners].sum(axis=1)
    assert (np.einsum("ti,ti->t", across, outward) > 0.0).all()


def test_joined_capsule_meshes_keep_the_positions_of_each_triangle():
    one = capsule_mesh(Capsule(np.zeros(3), np.array([0.0, 0.0, 0.1]), 0.05))
    other = capsule_mesh(Capsule(np.ones(3), np.array([1.0, 1.2, 1.0]), 0.02))
    both = join_surfaces([one, other])
    expected = np.concatenate([one.positions[one.corners], other.positions[other.corners]])
    np.testing.assert_array_equal(both.positions[both.corners], expected)
    assert both.normals.shape == both.positions.shape
