"""Properties of every plan."""

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from kinesic.session.plan import plan
from kinesic.session.setup import set_up

BML_TEMPLATE = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">{}</bml>'
GESTURE_LEXEMES = ("beat", "offer", "large", "greet_wave", "arms_crossed", "this_index", "belly", "refuse_sweep", "up")
HAND_MODES = ("LEFT_HAND", "RIGHT_HAND", "BOTH_HANDS")


times = st.floats(0, 6).map(lambda time: round(time, 3))
gestures = st.lists(
    st.tuples(st.sampled_from(GESTURE_LEXEMES), st.sampled_from(HAND_MODES), times), min_size=1, max_size=4
)
nods = st.lists(times, max_size=2)


@pytest.fixture(scope="module")
def known():
    return set_up()


def document(asked, nodding) -> str:
    lines = [
        f'<gesture id="g{k}" lexeme="{lexeme}" mode="{mode}" stroke="{time}"/>'
        for k, (lexeme, mode, time) in enumerate(asked)
    ]
    lines += [f'<head id="h{k}" lexeme="NOD" stroke="{time}"/>' for k, time in enumerate(nodding)]
    return BML_TEMPLATE.format("".join(lines))


@settings(max_examples=8, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(gestures, nods)
def test_plans_keep_limits_clearance_and_order_and_are_deterministic(known, asked, nodding):
    planned = plan(document(asked, nodding), known)
    at = np.arange(0.0, planned.trajectory.duration, 1e-3)
    angles, speeds, accelerations = planned.trajectory.sample(at)
    limits = known.limits
    assert np.all(angles >= limits.lower - 1e-9)
    assert np.all(angles <= limits.upper + 1e-9)
    assert np.all(np.abs(speeds) <= 1.001 * limits.speed)
    assert np.all(np.abs(accelerations) <= 1.001 * limits.acceleration)
    assert planned.clearance.distances.min() >= known.robot.min_clearance
    for behaviour in {sync.behaviour for sync in planned.syncs}:
        own = sorted((sync.requested, sync.planned) for sync in planned.syncs if sync.behaviour == behaviour)
        assert [planned for _, planned in own] == sorted(planned for _, planned in own)
    assert set(planned.keyframes.outcomes) == {b.id for b in planned.timeline.block.behaviours}
    again = plan(document(asked, nodding), known).trajectory
    assert again.controls.tobytes() == planned.trajectory.controls.tobytes()
    assert again.zero == planned.trajectory.zero
