"""Idle motion changes no behaviour and keeps the limits of every motion."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from kinesic.expressivity.idle import Idling
from kinesic.motion.limit_check import check_limits
from kinesic.motion.stopping import stop
from kinesic.planning.plan import Plan
from kinesic.planning.setup import Setup
from kinesic.session.plan import plan
from kinesic.session.setup import set_up

BML_TEMPLATE = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">{}</bml>'
BEHAVIOUR_TEMPLATES = (
    '<gesture id="g{k}" lexeme="offer" stroke="{at}"/>',
    '<head id="h{k}" lexeme="NOD" stroke="{at}"/>',
    '<gazeShift id="z{k}" target="left" start="{at}"/>',
    '<gesture id="b{k}" lexeme="beat" mode="LEFT_HAND" stroke="{at}"/>',
)
SETTLING_TIME = 0.3  # [s] from an emergency stop until idle motion has ended, a fraction of a breath
behaviours = st.lists(
    st.tuples(st.sampled_from(BEHAVIOUR_TEMPLATES), st.floats(0.0, 16.0).map(lambda at: round(at, 2))),
    min_size=1,
    max_size=4,
)


@pytest.fixture(scope="module")
def known() -> Setup:
    return set_up()


@pytest.fixture(scope="module")
def waiting(known: Setup) -> Plan:
    return plan(BML_TEMPLATE.format('<wait id="w" duration="12"/>'), replace(known, idling=Idling(2.0, 3)))


@settings(max_examples=5, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(behaviours, st.integers(0, 9))
def test_idle_motion_moves_no_sync_point_and_keeps_limits(known, asked, seed):
    lines = [line.format(k=k, at=at) for k, (line, at) in enumerate(asked)]
    text = BML_TEMPLATE.format("".join((*lines, '<wait id="w" start="0" duration="20"/>')))
    still, moving = plan(text, known), plan(text, replace(known, idling=Idling(2.0, seed)))
    planned = {(sync.behaviour, sync.sync): sync.planned for sync in still.syncs}
    assert {(sync.behaviour, sync.sync): sync.planned for sync in moving.syncs} == pytest.approx(planned, abs=1e-6)
    assert {id: each.kind for id, each in moving.keyframes.outcomes.items()} == {
        id: each.kind for id, each in still.keyframes.outcomes.items()
    }
    peaks = check_limits(moving.trajectory, known.limits).by_quantity.values()
    assert all(peak.ratios.max() <= 1.0 + 1e-6 for peak in peaks)
    assert moving.clearance.distances.min() >= known.robot.min_clearance


def test_idle_motion_is_planned_and_begins_and_ends_at_rest(known, waiting):
    angles = waiting.trajectory.sample(np.linspace(0.0, waiting.duration, 200))[0]
    away = np.degrees(np.abs(angles - known.robot.skeleton.rest).max(axis=0))
    moving = {name for name, degrees in zip(known.robot.skeleton.names, away, strict=True) if degrees > 0.2}
    assert any(name.startswith("v") for name in moving), "the trunk sways"
    assert any(name.startswith("sk") for name in moving), "the head glances"
    assert any("_shoulder_" in name for name in moving), "the arms change their rest"
    assert away.max() < 60.0
    np.testing.assert_allclose(angles[[0, -1]], np.tile(known.robot.skeleton.rest, (2, 1)), atol=1e-6)


@pytest.mark.parametrize("time", [1.7, 3.1, 4.9, 7.3])
def test_emergency_stop_ends_idle_motion_within_0_3_s(known, waiting, time: float):
    stopped = stop(waiting.trajectory, time, known.limits)
    assert stopped.end <= time + SETTLING_TIME
