import numpy as np
import pytest

from kinesic.sim.importer.arm import Split, centres
from kinesic.sim.importer.hanging_pose import elbow_sense
from kinesic.sim.importer.hinge_row import HingeRow
from kinesic.sim.importer.zero_pose import HANGING, hang_arm

SPLIT = Split(0, 3, 3)


@pytest.fixture
def row(tee):
    names = [joint.name for joint in tee.joints]
    return tuple(names.index(f"l_{part}") for part in ("pitch", "roll", "twist", "bend", "turn", "nod", "wag"))


def test_an_arm_of_a_t_pose_is_hung_up(tee, row):
    posed = hang_arm(tee, row, SPLIT, HANGING, strict=False)
    assert np.degrees(posed.off) < 0.5
    assert np.degrees(posed.angles[1]) == pytest.approx(-90, abs=0.5)
    at = centres(HingeRow.of(tee, row).turned(posed.angles), SPLIT)
    assert at.wrist == pytest.approx(at.shoulder - [0, 0, sum(at.lengths)], abs=0.005)


def test_ranges_hold_where_they_must(tee, row):
    roll = tee.joints[row[1]]
    posed = hang_arm(tee, row, SPLIT, HANGING, strict=True)
    assert roll.lower - 1e-6 <= posed.angles[1] <= roll.upper + 1e-6


def test_an_elbow_bends_where_its_range_lies(tee, row):
    limb = HingeRow.of(tee, row)
    assert elbow_sense(limb, SPLIT, -2.4, 0.1) == -1.0
    assert elbow_sense(limb, SPLIT, -0.1, 2.4) == 1.0
    assert elbow_sense(limb, SPLIT, -2.0, 2.0) == 0.0
    assert elbow_sense(limb, SPLIT, -np.inf, np.inf) == 0.0
