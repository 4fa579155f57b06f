"""Robots that people own: their documents are performed within all limits."""

from functools import cache

import pytest

from kinesic.body.robot import Robot
from kinesic.hardware.protocol.servo_map import ServoMap
from kinesic.performer import Performer
from kinesic.sim.servo_factors import Factors

ROBOTS = ("so101_pair", "op3", "poppy_torso")
STROKE_POINTS = ("strokeStart", "stroke")
PLAY = 0.01745  # [rad] backlash of the gears of a worn hobby servo: 1 deg
MAX_STROKE_ERROR = 0.040  # [s] 95th percentile with play
GESTURES = (
    '<gesture id="g" lexeme="hello"/>',
    '<gesture id="g" lexeme="large" mode="BOTH_HANDS" stroke="1.5"/>',
    '<gesture id="g" lexeme="beat" mode="RIGHT_HAND"/><gesture id="h" lexeme="beat" mode="LEFT_HAND" start="g:end"/>',
    '<pointing id="p" target="left"/>',
    '<pointing id="p" target="right"/>',
    '<gesture id="g" lexeme="stop"/>',
    '<gesture id="g" lexeme="come_here"/>',
    '<gesture id="g" lexeme="yes"/>',
    '<speech id="s"><text>It is <sync id="m"/>big.</text></speech><gesture id="g" lexeme="large" stroke="s:m"/>',
    '<gesture id="g" lexeme="offer"/>',
)


@cache
def performer(name: str) -> Performer:
    return Performer(name)


def stroke_errors(name: str, gestures: str, play: float) -> list[float]:
    """Perform gestures in the twin, and return the stroke errors [s] of a performance within all limits."""
    block = f'<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">{gestures}</bml>'
    run = performer(name).perform(performer(name).plan(block), twin=Factors(play=play))
    assert run.ok, [check for check in run.checks if check.status == "fail"]
    strokes = [sync for sync in run.syncs if sync.sync in STROKE_POINTS]
    assert all(sync.performed is not None for sync in strokes)
    return [abs(sync.performed - sync.planned) for sync in strokes]


def test_pointing_of_so101_arms_with_worn_gears_is_within_limits_and_in_time():
    assert max(stroke_errors("so101_pair", GESTURES[3], PLAY)) < MAX_STROKE_ERROR


@pytest.mark.soak
@pytest.mark.parametrize("name", ROBOTS)
def test_strokes_of_ten_documents_on_a_robot_with_worn_gears_are_in_time(name: str):
    errors = sorted(error for gestures in GESTURES for error in stroke_errors(name, gestures, PLAY))
    assert len(errors) >= 20
    assert errors[int(0.95 * len(errors))] < MAX_STROKE_ERROR


def test_pair_of_so101_arms_has_the_servo_ids_of_lerobot_on_two_buses():
    servos = ServoMap.of(Robot.load("so101_pair")).servos
    ids = {bus: sorted(k for s in servos if s.bus == bus for k in s.ids) for bus in ("left", "right")}
    assert ids == {"left": [1, 2, 3, 4, 5], "right": [1, 2, 3, 4, 5]}


def test_middle_of_the_elbow_range_of_an_so101_is_at_the_middle_of_the_servo_turn():
    elbow = next(s for s in ServoMap.of(Robot.load("so101_pair")).servos if s.hinge == "l_elbow_flexion")
    assert elbow.zero_ticks + 73.8 / 360 * 4096 == pytest.approx(2048, abs=1)


@pytest.mark.parametrize(("name", "count"), [("op3", 8), ("poppy_torso", 13)])
def test_each_servo_of_a_robot_is_on_a_bus_of_its_own_family(name: str, count: int):
    robot = Robot.load(name)
    drives = dict(zip(robot.skeleton.names, robot.drives, strict=True))
    servos = ServoMap.of(robot)
    assert len(servos.servos) == count
    for bus in servos.buses:
        models = {drives[wired.hinge].servo.name for wired in servos.servos if wired.bus == bus.name}
        assert len(models) == 1
