from dataclasses import replace

import numpy as np
import pytest

from kinesic.body.robot import Robot
from kinesic.expressivity.idle import Idling
from kinesic.motion.trajectory import KNOT_INTERVAL, Trajectory
from kinesic.planning.secondary.arcs import (
    DIP_FRACTIONS,
    MAX_ARC_ANGLE,
    MIN_TURN_ANGLE,
    MIN_TURN_TIME,
    MIN_TURN_VELOCITY,
    find_head_turns,
    make_head_arcs,
)
from kinesic.session.plan import plan
from kinesic.session.setup import set_up

# document whose {} is replaced by behaviours
BML_TEMPLATE = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">{}</bml>'
# gaze to the left and back
GAZE_BEHAVIOURS = '<gaze id="g" target="left" start="1" ready="1.6" relax="2.5" end="3.1"/><wait id="w" duration="4"/>'
DEFAULT_ROBOT = Robot.load()
TORSION_HINGE = DEFAULT_ROBOT.skeleton.names.index("skullbase_torsion")  # index of the head's torsion hinge
TILT_HINGE = DEFAULT_ROBOT.skeleton.names.index("skullbase_tilt")  # index of the head's tilt hinge
ROLL_HINGE = DEFAULT_ROBOT.skeleton.names.index("skullbase_roll")  # index of the head's roll hinge


@pytest.fixture(scope="module")
def known():
    return set_up()


@pytest.fixture(scope="module")
def looked(known):
    return plan(BML_TEMPLATE.format(GAZE_BEHAVIOURS), known)


def found(planned, taken=(), amount=1.0, seed=1):
    return [*make_head_arcs(planned.trajectory, taken, amount, planned.setup.robot, np.random.default_rng(seed))]


def test_gaze_to_the_side_gives_two_head_turns(looked):
    there, back = find_head_turns(looked.trajectory, DEFAULT_ROBOT)
    assert there[2] > np.radians(15)
    assert back[2] == pytest.approx(-there[2], abs=np.radians(2))
    assert 0.9 < there[0] - looked.trajectory.zero < there[1] - looked.trajectory.zero < 1.7


def test_head_dips_only_during_head_turns(looked):
    turns = [*find_head_turns(looked.trajectory, DEFAULT_ROBOT)]
    swells = found(looked)
    assert len(swells) == len(turns) == 2
    for swell, (begin, end, turn) in zip(swells, turns, strict=True):
        assert begin == swell.begin < swell.peak < swell.end == end
        assert min(DIP_FRACTIONS[0] * abs(turn), MAX_ARC_ANGLE) - 1e-9 <= swell.away[TILT_HINGE] <= MAX_ARC_ANGLE + 1e-9
        assert np.flatnonzero(swell.away).tolist() == [TILT_HINGE, ROLL_HINGE]
    assert all(
        np.abs(half.away - whole.away / 2).max() < np.radians(1)
        for half, whole in zip(found(looked, amount=0.5), swells, strict=True)
    )
    assert not found(looked, amount=0.0)


def test_head_dips_leave_requested_head_shakes_unchanged(known):
    shake = '<head id="h" lexeme="SHAKE" amount="1" start="1" end="3"/><wait id="w" duration="4"/>'
    planned = plan(BML_TEMPLATE.format(shake), known)
    assert len(found(planned)) > 1
    assert not found(planned, taken=[(planned.trajectory.zero + 1.0, planned.trajectory.zero + 3.2)])
    alive = plan(BML_TEMPLATE.format(shake), replace(known, idling=Idling(1.0, 1)))
    times = np.linspace(1.0, 3.0, 41)
    asked, done = (p.trajectory.sample(p.trajectory.zero + times)[0][:, ROLL_HINGE] for p in (planned, alive))
    np.testing.assert_allclose(done, asked, atol=1e-6)


def turning(angle, duration, *, still=2.0):
    """Return a head turn to the left of whole knot intervals."""
    knots = round(duration / KNOT_INTERVAL)
    ramp = angle * np.clip((np.arange(600) - round(still / KNOT_INTERVAL)) / knots, 0.0, 1.0)
    controls = np.tile(DEFAULT_ROBOT.skeleton.rest, (600, 1))
    controls[:, TORSION_HINGE] += ramp
    return Trajectory(controls, 0.0, 5.0)


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("still", [0.1, 2.0])
@pytest.mark.parametrize(
    ("angle", "duration", "counts"),
    [
        (1.05 * MIN_TURN_ANGLE, MIN_TURN_TIME, True),
        (1.05 * MIN_TURN_ANGLE, MIN_TURN_TIME - KNOT_INTERVAL, False),
        (0.95 * MIN_TURN_ANGLE, MIN_TURN_TIME, False),
        (1.05 * MIN_TURN_ANGLE, 0.9 * MIN_TURN_ANGLE / MIN_TURN_VELOCITY, True),
        (1.05 * MIN_TURN_ANGLE, 1.1 * 1.05 * MIN_TURN_ANGLE / MIN_TURN_VELOCITY, False),
    ],
)
def test_head_turn_is_detected_only_above_a_minimum_angle_duration_and_velocity(sign, still, angle, duration, counts):
    motion = turning(sign * angle, duration, still=still)
    turns = [*find_head_turns(motion, DEFAULT_ROBOT)]
    assert len(turns) == counts
    for begin, end, turn in turns:
        assert turn == pytest.approx(sign * angle)
        assert end - begin == pytest.approx(duration, abs=KNOT_INTERVAL)
        assert begin == pytest.approx(5.0 + still - KNOT_INTERVAL, abs=2 * KNOT_INTERVAL)


def test_head_leans_to_both_sides_of_its_turn_but_mostly_inwards():
    arcs = [
        next(make_head_arcs(turning(np.radians(30) * sign, 0.6), (), 1.0, DEFAULT_ROBOT, np.random.default_rng(seed)))
        for seed in range(50)
        for sign in (1.0, -1.0)
    ]
    for left, right in zip(arcs[::2], arcs[1::2], strict=True):
        assert left.away[TILT_HINGE] == right.away[TILT_HINGE] > 0.0
        assert left.away[ROLL_HINGE] == -right.away[ROLL_HINGE]
    rolls = np.array([left.away[ROLL_HINGE] for left in arcs[::2]])
    assert 0.6 < np.mean(rolls < 0.0) < 0.95, "the roll to the right is positive"


def test_robot_without_neck_has_no_head_dips_during_turns(looked):
    assert not [
        *make_head_arcs(
            looked.trajectory,
            (),
            1.0,
            replace(DEFAULT_ROBOT, chains={**DEFAULT_ROBOT.chains, "neck": ()}),
            np.random.default_rng(1),
        )
    ]
