import numpy as np

from kinesic.face.assets.mesh import refine

CUBE = np.array([[x, y, z] for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)])
SIDES = np.array([[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]], dtype=np.int32)


def test_a_cube_becomes_what_catmull_and_clark_say():
    stencil, faces = refine(SIDES, 8)
    fine = stencil @ CUBE
    assert fine.shape == (8 + 12 + 6, 3)
    np.testing.assert_allclose(fine[:8], CUBE * 5 / 9)  # (F + 2 R + 0 P) / 3 with F = 1/3, R = 2/3
    np.testing.assert_allclose(np.sort(np.abs(fine[8:20]), axis=1), np.tile([0.0, 0.75, 0.75], (12, 1)), atol=1e-12)
    np.testing.assert_allclose(np.sort(np.abs(fine[20:]), axis=1), np.tile([0.0, 0.0, 1.0], (6, 1)), atol=1e-12)
    assert faces.shape == (24, 4)
    edges = np.stack([faces, np.roll(faces, -1, axis=1)], axis=2).reshape(-1, 2)
    assert len(np.unique(edges, axis=0)) == len(edges) == 96
    assert {tuple(edge[::-1]) for edge in edges} == {tuple(edge) for edge in edges}


def test_an_open_strip_keeps_its_border_a_spline_of_its_own():
    strip = np.array([[x, y, 0.0] for x in range(4) for y in (0.0, 1.0)])
    faces = np.array([[2 * k, 2 * k + 2, 2 * k + 3, 2 * k + 1] for k in range(3)], dtype=np.int32)
    stencil, _ = refine(faces, 8)
    fine = stencil @ strip
    np.testing.assert_allclose(fine[2], strip[2])  # in a straight border nothing moves
    np.testing.assert_allclose(np.abs(fine[:, 2]).max(), 0.0)
    assert fine[:, 1].min() >= 0.0
    assert fine[:, 1].max() <= 1.0


def test_every_new_vertex_is_a_mean():
    stencil, _ = refine(SIDES, 8)
    np.testing.assert_allclose(stencil.sum(axis=1), 1.0)
    assert stencil.min() >= 0.0
