from itertools import pairwise
from math import degrees

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from kinesic.expressivity.keyframes import Turn
from kinesic.expressivity.style.passage import passage_of
from kinesic.expressivity.style.style import Expressivity
from kinesic.expressivity.turns import (
    MIN_KEY_SPACING,
    TURN_AXES,
    UPRIGHT_TURN,
    Hold,
    TurnKey,
    arrival_time,
    clip_turn,
    departure_time,
    hold_layer,
    hold_turn,
    layers_of_holds,
    range_excess,
    rotation_range,
    set_passages,
    sum_layers,
    turn_angles,
    turn_at,
)

FORCEFUL_EXPRESSIVITY = Expressivity(power=1.0, tension=0.5)
LEFT_TURN, RIGHT_TURN = Turn(torsion=0.5), Turn(torsion=-0.5)

angles = st.floats(-3.0, 3.0)
turns = st.builds(Turn, angles, angles, angles)
spans_of_time = st.floats(0.05, 2.0)  # [s]


@pytest.mark.parametrize(
    ("holds", "phases"),
    [
        ([Hold(0.0, 1.0, LEFT_TURN, 2.0, 3.0)], ("retraction", "stroke", "hold", "retraction")),
        ([Hold(0.0, 1.0, LEFT_TURN, 1.0, 3.0)], ("retraction", "stroke", "retraction")),
        ([Hold(0.0, 1.0, LEFT_TURN)], ("retraction", "stroke")),
        (
            [Hold(0.0, 1.0, LEFT_TURN, 2.0, 3.0), Hold(1.5, 1.8, UPRIGHT_TURN)],
            ("retraction", "stroke", "hold", "retraction"),
        ),
    ],
)
def test_each_key_of_a_held_rotation_has_the_spline_parameters_of_its_phase(holds, phases):
    layer = layers_of_holds(holds)[0]
    keys = set_passages(layer, FORCEFUL_EXPRESSIVITY)
    assert [key.passage for key in keys] == [passage_of(FORCEFUL_EXPRESSIVITY, phase) for phase in phases]
    assert [(key.time, key.turn) for key in keys] == [(key.time, key.turn) for key in layer]


def test_setting_spline_parameters_of_an_empty_rotation_layer_leaves_it_empty():
    assert set_passages((), FORCEFUL_EXPRESSIVITY) == ()


def test_held_rotation_follows_the_sync_points_of_its_behaviour():
    times = {"start": 1.0, "ready": 1.5, "relax": 2.0, "end": 3.0}
    assert hold_turn(LEFT_TURN, times, natural=0.4, stays=False) == Hold(1.0, 1.5, LEFT_TURN, 2.0, 3.0)
    assert hold_turn(LEFT_TURN, times, natural=0.4, stays=True) == Hold(1.0, 1.5, LEFT_TURN)
    assert hold_turn(LEFT_TURN, {"start": 1.0, "end": 3.0}, natural=0.4, stays=True) == Hold(1.0, 3.0, LEFT_TURN)


def test_held_rotation_takes_its_natural_time_if_sync_points_coincide():
    at_once = {"start": 1.0, "ready": 1.0, "relax": 2.0, "end": 2.0}
    assert hold_turn(LEFT_TURN, at_once, natural=0.4, stays=False) == Hold(1.0, 1.4, LEFT_TURN, 2.0, 2.4)
    late = {"start": 1.0, "ready": 1.0, "relax": 1.1, "end": 1.2}
    assert hold_turn(LEFT_TURN, late, natural=0.4, stays=False) == Hold(1.0, 1.4, LEFT_TURN, 1.4, pytest.approx(1.8))


@pytest.mark.parametrize(
    ("gap", "is_kept"), [(0.0, False), (0.6 * MIN_KEY_SPACING, False), (MIN_KEY_SPACING, True), (1.0, True)]
)
def test_rotation_keeps_requested_durations_of_at_least_the_minimum_key_spacing(gap, is_kept):
    assert arrival_time(0.0, gap, 0.4) == (gap if is_kept else 0.4)
    assert departure_time(-gap, 0.0, 0.4) == (-gap if is_kept else -0.4)


def test_rotation_range_of_a_chain_is_the_sum_of_its_joint_ranges(robot):
    least, most = rotation_range(robot, "neck")
    names = [robot.skeleton.names[k] for k in robot.joints("neck")]
    for axis, low, high in zip(TURN_AXES, turn_angles(least), turn_angles(most), strict=True):
        joints = [k for k, name in zip(robot.joints("neck"), names, strict=True) if name.endswith(axis)]
        assert (low, high) == (robot.skeleton.lower[joints].sum(), robot.skeleton.upper[joints].sum())
        assert low < 0.0 < high


def test_rotation_range_of_an_axis_without_a_joint_is_zero(robot):
    least, most = rotation_range(robot, "l_arm")
    assert least == most == UPRIGHT_TURN


