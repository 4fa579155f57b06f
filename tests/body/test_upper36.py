"""Tests of the robot with hands: servos, mirrored fingers, mass, reach."""

import numpy as np
import pytest

from kinesic.body.robot import SIDES, Robot
from kinesic.hardware.protocol.servo_map import ServoMap

UPPER36, UPPER22 = Robot.load("upper36"), Robot.load("upper22")


def test_upper36_is_upper22_with_two_robot_hands():
    own = [name for name in UPPER36.skeleton.names if name not in UPPER22.skeleton.names]
    assert set(UPPER22.skeleton.names) < set(UPPER36.skeleton.names)
    assert len(UPPER36.skeleton.hinges) == 36
    for side in SIDES:
        drives = [name for name in own if name.startswith(side)]
        couplings = [c for c in UPPER36.skeleton.couplings if c.name.startswith(side)]
        assert (len(drives), len(couplings), len(UPPER36.fingers(side))) == (7, 11, 15)
    assert UPPER22.fingers("l") == ()


def test_upper36_has_37_servos_on_two_buses():
    servos = ServoMap.of(UPPER36)
    count = {bus.name: sum(len(s.ids) for s in servos.servos if s.bus == bus.name) for bus in servos.buses}
    assert count == {"left": 22, "right": 15}


def test_equal_left_and_right_angles_give_mirrored_fingers():
    random = np.random.default_rng(3)
    angles = random.uniform(UPPER36.skeleton.lower, UPPER36.skeleton.upper)
    angles[:6] = 0.0
    swapped = angles.copy()
    names = UPPER36.skeleton.names
    for k, name in enumerate(names[6:], 6):
        swapped[k] = angles[names.index(f"{'r' if name[0] == 'l' else 'l'}{name[1:]}")]
    here, there = UPPER36.skeleton.frames(angles), UPPER36.skeleton.frames(swapped)
    for left in UPPER36.fingers("l"):
        a, b = UPPER36.skeleton.segment(left), UPPER36.skeleton.segment(f"r{left[1:]}")
        np.testing.assert_allclose(here.origins[a] * [1, -1, 1], there.origins[b], atol=1e-12)


@pytest.mark.parametrize("finger", ["index", "middle", "ring", "pinky"])
def test_closed_finger_bends_by_the_sum_of_its_driven_and_coupled_joint_angles(finger: str):
    straight = np.zeros(36)
    closed = straight.copy()
    joint = UPPER36.skeleton.joint(f"l_{finger}_flexion1")
    closed[joint] = UPPER36.skeleton.upper[joint]
    tip, hand = (UPPER36.skeleton.segment(f"l_{name}") for name in (f"{finger}3", "wrist"))
    frames = UPPER36.skeleton.frames(closed)
    along = (frames.rotations[hand].T @ frames.rotations[tip])[:, 2]
    bend = np.degrees(np.arctan2(along[1], along[2])) % 360
    assert bend == pytest.approx(80 * (1 + 1.05 + 0.67), abs=0.1)


def test_upper36_hands_match_mass_and_reach_of_the_specification():
    frames = UPPER36.skeleton.zero_frames
    wrist = frames.origins[UPPER36.skeleton.segment("l_wrist")]
    tip = frames.origins[UPPER36.skeleton.segment("l_middle3")] - [0, 0, 0.015]
    assert np.linalg.norm(tip - wrist) == pytest.approx(0.129, abs=0.002)
    mass = sum(s.mass for s in UPPER36.skeleton.segments if s.name in ("l_wrist", *UPPER36.fingers("l")))
    assert mass == pytest.approx(0.08, abs=0.005)
    assert UPPER36.arm_length == UPPER22.arm_length
