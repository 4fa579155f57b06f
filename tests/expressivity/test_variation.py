from itertools import pairwise

import numpy as np
import pytest

from kinesic.bml.block import Behaviour, Block, Gaze, Gesture, Place
from kinesic.expressivity.behaviours import gesture_move
from kinesic.expressivity.context import BlockContext
from kinesic.expressivity.durations import natural_durations
from kinesic.expressivity.lexicon.space import spread_hands
from kinesic.expressivity.realise import make_keyframes
from kinesic.expressivity.style.style import Expressivity, Style
from kinesic.expressivity.variation import (
    MIRROR_DEVIATION,
    NO_VARIATION,
    OTHER_HAND_PROBABILITY,
    POSITION_DEVIATION,
    SPATIAL_DEVIATION,
    TEMPORAL_DEVIATION,
    Variation,
    deviations,
    needs_place,
)

HUMAN_VARIATION = Variation(1.0, 5)


def block(*actions, id="story"):
    behaviours = (Behaviour(f"g{k}", "gesture", action, Place(1, 1)) for k, action in enumerate(actions))
    return Block(id, tuple(behaviours))


def beats(count, id="story"):
    return block(*(Gesture("beat") for _ in range(count)), id=id)


@pytest.fixture
def varied(context):
    """Return contexts of one beat for forty seeds."""
    return [context(beats(1), variation=Variation(1.0, seed)) for seed in range(40)]


def poses_of(context, timed):
    """Return the stroke positions (m, 3) [m] of a gesture and its hand."""
    (stroke,) = gesture_move(timed, timed.behaviour.action, context).strokes
    ((side, row),) = stroke.options[0].hands.items()
    return np.array([hand.reach.position for hand in row]), side


@pytest.fixture
def beat(timeline, phases):
    """Return a beat with times."""
    return timeline(("g0", Gesture("beat"), phases(0, 1, 1, 1.5, 1.5, 2, 3))).timed[0]


def test_gestures_with_zero_random_variation_do_not_depend_on_the_seed(context, timeline, phases):
    built = timeline(*((f"g{k}", Gesture("beat"), phases(0, 1, 1, 1.5, 1.5, 2, 3)) for k in range(2)))
    usual, other = (
        make_keyframes(built, context(built.block, **way)) for way in ({}, {"variation": Variation(0.0, 9)})
    )
    for a, b in zip(usual.frames, other.frames, strict=True):
        assert (a.time, a.torso, a.head) == (b.time, b.torso, b.head)
        for side, hand in a.hands.items():
            assert (hand.reach is None) == (b.hands[side].reach is None)
            assert hand.reach is None or np.array_equal(hand.reach.position, b.hands[side].reach.position)
    assert deviations(built.block, NO_VARIATION) == deviations(built.block, Variation(0.0, 9)) == {}


def test_random_gesture_deviation_is_reproducible_and_differs_between_seeds_and_blocks():
    def found(block, variation):
        result = deviations(block, variation)["g1"]
        return result.spatial, result.temporal, *result.place, result.other_hand

    usual = found(beats(3), HUMAN_VARIATION)
    assert found(beats(3), HUMAN_VARIATION) == usual
    for other in (found(beats(3), Variation(1.0, 6)), found(beats(3, id="other"), HUMAN_VARIATION)):
        assert not {*other[:-1]} & {*usual[:-1]}


def test_random_variation_makes_successive_gestures_differ_in_size():
    for seed in range(20):
        results = list(deviations(beats(15), Variation(1.0, seed)).values())
        assert all(abs(a.spatial - b.spatial) > 0.7 * SPATIAL_DEVIATION for a, b in pairwise(results))
        assert len({one.spatial for one in results}) == len({one.temporal for one in results}) == 15


def test_random_deviations_stay_within_bounds_and_scale_with_the_amount():
    results = [next(iter(deviations(beats(1), Variation(1.0, seed)).values())) for seed in range(300)]
    spatial, temporal = np.array([item.spatial for item in results]), np.array([item.temporal for item in results])
    for values, most in (
        (spatial, SPATIAL_DEVIATION),
        (temporal, TEMPORAL_DEVIATION),
        (np.array([item.place for item in results]), POSITION_DEVIATION),
    ):
        assert 0.9 * most < np.abs(values).max() <= most
        assert values.mean() == pytest.approx(0.0, abs=0.12 * most)
    assert np.mean([item.other_hand for item in results]) == pytest.approx(OTHER_HAND_PROBABILITY, abs=0.08)
    twice = next(iter(deviations(beats(1), Variation(2.0, 0)).values()))
    assert (twice.spatial, twice.temporal) == pytest.approx((2 * results[0].spatial, 2 * results[0].temporal))


def test_random_size_and_tempo_of_gestures_are_negatively_correlated():
    results = [deviation for seed in range(40) for deviation in deviations(beats(5), Variation(1.0, seed)).values()]
    spatial, temporal = np.array([(item.spatial, item.temporal) for item in results]).T
    assert np.abs(temporal).max() <= TEMPORAL_DEVIATION
    assert np.corrcoef(spatial, temporal)[0, 1] < -0.5


