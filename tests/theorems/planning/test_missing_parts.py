"""Robots with missing parts perform the remaining motion and report omissions."""

from collections.abc import Callable

import pytest

from kinesic.body.robot import Robot
from kinesic.expressivity.gaze import from_eyes
from kinesic.planning.plan import Plan
from kinesic.session.plan import plan
from kinesic.session.setup import set_up
from tests.reduced_robots import write_robot

BML_BLOCK = (
    '<bml id="b"><gesture id="both" lexeme="large" stroke="1.5"/><gesture id="there" lexeme="point_left" stroke="4"/>'
    '<pointing id="named" target="right" stroke="7"/><gaze id="look" target="left" start="9" end="10"/>'
    '<head id="nod" lexeme="NOD" stroke="10.5"/><torso id="lean" lexeme="LEAN_FORWARD" start="11" end="13"/>'
    '<gesture id="shrug" lexeme="shrug" stroke="14.5"/><face id="face" lexeme="smile" start="1"/>'
    '<posture id="bow" start="16" end="19"><pose part="ARMS" lexeme="ARMS_CROSSED"/>'
    '<pose part="HEAD" lexeme="DOWN"/></posture></bml>'
)


@pytest.fixture
def planned(tmp_path) -> Callable[..., Plan]:
    return lambda *missing: plan(BML_BLOCK, set_up(write_robot(tmp_path, *missing)), source="all.bml")


@pytest.mark.parametrize(
    "missing", [("neck",), ("torso",), ("clavicles",), ("neck", "torso", "clavicles")], ids="-".join
)
def test_robot_without_some_body_parts_drops_only_their_behaviours(planned, missing):
    result = planned(*missing)
    lacking = {id: each.why for id, each in result.keyframes.outcomes.items() if each.kind == "dropped"}
    expected = {"neck": ("look", "nod"), "torso": ("lean",), "clavicles": ()}
    assert set(lacking) == {id for part in missing for id in expected[part]}
    assert all("has no" in why for why in lacking.values())
    assert ("no neck" in result.keyframes.outcomes["bow"].why) == ("neck" in missing)


def test_audience_is_ahead_and_above_the_eyes_of_a_robot_without_neck(tmp_path):
    robot = Robot.load(write_robot(tmp_path, "neck"))
    x, y, z = from_eyes(robot.targets["audience"], robot)
    assert (x, y) == pytest.approx((2.0, 0.0))
    assert z > 0
