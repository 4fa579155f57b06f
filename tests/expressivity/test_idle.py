from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from kinesic.bml.block import Gaze, Gesture, Wait
from kinesic.expressivity.idle import IDLE_MARGIN, MIN_PAUSE, Idling, idle, pauses
from kinesic.expressivity.realise import make_keyframes
from kinesic.expressivity.turns import UPRIGHT_TURN, sum_layers, turn_angles

LIVELY_IDLING = Idling(2.0, 7)
spans = st.lists(
    st.tuples(st.floats(0, 50), st.floats(0, 10)).map(lambda pair: (pair[0], pair[0] + pair[1])), max_size=6
)


def test_idle_motion_with_amount_zero_is_empty():
    assert idle([(0.0, 60.0)], Idling(0.0, 7)) == ((), ())


@given(spans, st.integers(0, 5))
def test_idle_motion_is_zero_outside_pauses(busy, seed):
    free = pauses(busy, (0.0, 50.0))
    for layer in idle(free, Idling(2.0, seed)):
        if not layer:
            continue
        times = [key.time for key in layer]
        assert times == sorted(set(times))
        inside = np.concatenate(
            [np.linspace(begin - IDLE_MARGIN, end + IDLE_MARGIN, 20) for begin, end in busy] or [[0.0]]
        )
        np.testing.assert_allclose(sum_layers([layer], inside), 0.0, atol=1e-12)
        assert layer[0].turn == layer[-1].turn == UPRIGHT_TURN


@given(spans)
def test_pauses_and_busy_time_spans_cover_the_whole_block(busy):
    free = pauses(busy, (0.0, 50.0))
    for time in np.linspace(0.05, 49.95, 97):
        assert any(a <= time <= b for a, b in [*busy, *free])
    assert all(b <= c for (_, b), (c, _) in pairwise(free))


def test_idle_motion_is_reproducible_and_differs_between_seeds():
    assert idle([(0.0, 30.0)], LIVELY_IDLING) == idle([(0.0, 30.0)], LIVELY_IDLING)
    assert idle([(0.0, 30.0)], LIVELY_IDLING) != idle([(0.0, 30.0)], Idling(2.0, 8))


@pytest.mark.parametrize("part", [0, 1])
def test_idle_motion_stays_below_12_degrees_and_grows_with_its_amount(part):
    times = np.linspace(0.0, 60.0, 600)
    little, much = (
        float(np.abs(sum_layers([idle([(0.0, 60.0)], Idling(amount, 3))[part]], times)).max()) for amount in (1.0, 2.0)
    )
    assert np.radians(0.5) < little < much < np.radians(12)


def test_permanent_gaze_shift_does_not_prevent_idle_motion(timeline, context):
    gaze = ("z", Gaze(target="left", shift=True), {"start": 0.0, "end": 1.0})
    built = timeline(gaze, ("w", Wait(), {"start": 0.0, "end": 20.0}))
    still, moving = (
        make_keyframes(built, context(built.block, idling=idling)).frames for idling in (Idling(), LIVELY_IDLING)
    )
    assert len(moving) > len(still) + 5
    assert moving[-1].head.torsion == pytest.approx(still[-1].head.torsion)


def test_short_pause_of_a_block_has_no_idle_motion():
    assert idle([(0.0, MIN_PAUSE + 2 * IDLE_MARGIN - 0.01)], LIVELY_IDLING) == ((), ())
    assert idle([(0.0, MIN_PAUSE + 2 * IDLE_MARGIN + 0.01)], LIVELY_IDLING)[0]


def test_idle_motion_leaves_requested_motion_unchanged(timeline, context, phases):
    gesture = ("g", Gesture("offer", "left"), phases(8, 9, 9, 9.6, 9.6, 10, 11))
    gaze = ("z", Gaze(target="left"), {"start": 15.0, "ready": 15.5, "relax": 17.0, "end": 17.5})
    built = timeline(gesture, gaze, ("w", Wait(), {"start": 0.0, "end": 30.0}))
    still, moving = (make_keyframes(built, context(built.block, idling=idling)) for idling in (Idling(), LIVELY_IDLING))
    asked = {(id, sync): frame for frame in still.frames for id, sync in frame.syncs}
    met = {(id, sync): frame for frame in moving.frames for id, sync in frame.syncs}
    assert len(moving.frames) > len(still.frames) + 10
    assert asked.keys() == met.keys()
    for point, frame in asked.items():
        other = met[point]
        assert frame.time == other.time
        assert (*turn_angles(frame.torso), *turn_angles(frame.head)) == pytest.approx(
            (*turn_angles(other.torso), *turn_angles(other.head))
        )
    assert all(not frame.given & {"l_hand", "r_hand"} for frame in moving.frames if not 8 <= frame.time <= 11)


@pytest.mark.parametrize("seed", range(5))
def test_idle_head_and_trunk_motion_share_key_times_with_nearly_constant_intervals(seed):
    torso, head = idle([(0.0, 60.0)], Idling(1.0, seed))
    times = [key.time for key in torso]
    assert [key.time for key in head] == times
    assert (times[0], times[-1]) == pytest.approx((IDLE_MARGIN, 60.0 - IDLE_MARGIN))
    ways = np.diff(times)
    assert len(ways) % 2 == 0
    assert ways.max() / ways.min() <= 1.15 / 0.85 + 1e-9
