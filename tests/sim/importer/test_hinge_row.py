import numpy as np
import pytest

from kinesic.sim.importer.hinge_row import HingeRow, distances, find_common_point, find_nearest_on_line, foot

X_AXIS, Y_AXIS, Z_AXIS = np.eye(3)


def test_common_point_of_intersecting_lines_is_their_intersection():
    point = np.array([0.1, 0.2, 0.3])
    anchors = np.array([point + 0.5 * X_AXIS, point - 0.2 * Y_AXIS, point + Z_AXIS])
    assert find_common_point(anchors, np.eye(3), np.zeros(3)) == pytest.approx(point, abs=1e-3)
    assert distances(point, anchors, np.eye(3)) == pytest.approx(np.zeros(3), abs=1e-12)


def test_common_point_of_parallel_lines_is_nearest_to_the_preferred_point():
    common_point = find_common_point(
        np.array([[0.0, 0, 0], [0, 0, 1]]), np.array([Z_AXIS, Z_AXIS]), np.array([0.0, 0, 0.4])
    )
    assert common_point == pytest.approx([0, 0, 0.4])


def test_line_projection_and_nearest_point_of_two_lines_match_known_values():
    assert foot(np.array([1.0, 2, 3]), np.zeros(3), Z_AXIS) == pytest.approx([0, 0, 3])
    assert find_nearest_on_line(np.zeros(3), X_AXIS, np.array([0.7, 0.1, 5.0]), Z_AXIS) == pytest.approx([0.7, 0, 0])


def test_hinge_chain_at_given_angles_equals_the_chain_of_the_whole_model(tee):
    names = [joint.name for joint in tee.joints]
    row = [names.index(f"l_{part}") for part in ("pitch", "roll", "twist", "bend", "turn", "nod", "wag")]
    angles = np.linspace(-1, 1, 7)
    limb, tree = HingeRow.of(tee, row).turned(angles), tee.turned(dict(zip(row, angles, strict=True)))
    assert limb.anchors == pytest.approx(np.array([tree.joints[k].anchor for k in row]))
    assert limb.axes == pytest.approx(np.array([tree.joints[k].axis for k in row]))
    assert limb.centre == pytest.approx(tree.merge_parts(tree.below(row[-1])).centre)
