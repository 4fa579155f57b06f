"""Targets of a Reachy Mini: meaning, limits, and random blocks at 50 Hz."""

from math import radians
from random import Random

import numpy as np
import pytest

from kinesic.body.robot import Robot
from kinesic.hardware.reachy_mini.targets import Puppet, ReachyTarget
from kinesic.session.plan import plan_document
from kinesic.session.setup import set_up

from .daemon import find_fault

ROBOT = Robot.load("upper22")
PUPPET = Puppet(ROBOT)


def target(**degrees: float) -> ReachyTarget:
    """Return the target of the rest posture with some hinges at other angles [deg]."""
    angles = np.array(ROBOT.skeleton.rest)
    for name, angle in degrees.items():
        angles[ROBOT.skeleton.joint(name)] = radians(angle)
    return PUPPET.target(angles)


def test_rest_posture_looks_ahead_with_hanging_antennas():
    rest = target()
    assert (rest.roll, rest.pitch, rest.yaw, rest.body_yaw) == pytest.approx((0.0, 0.0, 0.0, 0.0), abs=1e-12)
    assert rest.antennas == pytest.approx((-0.17, 0.17))


@pytest.mark.parametrize(("hinge", "field"), [("roll", "roll"), ("tilt", "pitch"), ("torsion", "yaw")])
def test_head_turns_like_the_head_of_the_humanoid(hinge: str, field: str):
    turned = target(**{f"skullbase_{hinge}": 20.0})
    values = {name: getattr(turned, name) for name in ("roll", "pitch", "yaw")}
    assert values.pop(field) == pytest.approx(radians(20.0))
    assert list(values.values()) == pytest.approx([0.0, 0.0], abs=1e-9)


def test_body_turns_with_the_trunk_and_the_head_with_both():
    turned = target(vl5_torsion=30.0, skullbase_torsion=40.0)
    assert turned.body_yaw == pytest.approx(radians(30.0))
    assert turned.yaw == pytest.approx(radians(70.0))


def test_head_looks_down_if_the_trunk_leans_forward():
    assert target(vl5_tilt=20.0).pitch == pytest.approx(radians(20.0))


def test_body_follows_a_head_that_turns_by_more_than_60_degrees():
    turned = target(vl5_torsion=-20.0, skullbase_torsion=-75.0)
    assert turned.yaw - turned.body_yaw == pytest.approx(radians(-60.0))


def test_inclination_of_the_head_is_limited_to_35_degrees_in_its_direction():
    inclined = target(skullbase_tilt=40.0, vl5_tilt=35.0)
    assert np.hypot(inclined.roll, inclined.pitch) == pytest.approx(radians(35.0))


def test_raised_hand_moves_only_the_antenna_of_its_side_outward():
    right, left = target(r_shoulder_flexion=90.0).antennas
    assert right < -0.8
    assert left == pytest.approx(0.17)
    assert target(l_shoulder_flexion=90.0).antennas[1] == pytest.approx(-right)


def test_robot_without_head_and_trunk_moves_the_antennas_alone():
    pair = Robot.load("so101_pair")
    angles = np.array(pair.skeleton.rest)
    angles[pair.skeleton.joint("l_elbow_flexion")] = radians(120.0)
    moved = Puppet(pair).target(angles)
    assert (moved.roll, moved.pitch, moved.yaw, moved.body_yaw) == (0.0, 0.0, 0.0, 0.0)
    assert moved.antennas[1] > 0.3


def test_targets_of_random_postures_are_within_the_limits_of_the_daemon():
    chance = np.random.default_rng(51)
    skeleton = ROBOT.skeleton
    for angles in chance.uniform(skeleton.lower, skeleton.upper, (200, len(skeleton.names))):
        assert find_fault(PUPPET.target(angles).as_message()) is None


def random_block(chance: Random, lexemes: list[str]) -> str:
    """Return a block with a gesture, and a motion of the head or the trunk."""
    mode, side = chance.choice(("LEFT_HAND", "RIGHT_HAND", "BOTH_HANDS")), chance.choice(("left", "right", "audience"))
    other = chance.choice(
        (
            f'<head id="h" lexeme="{chance.choice(("NOD", "SHAKE"))}" amount="{chance.random():.2f}"/>',
            f'<gazeShift id="z" target="{side}"/>',
            f'<pointing id="p" target="{side}" start="g:end"/>',
            '<posture id="o" start="0" end="2"><pose part="WHOLEBODY" lexeme="LEANING_FORWARD"/></posture>',
        )
    )
    gesture = f'<gesture id="g" lexeme="{chance.choice(lexemes)}" mode="{mode}"/>'
    return f'<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">{gesture}{other}</bml>'


@pytest.mark.parametrize("count", [2, pytest.param(10_000, marks=pytest.mark.soak)])
def test_daemon_refuses_no_target_of_random_blocks_at_50_hz(count: int):
    setup, chance = set_up("upper22"), Random(51)
    lexemes = [form.id for form in setup.lexicon.forms]
    for _ in range(count):
        trajectory = plan_document(random_block(chance, lexemes), setup).trajectory
        for angles in trajectory.angles(np.arange(0.0, trajectory.duration, 0.02)):
            assert find_fault(PUPPET.target(angles).as_message()) is None
