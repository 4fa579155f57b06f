"""Position of the eye site on synthetic heads, turning or fixed."""

from types import SimpleNamespace

import numpy as np
import pytest

from kinesic.body.skeleton import Capsule
from kinesic.sim.importer.eyes import _find_front, place_eyes
from kinesic.sim.importer.hinge_row import list_surface_points
from kinesic.sim.importer.mesh_file import Triangles
from kinesic.sim.importer.model_tree import ModelPart, Surface
from kinesic.sim.importer.segments import SegmentLayout

X, Y, Z = np.eye(3)
ORIGIN = np.array([0.01, 0.0, 1.0])
SHOULDER = np.array([0.02, 0.2, 1.4])


def part(*points, centre=0 * X):
    mesh = Triangles(np.array(points, dtype=float), np.array([[0, 1, 2]]))
    return ModelPart(1.0, centre, (), (Surface(mesh, dark=False),) if points else ())


def place(neck, lumps, carried=None, parents=("humanoid_root",)):
    tree = SimpleNamespace(below=lambda k: (k, "end"), merge_parts=lambda parts: lumps[parts])
    figure = SimpleNamespace(
        arm_length=2.0, neck=neck, tree=tree, arms={"l": SimpleNamespace(centres=SimpleNamespace(shoulder=SHOULDER))}
    )
    layout = SegmentLayout(dict.fromkeys(parents, "world"), dict.fromkeys(("skullbase", *parents), ORIGIN))
    return place_eyes(figure, layout, carried or {})


def column(x, low, high, count=12, y=0.0):
    """Return points of a vertical line whose foremost is in its middle."""
    return [(x - abs(z - (low + high) / 2), y, z) for z in np.linspace(low, high, count)]


def test_eyes_of_a_turning_head_are_on_its_last_part():
    site = place((4, 5), {(5, "end"): part(*column(0.3, 1.6, 1.9, 13)), (4, "end"): part(centre=9 * X)})
    assert (site.body, site.facing) == ("skullbase", (1.0, 0.0, 0.0))
    assert site.at == pytest.approx((0.29, 0.0, 0.75))


def test_eyes_of_a_head_without_shapes_are_in_front_of_the_neck_centre():
    site = place((4, 5), {(5, "end"): part(centre=9 * X), (4, "end"): part(centre=1.5 * Z + 0.02 * Y)})
    assert site.body == "skullbase"
    assert site.at == pytest.approx((0.34 - 0.01, 0.02, 0.5 + 0.2 * 0.34))


def test_eyes_of_a_fixed_head_are_placed_above_the_shoulders_of_the_trunk():
    head, chest = column(0.3, 1.71, 2.01, 13), [(0.9, 0.0, 1.69), (0.9, 0.51, 1.86), (0.9, -0.51, 1.86)]
    points = part(*chest, *head, (0.4, 0.49, 1.86), (0.4, -0.49, 1.86))
    site = place((), {(7, 8): points}, {"vl5": (7, 8)}, ("humanoid_root", "vl5"))
    assert (site.body, site.facing) == ("vl5", (1.0, 0.0, 0.0))
    assert site.at == pytest.approx((0.39, 0.0, 0.86))


@pytest.mark.parametrize("carried", [{}, {"humanoid_root": ()}, {"humanoid_root": (7,)}])
def test_eyes_of_a_robot_without_a_head_are_in_front_of_and_above_the_shoulders(carried):
    site = place((), {(7,): part(*column(0.3, 0.1, 1.6, 40))}, carried)
    assert (site.body, site.facing) == ("humanoid_root", (1.0, 0.0, 0.0))
    assert site.at == pytest.approx((0.02 + 0.34 - 0.01, 0.0, 0.4 + 0.7))


def test_surface_points_of_a_part_come_from_its_meshes_or_else_its_shapes():
    capsule = Capsule(Z, 2 * Z, 0.5)
    mesh = part((1, 2, 3), (4, 5, 6), (7, 8, 9))
    both = ModelPart(1.0, X, (capsule,), mesh.surfaces + part((0, 0, 1)).surfaces)
    np.testing.assert_array_equal(list_surface_points(both), [(1, 2, 3), (4, 5, 6), (7, 8, 9), (0, 0, 1)])
    ends = np.array([0.5 * X, 0.5 * Y, 0.5 * Z, -0.5 * X, -0.5 * Y, -0.5 * Z])
    found = list_surface_points(ModelPart(1.0, X, (capsule,)))
    np.testing.assert_array_equal(found, [*(Z + ends), *(2 * Z + ends)])
    assert list_surface_points(part()).shape == (0, 3)


def test_front_of_a_head_is_found_only_from_at_least_twelve_surface_points():
    assert _find_front(np.array(column(0.3, 0.0, 0.3, 11)), 1.0) is None
    assert _find_front(np.array(column(0.3, 0.0, 0.3, 12)), 1.0) is not None


def test_front_of_a_head_is_its_foremost_point_at_half_its_height():
    points = np.array([*column(0.3, 1.0, 1.4, 13), (0.8, 0.1, 1.37), (0.5, 0.3, 1.05)])
    assert _find_front(points, 2.0) == pytest.approx((0.8, 0.0, 1.2))
    assert _find_front(points, 1.8) == pytest.approx((0.5, 0.0, 1.2))
    assert _find_front(points, 1.6) == pytest.approx((0.3, 0.0, 1.2))


def test_head_is_assumed_to_end_0_6_arm_lengths_below_its_top():
    points = np.array([*column(0.3, 0.0, 3.0, 61), (0.7, 0.0, 2.4)])
    assert _find_front(points, 2.0) == pytest.approx((0.7, 0.0, 2.4))
    assert _find_front(points, 6.0) == pytest.approx((0.3, 0.0, 1.5))


def test_head_without_points_at_half_its_height_has_no_front():
    points = np.array([(0.1, 0.0, z) for z in (0.0, 1.0) for _ in range(6)])
    assert _find_front(points, 2.0) is None
