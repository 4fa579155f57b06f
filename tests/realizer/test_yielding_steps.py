"""Decelerations of yielding arms: growth, reach beyond the end of a motion, clock of the motion."""

from dataclasses import replace

import numpy as np
import pytest

from kinesic.body.arrays import sealed
from kinesic.motion.limit_check import check_limits
from kinesic.motion.trajectory import KNOT_INTERVAL, Trajectory
from kinesic.motion.transition import knot_at
from kinesic.realizer import yielding
from kinesic.realizer.occupancy import arm_hinges
from kinesic.realizer.realizer import interrupt
from kinesic.realizer.yielding import yield_motion

GESTURE = '<gesture id="g" lexeme="BEAT" mode="RIGHT_HAND"/>'
HOLD = 0.3  # [s] hold of the arms between deceleration and return


@pytest.fixture
def elbow(known) -> int:
    return known.robot.skeleton.names.index("r_elbow_flexion")


def swing(known, elbow: int, *, speed: float, pieces: int) -> Trajectory:
    """Return a motion of one elbow with a constant velocity [rad/s] from rest, cut while it moves."""
    controls = np.repeat(known.robot.skeleton.rest[None], pieces + 3, axis=0)
    phase = np.clip(np.arange(pieces + 3) / 40.0, 0.0, 1.0)
    controls[:, elbow] += np.cumsum(phase**2 * (3.0 - 2.0 * phase)) * speed * KNOT_INTERVAL
    return Trajectory(sealed(controls), 0.0)


def moving_time(motion: Trajectory, hinge: int, begin: float) -> float:
    """Return the time [s] from `begin` until the hinge first rests."""
    times = np.arange(begin, motion.end, KNOT_INTERVAL)
    return float(times[np.flatnonzero(np.abs(motion.sample(times)[1][:, hinge]) < 1e-9)[0]] - begin)


@pytest.mark.parametrize("refusals", [0, 1, 2, 4])
def test_deceleration_of_a_yielding_arm_is_30_percent_longer_after_each_infeasible_attempt(
    play, known, monkeypatch, refusals
):
    """Attempts last 0.2, 0.26, 0.338, 0.4394 and 0.57122 s, each rounded up to whole knots."""
    real, left = yielding.join_columns, [refusals]

    def refuse_first(columns):
        found = real(columns)
        left[0] -= 1
        return None if left[0] >= 0 else found

    monkeypatch.setattr(yielding, "join_columns", refuse_first)
    play.send("a", GESTURE).until(0.65)
    motion = interrupt(play.scene, 0.65, yields=True).motion
    hinges = [hinge for role in yielding.ARM_ROLES for hinge in arm_hinges(role, known.robot)]
    times = np.arange(0.65, 3.0, KNOT_INTERVAL)
    still = np.abs(motion.sample(times)[1])[:, hinges].max(axis=1) < 1e-6
    first = int(np.flatnonzero(still)[0])
    expected = np.ceil(0.2 * 1.3**refusals / KNOT_INTERVAL - 1e-9)
    assert first == pytest.approx(expected, abs=1)
    held = np.flatnonzero(~still[first:])[0]
    assert held * KNOT_INTERVAL == pytest.approx(HOLD, abs=0.021)


def test_arm_that_cannot_stop_in_0_7_s_returns_without_a_hold(play, monkeypatch):
    play.send("a", GESTURE).until(0.65)
    direct = interrupt(play.scene, 0.65, yields=False).motion
    attempts = []
    monkeypatch.setattr(yielding, "join_columns", lambda columns: attempts.append(list(columns)) and None)
    np.testing.assert_array_equal(interrupt(play.scene, 0.65, yields=True).motion.controls, direct.controls)
    assert len(attempts) == 2 * 5, "five durations up to 0.7 s, for arms alone and for all hinges"


def test_arm_that_is_stopped_near_the_end_of_a_motion_still_stops_within_limits(known, elbow):
    motion = swing(known, elbow, speed=0.8, pieces=80)
    arms = np.zeros(len(known.limits.lower), dtype=np.bool_)
    arms[elbow] = True
    stopped, end = yielding._hold_still(motion, knot_at(0.75), [elbow], known)
    assert stopped.end >= 0.95 - 1e-9
    assert end == pytest.approx(0.75 + 0.2 + HOLD)
    assert moving_time(stopped, elbow, 0.75) == pytest.approx(0.2, abs=0.011)
    assert max(peak.ratios.max() for peak in check_limits(stopped, known.limits).by_quantity.values()) <= 1.001


def test_motion_of_a_yielding_block_does_not_depend_on_the_clock_time(play, known):
    play.send("a", GESTURE + '<gaze id="z" target="left" start="0" ready="0.5" relax="6" end="7"/>').until(0.65)
    scene, shift = play.scene, 100.0
    arms = np.zeros(len(known.limits.lower), dtype=np.bool_)
    for role in yielding.ARM_ROLES:
        arms[list(arm_hinges(role, known.robot))] = True
    others = [entry for entry in scene.playing[0].occupancy if "look" in entry.roles]
    assert others
    layer = replace(scene.motion, controls=sealed(scene.motion.controls - known.robot.skeleton.rest))
    expected = yield_motion(scene.motion, 0.65, arms, known, layer=layer, others=others)
    later = replace(scene.motion, start=scene.motion.start + shift)
    late = yield_motion(
        later,
        0.65 + shift,
        arms,
        known,
        layer=replace(layer, start=layer.start + shift),
        others=[entry.shifted(shift) for entry in others],
    )
    assert late.start == expected.start + shift
    np.testing.assert_allclose(late.controls, expected.controls, atol=1e-7)
    assert not np.array_equal(expected.controls, scene.motion.controls)
