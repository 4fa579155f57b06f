"""Paths, merged parts and motions of a synthetic tree of four hinges."""

import numpy as np
import pytest

from kinesic.body.skeleton import Capsule
from kinesic.sim.importer.mesh_file import Triangles
from kinesic.sim.importer.model_tree import BASE_INDEX, Follow, Joint, ModelPart, Surface, Tree

X, Y, Z = np.eye(3)
QUARTER_TURN = np.pi / 2
CORNERS = np.array([[0, 1, 2]], dtype=np.int32)


def joint(name, parent, anchor, axis, zero=0.0):
    return Joint(name, parent, anchor, axis, zero, None, None, None, None, None, None, None, None)


def part(mass, centre):
    surface = Surface(Triangles(np.array([centre, centre + X, centre + Y]), CORNERS), dark=mass > 2.5)
    return ModelPart(mass, centre, (Capsule(centre, centre + Z, 0.1 * mass),), (surface,))


# 0 carries 1, which carries 2; 3 is on the base.
TREE = Tree(
    "hand-made",
    (
        joint("a", BASE_INDEX, X, Z, 0.5),
        joint("b", 0, 2 * X, X),
        joint("c", 1, 3 * X, Y),
        joint("d", BASE_INDEX, -X, Z),
    ),
    (part(1.0, 1.5 * X), part(2.0, 2.5 * X), part(3.0, 4 * X), part(0.0, -2 * X)),
    part(4.0, 0 * X),
    ("a note",),
)


def test_tree_of_hinges_lists_children_paths_from_the_base_and_descendants():
    assert TREE.children == {BASE_INDEX: (0, 3), 0: (1,), 1: (2,), 2: (), 3: ()}
    assert [TREE.path_from_base(k) for k in (BASE_INDEX, 0, 2, 3)] == [(), (0,), (0, 1, 2), (3,)]
    assert [TREE.below(k) for k in (0, 2, 3)] == [(0, 1, 2), (2,), (3,)]


def test_merged_part_has_the_total_mass_at_the_common_centre_of_mass():
    both = TREE.merge_parts((0, BASE_INDEX))
    assert (both.mass, both.centre.tolist()) == (5.0, [0.3, 0, 0])
    assert [shape.radius for shape in both.shapes] == pytest.approx([0.1, 0.4])
    assert [surface.dark for surface in both.surfaces] == [False, True]


def test_massless_merged_part_has_its_centre_at_its_first_part():
    massless = TREE.merge_parts((3,))
    assert (massless.mass, massless.centre.tolist()) == (0.0, [-2, 0, 0])
    light = TREE.merge_parts((0, 3))
    assert (light.mass, light.centre.tolist()) == (1.0, [1.5, 0, 0])


def test_hinges_beyond_a_rotated_hinge_move_with_it():
    turned = TREE.turned({0: QUARTER_TURN, 1: QUARTER_TURN})
    np.testing.assert_allclose([j.anchor for j in turned.joints], (X, X + Y, X + 2 * Y, -X), atol=1e-12)
    np.testing.assert_allclose([j.axis for j in turned.joints], (Z, Y, Z, Z), atol=1e-12)
    assert [j.zero for j in turned.joints] == pytest.approx([0.5 + QUARTER_TURN, QUARTER_TURN, 0, 0])
    assert (turned.name, turned.left_out) == ("hand-made", ("a note",))
    assert [j.name for j in turned.joints] == ["a", "b", "c", "d"]


def test_part_moves_with_the_hinge_that_carries_the_part():
    turned = TREE.turned({0: QUARTER_TURN, 1: QUARTER_TURN})
    centres = [p.centre for p in (*turned.parts, turned.base)]
    np.testing.assert_allclose(centres, (X + 0.5 * Y, X + 1.5 * Y, X + 3 * Y, -2 * X, 0 * X), atol=1e-12)
    shape = turned.parts[1].shapes[0]
    np.testing.assert_allclose((shape.start, shape.end), (X + 1.5 * Y, 2 * X + 1.5 * Y), atol=1e-12)
    assert (shape.radius, turned.parts[1].mass) == (0.2, 2.0)
    (surface,) = turned.parts[1].surfaces
    corners = (X + 1.5 * Y, X + 2.5 * Y, X + 1.5 * Y + Z)
    np.testing.assert_allclose(surface.mesh.vertices, corners, atol=1e-12)
    np.testing.assert_array_equal(surface.mesh.corners, CORNERS)
    assert [p.surfaces[0].dark for p in turned.parts] == [False, False, True, False]


def test_whole_robot_is_rotated_before_it_is_translated():
    rotation = np.array([-Z, Y, X])
    moved = TREE.moved(rotation, 5 * Y)
    np.testing.assert_allclose([j.anchor for j in moved.joints], [5 * Y + k * Z for k in (1, 2, 3, -1)])
    np.testing.assert_allclose([j.axis for j in moved.joints], (-X, Z, Y, -X))
    np.testing.assert_allclose(moved.base.centre, 5 * Y)
    np.testing.assert_allclose(moved.parts[2].centre, 5 * Y + 4 * Z)
    assert [j.zero for j in moved.joints] == [0.5, 0, 0, 0]


def test_arrays_of_a_moved_robot_are_read_only():
    moved = TREE.moved(np.eye(3), X)
    arrays = (moved.joints[0].anchor, moved.joints[0].axis, moved.base.centre, TREE.merge_parts((0,)).centre)
    assert not any(array.flags.writeable for array in arrays)


def test_hinges_and_parts_have_no_coupling_and_no_mesh_by_default():
    assert TREE.joints[0].follows is None
    assert ModelPart(1.0, X, ()).surfaces == ()
    assert Tree("bare", (), (), TREE.base).left_out == ()
    assert Follow("driver", 2.0, 0.5) == Follow(driver="driver", ratio=2.0, offset=0.5)
