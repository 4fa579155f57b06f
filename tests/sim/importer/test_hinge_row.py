import numpy as np
import pytest

from kinesic.sim.importer.hinge_row import HingeRow, common_point, distances, foot, nearest_to_line

X, Y, Z = np.eye(3)


def test_lines_that_meet_meet_there():
    point = np.array([0.1, 0.2, 0.3])
    anchors = np.array([point + 0.5 * X, point - 0.2 * Y, point + Z])
    assert common_point(anchors, np.eye(3), np.zeros(3)) == pytest.approx(point, abs=1e-3)
    assert distances(point, anchors, np.eye(3)) == pytest.approx(np.zeros(3), abs=1e-12)


def test_what_parallel_lines_leave_open_is_near_the_wish():
    found = common_point(np.array([[0.0, 0, 0], [0, 0, 1]]), np.array([Z, Z]), np.array([0.0, 0, 0.4]))
    assert found == pytest.approx([0, 0, 0.4])


def test_feet_and_nearest_points():
    assert foot(np.array([1.0, 2, 3]), np.zeros(3), Z) == pytest.approx([0, 0, 3])
    assert nearest_to_line(np.zeros(3), X, np.array([0.7, 0.1, 5.0]), Z) == pytest.approx([0.7, 0, 0])


def test_a_turned_limb_is_the_turned_tree(tee):
    names = [joint.name for joint in tee.joints]
    row = [names.index(f"l_{part}") for part in ("pitch", "roll", "twist", "bend", "turn", "nod", "wag")]
    angles = np.linspace(-1, 1, 7)
    limb, tree = HingeRow.of(tee, row).turned(angles), tee.turned(dict(zip(row, angles, strict=True)))
    assert limb.anchors == pytest.approx(np.array([tree.joints[k].anchor for k in row]))
    assert limb.axes == pytest.approx(np.array([tree.joints[k].axis for k in row]))
    assert limb.centre == pytest.approx(tree.lump(tree.below(row[-1])).centre)
