from dataclasses import replace

import numpy as np
import pytest

from kinesic.body.robot import Robot
from kinesic.expressivity.idle import Idling
from kinesic.planning.secondary.arcs import DIP_FRACTIONS, MAX_ARC_ANGLE, find_head_turns, make_head_arcs
from kinesic.session.plan import plan
from kinesic.session.setup import set_up

ROOT = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">{}</bml>'
LOOK = '<gaze id="g" target="left" start="1" ready="1.6" relax="2.5" end="3.1"/><wait id="w" duration="4"/>'
ROBOT = Robot.load()
TORSION, TILT, ROLL = (ROBOT.skeleton.names.index(f"skullbase_{axis}") for axis in ("torsion", "tilt", "roll"))


@pytest.fixture(scope="module")
def known():
    return set_up()


@pytest.fixture(scope="module")
def looked(known):
    return plan(ROOT.format(LOOK), known)


def found(planned, taken=(), amount=1.0, seed=1):
    return [*make_head_arcs(planned.trajectory, taken, amount, planned.setup.robot, np.random.default_rng(seed))]


def test_gaze_to_the_side_gives_two_head_turns(looked):
    there, back = find_head_turns(looked.trajectory, ROBOT)
    assert there[2] > np.radians(15)
    assert back[2] == pytest.approx(-there[2], abs=np.radians(2))
    assert 0.9 < there[0] - looked.trajectory.zero < there[1] - looked.trajectory.zero < 1.7


def test_head_dips_only_during_head_turns(looked):
    turns = [*find_head_turns(looked.trajectory, ROBOT)]
    swells = found(looked)
    assert len(swells) == len(turns) == 2
    for swell, (begin, end, turn) in zip(swells, turns, strict=True):
        assert begin == swell.begin < swell.peak < swell.end == end
        assert min(DIP_FRACTIONS[0] * abs(turn), MAX_ARC_ANGLE) - 1e-9 <= swell.away[TILT] <= MAX_ARC_ANGLE + 1e-9
        assert np.flatnonzero(swell.away).tolist() == [TILT, ROLL]
    assert all(
        np.abs(half.away - whole.away / 2).max() < np.radians(1)
        for half, whole in zip(found(looked, amount=0.5), swells, strict=True)
    )
    assert not found(looked, amount=0.0)


def test_head_dips_leave_requested_head_shakes_unchanged(known):
    shake = '<head id="h" lexeme="SHAKE" amount="1" start="1" end="3"/><wait id="w" duration="4"/>'
    planned = plan(ROOT.format(shake), known)
    assert len(found(planned)) > 1
    assert not found(planned, taken=[(planned.trajectory.zero + 1.0, planned.trajectory.zero + 3.2)])
    alive = plan(ROOT.format(shake), replace(known, idling=Idling(1.0, 1)))
    times = np.linspace(1.0, 3.0, 41)
    asked, done = (p.trajectory.sample(p.trajectory.zero + times)[0][:, ROLL] for p in (planned, alive))
    np.testing.assert_allclose(done, asked, atol=1e-6)


def test_robot_without_neck_has_no_head_dips_during_turns(looked):
    assert not [
        *make_head_arcs(
            looked.trajectory, (), 1.0, replace(ROBOT, chains={**ROBOT.chains, "neck": ()}), np.random.default_rng(1)
        )
    ]
