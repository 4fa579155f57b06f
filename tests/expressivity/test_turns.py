from itertools import pairwise
from math import degrees

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from kinesic.expressivity.keyframes import Turn
from kinesic.expressivity.style.style import Expressivity, passage_of
from kinesic.expressivity.turns import (
    AXES,
    MERGE,
    UPRIGHT,
    Hold,
    TurnKey,
    arrival,
    bump,
    clip_turn,
    departure_time,
    excess,
    exclusive,
    hold_turn,
    pass_layer,
    room,
    total,
    turn_angles,
    turn_at,
)

MANNER = Expressivity(power=1.0, tension=0.5)
LEFT, RIGHT = Turn(torsion=0.5), Turn(torsion=-0.5)

angles = st.floats(-3.0, 3.0)
turns = st.builds(Turn, angles, angles, angles)
spans_of_time = st.floats(0.05, 2.0)  # [s]


@pytest.mark.parametrize(
    ("holds", "phases"),
    [
        ([Hold(0.0, 1.0, LEFT, 2.0, 3.0)], ("retraction", "stroke", "hold", "retraction")),
        ([Hold(0.0, 1.0, LEFT, 1.0, 3.0)], ("retraction", "stroke", "retraction")),
        ([Hold(0.0, 1.0, LEFT)], ("retraction", "stroke")),
        ([Hold(0.0, 1.0, LEFT, 2.0, 3.0), Hold(1.5, 1.8, UPRIGHT)], ("retraction", "stroke", "hold", "retraction")),
    ],
)
def test_a_hold_goes_there_as_a_stroke_stays_and_goes_back(holds, phases):
    layer = exclusive(holds)[0]
    keys = pass_layer(layer, MANNER)
    assert [key.passage for key in keys] == [passage_of(MANNER, phase) for phase in phases]
    assert [(key.time, key.turn) for key in keys] == [(key.time, key.turn) for key in layer]


def test_no_layer_has_no_keys():
    assert pass_layer((), MANNER) == ()


def test_hold_follows_its_sync_points():
    times = {"start": 1.0, "ready": 1.5, "relax": 2.0, "end": 3.0}
    assert hold_turn(LEFT, times, natural=0.4, stays=False) == Hold(1.0, 1.5, LEFT, 2.0, 3.0)
    assert hold_turn(LEFT, times, natural=0.4, stays=True) == Hold(1.0, 1.5, LEFT)
    assert hold_turn(LEFT, {"start": 1.0, "end": 3.0}, natural=0.4, stays=True) == Hold(1.0, 3.0, LEFT)


def test_hold_takes_its_natural_time_where_its_sync_points_leave_none():
    at_once = {"start": 1.0, "ready": 1.0, "relax": 2.0, "end": 2.0}
    assert hold_turn(LEFT, at_once, natural=0.4, stays=False) == Hold(1.0, 1.4, LEFT, 2.0, 2.4)
    late = {"start": 1.0, "ready": 1.0, "relax": 1.1, "end": 1.2}
    assert hold_turn(LEFT, late, natural=0.4, stays=False) == Hold(1.0, 1.4, LEFT, 1.4, pytest.approx(1.8))


@pytest.mark.parametrize(("gap", "is_kept"), [(0.0, False), (0.6 * MERGE, False), (MERGE, True), (1.0, True)])
def test_requested_times_are_kept_from_twenty_milliseconds_on(gap, is_kept):
    assert arrival(0.0, gap, 0.4) == (gap if is_kept else 0.4)
    assert departure_time(-gap, 0.0, 0.4) == (-gap if is_kept else -0.4)


def test_range_of_a_chain_is_the_sum_of_its_joints(robot):
    least, most = room(robot, "neck")
    names = [robot.skeleton.names[k] for k in robot.joints("neck")]
    for axis, low, high in zip(AXES, turn_angles(least), turn_angles(most), strict=True):
        joints = [k for k, name in zip(robot.joints("neck"), names, strict=True) if name.endswith(axis)]
        assert (low, high) == (robot.skeleton.lower[joints].sum(), robot.skeleton.upper[joints].sum())
        assert low < 0.0 < high