def test_random_variation_applies_only_to_hand_behaviours():
    assert deviations(block(Gaze("left"), Gesture("beat")), HUMAN_VARIATION).keys() == {"g1"}


def test_random_variation_changes_amplitude_position_duration_and_hand(varied: list[BlockContext], beat):
    poses = [poses_of(item, beat) for item in varied]
    ways = np.array([np.linalg.norm(np.diff(row, axis=0), axis=1).sum() for row, _ in poses])
    assert 0.04 < np.log(ways).std() < 0.2
    places = np.array([row.mean(axis=0) for row, side in poses if side == "r"])
    assert (places.std(axis=0) > 0.005).all()
    assert {side for _, side in poses} == {"l", "r"}
    times = np.array([sum(natural_durations(item)["g0"].values()) for item in varied])
    assert 0.03 < np.log(times).std() < 0.2


def test_random_variation_keeps_a_given_hand_and_the_hand_of_an_emblem(context, timeline, phases):
    at = phases(0, 1, 1, 1.5, 1.5, 2, 3)
    (left,) = timeline(("g0", Gesture("beat", "left"), at)).timed
    (emblem,) = timeline(("g0", Gesture("thumb_up"), at)).timed
    usual = poses_of(context(beats(1)), emblem)[1]
    for seed in range(20):
        there = context(block(Gesture("beat", "left")), variation=Variation(1.0, seed))
        assert poses_of(there, left)[1] == "l"
        there = context(block(Gesture("thumb_up")), variation=Variation(1.0, seed))
        assert poses_of(there, emblem)[1] == usual


def test_random_variation_does_not_change_fixed_axes_and_touching_hands(lexicon, robot):
    (deviation,) = deviations(beats(1), Variation(2.0, 1)).values()
    moved = 0
    for form in lexicon.forms:
        for before, after in zip(form.keys, deviation.form(form, robot).keys, strict=True):
            for side, pose in before.hands.items():
                change = after.hands[side].position - pose.position
                if pose.touch or form.rest:
                    np.testing.assert_array_equal(change[[0, 2]], 0.0)
                np.testing.assert_array_equal(change[list(pose.fixed)], 0.0)
                moved += bool(np.abs(change).max() > 0.01)
    assert moved > 200


@pytest.mark.parametrize("name", ["obstacle", "fold_over"])
def test_random_variation_keeps_a_gap_between_one_free_and_one_fixed_hand(lexicon, robot, name):
    form = lexicon.find(name).form
    for seed in range(20):
        (deviation,) = deviations(beats(1), Variation(2.0, seed)).values()
        for key in deviation.form(form, robot).keys:
            apart = spread_hands(key)
            for side, pose in key.hands.items():
                np.testing.assert_allclose(apart.hands[side].position, pose.position, atol=1e-9)


def test_random_variation_keeps_meeting_hands_mirrored(lexicon, robot):
    (deviation,) = deviations(beats(1), Variation(1.0, 3)).values()
    key = deviation.form(lexicon.find("applause").form, robot).keys[0]
    usual = lexicon.find("applause").form.keys[0]
    left, right = (key.hands[side].position - usual.hands[side].position for side in ("l", "r"))
    np.testing.assert_allclose(left, right, atol=1e-12)


@pytest.mark.parametrize("name", ["rise", "welcome", "fall"])
def test_random_variation_breaks_the_mirror_symmetry_of_distant_hands(lexicon, robot, name):
    form, seen = lexicon.find(name).form, []
    for seed in range(8):
        (deviation,) = deviations(beats(1), Variation(1.0, seed)).values()
        key, usual = deviation.form(form, robot).keys[0], form.keys[0]
        left, right = (key.hands[side].position - usual.hands[side].position for side in ("l", "r"))
        seen.append(float(np.abs(left - right).max()))
    assert np.mean(seen) > 0.005
    assert max(seen) <= MIRROR_DEVIATION + 1e-9


def test_random_variation_keeps_parameters_in_their_ranges(context):
    wild = Style.uniform(Expressivity(spatial=1.0, temporal=-1.0))
    for seed in range(20):
        there = context(beats(3), wild, variation=Variation(2.0, seed))
        for behaviour in there.block.behaviours:
            manner = there.manner(behaviour)
            assert 0.0 <= manner.spatial <= 1.0
            assert -1.0 <= manner.temporal <= 0.0


def test_random_variation_changes_gestures_with_fixed_meaning_only_in_time(context, lexicon):
    placed = [form for form in lexicon.forms if needs_place(form)]
    assert {"hush", "me", "watch_time", "arms_crossed"} <= {form.id for form in placed}
    for seed in (1, 2):
        there = context(block(*(Gesture(form.id) for form in placed)), variation=Variation(1.0, seed))
        for behaviour in there.block.behaviours:
            same = context(there.block).find_gesture(behaviour, behaviour.action).form
            result, manner = there.find_gesture(behaviour, behaviour.action).form, there.manner(behaviour)
            for key, usual in zip(result.keys, same.keys, strict=True):
                for side, pose in key.hands.items():
                    np.testing.assert_array_equal(pose.position, usual.hands[side].position)
            assert manner.spatial == there.manner(behaviour, "head").spatial == 0.0
            assert manner.temporal != 0.0
    assert not needs_place(lexicon.find("beat").form)
