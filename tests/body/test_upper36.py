"""What the robot with hands is made of."""

import numpy as np
import pytest

from kinesic.body.robot import SIDES, Robot
from kinesic.hardware.protocol.servo_map import ServoMap

ROBOT, PLAIN = Robot.load("upper36"), Robot.load("upper22")


def test_it_is_upper22_with_seven_drives_and_seventeen_joints_in_each_hand():
    own = [name for name in ROBOT.skeleton.names if name not in PLAIN.skeleton.names]
    assert set(PLAIN.skeleton.names) < set(ROBOT.skeleton.names)
    assert len(ROBOT.skeleton.hinges) == 36
    for side in SIDES:
        drives = [name for name in own if name.startswith(side)]
        couplings = [c for c in ROBOT.skeleton.couplings if c.name.startswith(side)]
        assert (len(drives), len(couplings), len(ROBOT.fingers(side))) == (7, 11, 15)
    assert PLAIN.fingers("l") == ()


def test_37_servos_are_on_two_buses():
    servos = ServoMap.of(ROBOT)
    count = {bus.name: sum(len(s.ids) for s in servos.servos if s.bus == bus.name) for bus in servos.buses}
    assert count == {"left": 22, "right": 15}


def test_equal_angles_are_mirror_postures():
    random = np.random.default_rng(3)
    angles = random.uniform(ROBOT.skeleton.lower, ROBOT.skeleton.upper)
    angles[:6] = 0.0
    swapped = angles.copy()
    names = ROBOT.skeleton.names
    for k, name in enumerate(names[6:], 6):
        swapped[k] = angles[names.index(f"{'r' if name[0] == 'l' else 'l'}{name[1:]}")]
    here, there = ROBOT.skeleton.frames(angles), ROBOT.skeleton.frames(swapped)
    for left in ROBOT.fingers("l"):
        a, b = ROBOT.skeleton.segment(left), ROBOT.skeleton.segment(f"r{left[1:]}")
        np.testing.assert_allclose(here.origins[a] * [1, -1, 1], there.origins[b], atol=1e-12)


@pytest.mark.parametrize("finger", ["index", "middle", "ring", "pinky"])
def test_a_closed_finger_bends_by_all_its_joints(finger: str):
    straight = np.zeros(36)
    closed = straight.copy()
    joint = ROBOT.skeleton.joint(f"l_{finger}_flexion1")
    closed[joint] = ROBOT.skeleton.upper[joint]
    tip, hand = (ROBOT.skeleton.segment(f"l_{name}") for name in (f"{finger}3", "wrist"))
    frames = ROBOT.skeleton.frames(closed)
    along = (frames.rotations[hand].T @ frames.rotations[tip])[:, 2]
    bend = np.degrees(np.arctan2(along[1], along[2])) % 360
    assert bend == pytest.approx(80 * (1 + 1.05 + 0.67), abs=0.1)


def test_hands_weigh_and_reach_what_the_sheet_says():
    frames = ROBOT.skeleton.straight
    wrist = frames.origins[ROBOT.skeleton.segment("l_wrist")]
    tip = frames.origins[ROBOT.skeleton.segment("l_middle3")] - [0, 0, 0.015]
    assert np.linalg.norm(tip - wrist) == pytest.approx(0.129, abs=0.002)
    mass = sum(s.mass for s in ROBOT.skeleton.segments if s.name in ("l_wrist", *ROBOT.fingers("l")))
    assert mass == pytest.approx(0.08, abs=0.005)
    assert ROBOT.arm_length == PLAIN.arm_length
