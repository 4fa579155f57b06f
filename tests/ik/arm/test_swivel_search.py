import numpy as np
import pytest

from kinesic.body.robot import Robot
from kinesic.ik.arm.linkage import linkage_of
from kinesic.ik.arm.swivel import swivel
from kinesic.ik.scalar3 import Rotation, vector

from ...reference.ik.shoulder_elbow import place_of
from ...reference.ik.swivel_search import GIRDLE_STEPS, SWIVEL_STEPS, cell_at, cells, present_swivel

LEFT_ARM = Robot.load().arms["l"]  # chain of the left arm
ARM_LINKAGE = linkage_of(LEFT_ARM)  # linkage of the left arm
ARM_POSTURE = np.array([0.1, 0.6, 0.4, -0.3, 1.2, 0.2, 0.1, -0.1])  # [rad] angles of the arm's hinges
HAND_TARGET = vector(LEFT_ARM.hand(ARM_POSTURE))  # [m] hand position in this posture


def _still(frame: Rotation) -> tuple[tuple[float, ...], float]:
    return (0.2, 0.1, -0.1), 0.0


def test_swivel_search_starts_with_the_current_arm_posture():
    first = next(cells(ARM_LINKAGE, HAND_TARGET, _still, near=ARM_POSTURE.tolist()))
    assert first.angles == pytest.approx(ARM_POSTURE.tolist(), abs=1e-9)
    assert first.cost < 1e-9


def test_postures_of_the_swivel_search_are_in_range_and_report_their_errors():
    seen = list(cells(ARM_LINKAGE, HAND_TARGET, _still, near=ARM_POSTURE.tolist()))
    assert len(seen) == SWIVEL_STEPS * (GIRDLE_STEPS + 1)
    for cell in seen:
        angles = np.array(cell.angles)
        assert np.all((LEFT_ARM.lower <= angles) & (angles <= LEFT_ARM.upper))
        assert cell.miss == pytest.approx(np.linalg.norm(LEFT_ARM.hand(angles) - HAND_TARGET), abs=1e-9)
    assert sum(cell.miss < 1e-9 for cell in seen) > SWIVEL_STEPS


def test_collar_bone_stays_if_excluded_from_the_swivel_search():
    seen = list(cells(ARM_LINKAGE, HAND_TARGET, _still, near=ARM_POSTURE.tolist(), girdle=False))
    assert len(seen) == SWIVEL_STEPS
    assert {round(cell.angles[0], 9) for cell in seen} == {0.1}


def test_posture_found_by_the_swivel_search_has_the_requested_swivel():
    place = place_of(ARM_LINKAGE, ARM_POSTURE.tolist(), HAND_TARGET)
    now = present_swivel(ARM_LINKAGE, ARM_POSTURE.tolist())
    cell = cell_at(ARM_LINKAGE, place, now + 0.2, _still, near=ARM_POSTURE.tolist())
    assert cell.miss < 1e-9
    assert swivel(LEFT_ARM, np.array(cell.angles)) == pytest.approx(now + 0.2, abs=1e-9)