def test_axis_without_a_joint_has_no_range(robot):
    least, most = room(robot, "l_arm")
    assert least == most == UPRIGHT


@given(turns, turns, turns)
def test_clipped_rotation_is_the_nearest_in_range(turn, corner, other):
    sides = list(zip(turn_angles(corner), turn_angles(other), strict=True))
    within = Turn(*map(min, sides)), Turn(*map(max, sides))
    clipped = clip_turn(turn, within)
    assert clip_turn(clipped, within) == clipped
    lost = [abs(a - b) for a, b in zip(turn_angles(turn), turn_angles(clipped), strict=True)]
    beyond = [
        max(low - angle, angle - high, 0.0)
        for angle, (low, high) in zip(turn_angles(turn), [sorted(each) for each in sides], strict=True)
    ]
    assert lost == pytest.approx(beyond)
    assert excess(turn, within) == pytest.approx(degrees(max(beyond)))


def test_layers_add_up_and_are_constant_outside_their_keys():
    one = (TurnKey(1.0, Turn(0.1, 0.2, 0.3)), TurnKey(2.0, Turn(0.3, 0.0, 0.3)))
    other = (TurnKey(1.5, Turn(roll=-0.3)),)
    np.testing.assert_allclose(
        total([one, other], np.array([0.0, 1.0, 1.5, 2.0, 9.0])),
        [[0.1, 0.2, 0.0], [0.1, 0.2, 0.0], [0.2, 0.1, 0.0], [0.3, 0.0, 0.0], [0.3, 0.0, 0.0]],
        atol=1e-15,
    )
    assert turn_angles(turn_at(one, 1.25)) == pytest.approx((0.15, 0.15, 0.3))


@st.composite
def lists_of_holds(draw):
    """Holds in the order of their starts, some of which stay."""
    holds, start = [], 0.0
    for turn, spans in draw(st.lists(st.tuples(turns, st.lists(spans_of_time, min_size=4, max_size=4)), max_size=6)):
        start += spans[0]
        arrive = start + spans[1]
        leave = None if draw(st.booleans()) else arrive + spans[2]
        holds.append(Hold(start, arrive, turn, leave, None if leave is None else leave + spans[3]))
    return holds


@given(lists_of_holds())
def test_each_hold_is_reached_and_the_last_rotation_that_stays_is_returned_to(holds):
    layers = exclusive(holds)
    assert len(layers) == len(holds)
    base, settled = UPRIGHT, 0.0
    for k, hold in enumerate(holds):
        following = holds[k + 1].start if k + 1 < len(holds) else np.inf
        if settled <= hold.arrive <= following:  # no other hold moves then
            assert total(layers, np.array([hold.arrive]))[0] == pytest.approx(turn_angles(hold.turn), abs=1e-9)
        base = hold.turn if hold.leave is None else base
        settled = max(settled, hold.arrive if hold.back is None else hold.back)
    assert total(layers, np.array([settled + 9.0]))[0] == pytest.approx(turn_angles(base), abs=1e-9)


@given(lists_of_holds())
def test_motion_of_holds_starts_upright_and_never_jumps(holds):
    layers = exclusive(holds)
    assert not total(layers, np.array([min((hold.start for hold in holds), default=0.0)])).any()
    for layer in layers:
        assert layer[0].turn == UPRIGHT
        assert all(before.time < after.time for before, after in pairwise(layer))


def test_a_later_hold_wins_from_its_start():
    layers = exclusive([Hold(0.0, 1.0, LEFT, 5.0, 6.0), Hold(2.0, 3.0, RIGHT, 4.0, 4.5)])
    torsions = total(layers, np.array([1.0, 2.0, 2.5, 3.0, 4.0, 4.5, 5.0]))[:, 0]
    assert torsions == pytest.approx([0.5, 0.5, 0.0, -0.5, -0.5, 0.0, 0.0])


def test_a_hold_that_starts_while_the_other_leaves_does_not_cut_it_short():
    first = Hold(0.0, 1.0, LEFT, 2.0, 4.0)
    assert exclusive([first, Hold(2.0, 5.0, RIGHT, 6.0, 7.0)])[0] == bump(first)
