import numpy as np
import pytest

from kinesic.sim.importer.arm import Split, centres
from kinesic.sim.importer.hanging_pose import find_elbow_sense
from kinesic.sim.importer.hinge_row import HingeRow
from kinesic.sim.importer.zero_pose import HANGING_ARM, hang_arm

ARM_SPLIT = Split(0, 3, 3)


@pytest.fixture
def row(tee):
    names = [joint.name for joint in tee.joints]
    return tuple(names.index(f"l_{part}") for part in ("pitch", "roll", "twist", "bend", "turn", "nod", "wag"))


def test_imported_arm_in_t_pose_is_turned_to_hang_straight_down(tee, row):
    posed = hang_arm(tee, row, ARM_SPLIT, HANGING_ARM, strict=False)
    assert np.degrees(posed.off) < 0.5
    assert np.degrees(posed.angles[1]) == pytest.approx(-90, abs=0.5)
    at = centres(HingeRow.of(tee, row).turned(posed.angles), ARM_SPLIT)
    assert at.wrist == pytest.approx(at.shoulder - [0, 0, sum(at.lengths)], abs=0.005)


def test_imported_arm_turned_to_hang_stays_within_its_narrow_joint_range(tee, row):
    roll = tee.joints[row[1]]
    posed = hang_arm(tee, row, ARM_SPLIT, HANGING_ARM, strict=True)
    assert roll.lower - 1e-6 <= posed.angles[1] <= roll.upper + 1e-6


def test_elbow_of_a_hanging_imported_arm_bends_towards_the_middle_of_its_range(tee, row):
    limb = HingeRow.of(tee, row)
    assert find_elbow_sense(limb, ARM_SPLIT, -2.4, 0.1) == -1.0
    assert find_elbow_sense(limb, ARM_SPLIT, -0.1, 2.4) == 1.0
    assert find_elbow_sense(limb, ARM_SPLIT, -2.0, 2.0) == 0.0
    assert find_elbow_sense(limb, ARM_SPLIT, -np.inf, np.inf) == 0.0