@given(turns, turns, turns)
def test_clipped_head_or_torso_rotation_is_the_nearest_within_the_joint_ranges(turn, corner, other):
    sides = list(zip(turn_angles(corner), turn_angles(other), strict=True))
    within = Turn(*map(min, sides)), Turn(*map(max, sides))
    clipped = clip_turn(turn, within)
    assert clip_turn(clipped, within) == clipped
    lost = [abs(a - b) for a, b in zip(turn_angles(turn), turn_angles(clipped), strict=True)]
    beyond = [
        max(low - angle, angle - high, 0.0)
        for angle, (low, high) in zip(turn_angles(turn), [sorted(side) for side in sides], strict=True)
    ]
    assert lost == pytest.approx(beyond)
    assert range_excess(turn, within) == pytest.approx(degrees(max(beyond)))


def test_rotation_layers_are_added_and_constant_before_and_after_their_keys():
    one = (TurnKey(1.0, Turn(0.1, 0.2, 0.3)), TurnKey(2.0, Turn(0.3, 0.0, 0.3)))
    other = (TurnKey(1.5, Turn(roll=-0.3)),)
    np.testing.assert_allclose(
        sum_layers([one, other], np.array([0.0, 1.0, 1.5, 2.0, 9.0])),
        [[0.1, 0.2, 0.0], [0.1, 0.2, 0.0], [0.2, 0.1, 0.0], [0.3, 0.0, 0.0], [0.3, 0.0, 0.0]],
        atol=1e-15,
    )
    assert turn_angles(turn_at(one, 1.25)) == pytest.approx((0.13125, 0.16875, 0.3))


def test_rotation_near_a_reversal_stays_near_its_peak():
    shake = tuple(TurnKey(0.2 * k, Turn(torsion=angle)) for k, angle in enumerate((0.0, 0.2, -0.2, 0.2, 0.0)))
    near = [turn_at(shake, 0.4 + offset).torsion for offset in (-0.02, 0.0, 0.02)]
    assert near[1] == -0.2
    assert max(near) < -0.94 * 0.2
    assert max(abs(turn_at(shake, 0.01 * k).torsion) for k in range(81)) <= 0.2


def test_trunk_or_head_rotation_passes_intermediate_keys_without_stopping():
    rising = tuple(TurnKey(0.2 * k, Turn(tilt=angle)) for k, angle in enumerate((0.0, 0.1, 0.2, 0.3)))
    before, after = (turn_at(rising, 0.2 + offset).tilt for offset in (-0.01, 0.01))
    assert (after - before) / 0.02 == pytest.approx(0.5, rel=0.1)


@st.composite
def lists_of_holds(draw):
    """Draw holds in the order of their starts, some of them permanent."""
    holds, start = [], 0.0
    for turn, spans in draw(st.lists(st.tuples(turns, st.lists(spans_of_time, min_size=4, max_size=4)), max_size=6)):
        start += spans[0]
        arrive = start + spans[1]
        leave = None if draw(st.booleans()) else arrive + spans[2]
        holds.append(Hold(start, arrive, turn, leave, None if leave is None else leave + spans[3]))
    return holds


@given(lists_of_holds())
def test_each_held_rotation_returns_to_the_last_permanent_rotation(holds):
    layers = layers_of_holds(holds)
    assert len(layers) == len(holds)
    base, settled = UPRIGHT_TURN, 0.0
    for k, hold in enumerate(holds):
        following = holds[k + 1].start if k + 1 < len(holds) else np.inf
        if settled <= hold.arrive <= following:  # No other hold moves at that time
            assert sum_layers(layers, np.array([hold.arrive]))[0] == pytest.approx(turn_angles(hold.turn), abs=1e-9)
        base = hold.turn if hold.leave is None else base
        settled = max(settled, hold.arrive if hold.back is None else hold.back)
    assert sum_layers(layers, np.array([settled + 9.0]))[0] == pytest.approx(turn_angles(base), abs=1e-9)


@given(lists_of_holds())
def test_held_rotations_start_upright_and_are_continuous(holds):
    layers = layers_of_holds(holds)
    assert not sum_layers(layers, np.array([min((hold.start for hold in holds), default=0.0)])).any()
    for layer in layers:
        assert layer[0].turn == UPRIGHT_TURN
        assert all(before.time < after.time for before, after in pairwise(layer))


def test_later_held_rotation_overrides_an_earlier_one_from_its_start():
    layers = layers_of_holds([Hold(0.0, 1.0, LEFT_TURN, 5.0, 6.0), Hold(2.0, 3.0, RIGHT_TURN, 4.0, 4.5)])
    torsions = sum_layers(layers, np.array([1.0, 2.0, 2.5, 3.0, 4.0, 4.5, 5.0]))[:, 0]
    assert torsions == pytest.approx([0.5, 0.5, 0.0, -0.5, -0.5, 0.0, 0.0])


def test_held_rotation_that_starts_during_a_return_does_not_shorten_the_return():
    first = Hold(0.0, 1.0, LEFT_TURN, 2.0, 4.0)
    assert layers_of_holds([first, Hold(2.0, 5.0, RIGHT_TURN, 6.0, 7.0)])[0] == hold_layer(first)
