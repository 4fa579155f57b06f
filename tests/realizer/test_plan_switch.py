"""Steps of the transition of a running block to a new plan, on small motions."""

from dataclasses import replace
from functools import partial

import numpy as np
import pytest

from kinesic.bml.parse import parse
from kinesic.motion.trajectory import KNOT_INTERVAL
from kinesic.motion.transition import SAME_ANGLE
from kinesic.planning.quick_plan import plan_quickly
from kinesic.planning.syncs import Syncs, SyncTime
from kinesic.realizer import replan as module
from kinesic.realizer.occupancy import arm_hinges, occupancy_of
from kinesic.realizer.replan import _PlanSwitch

from .plan_switches import HINGE_COUNT, NECK, merged, motion, switched, use

ROOT = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="c">{}</bml>'
START = 50.0  # [s] clock time at which the running motion starts


@pytest.fixture(scope="module")
def nod(known):
    return plan_quickly(parse(ROOT.format('<head id="n" lexeme="NOD" stroke="0"/>')), known)


@pytest.fixture
def switch(nod):
    return partial(switched, nod)


def test_times_of_a_plan_change_count_from_the_start_of_the_running_motion(nod):
    playing = merged(zero=START + 0.7, occupancy=[use("a", "sign", begin=START + 1)])
    running = motion(start=START)
    switch = _PlanSwitch.of(running, START + 0.205, playing, nod, [use("b", "look", begin=START + 2)])
    assert (switch.running, switch.knot, switch.playing, switch.new_plan) == (running, 21, playing, nod)
    assert switch.playing_zero == pytest.approx(0.7)
    assert [entry.begin for entry in switch.playing_occupancy] == pytest.approx([1.0])
    assert [entry.begin for entry in switch.others] == pytest.approx([2.0])


def test_new_plan_lacks_the_behaviours_that_the_merge_has_dropped(known, monkeypatch, nod):
    monkeypatch.setattr(module, "plan_without", lambda plan, dropped: (plan, dropped))
    assert _PlanSwitch.of(motion(), 0.2, merged(dropped=["n"]), nod, ()).new_plan == (nod, ("n",))


@pytest.mark.parametrize(("late", "knots"), [(0.0, 0), (0.126, 13), (0.124, 12), (-0.2, -20)])
def test_new_plan_keeps_time_zero_of_the_block_to_the_nearest_knot(switch, nod, late, knots):
    moved = switch(playing_zero=nod.trajectory.zero + late)
    assert moved.offset == knots
    assert moved.zero == pytest.approx(nod.trajectory.zero + knots * KNOT_INTERVAL)
    assert [(entry.behaviour, entry.begin) for entry in moved.new_occupancy] == [
        (entry.behaviour, pytest.approx(entry.begin + knots * KNOT_INTERVAL)) for entry in occupancy_of(nod)
    ]


def test_only_hand_behaviours_that_have_begun_count_as_in_progress(switch, monkeypatch):
    begun, later = {"begin": 0.19}, {"begin": 20 * KNOT_INTERVAL}
    entries = [use("a", "l_hand", **begun), use("b", "r_hand", **later), use("nod", "sign", **begun)]
    new = [use("c", "r_hand", "trunk", **begun), use("d", "l_hand", **later), use("look", "look", **begun)]
    moved = switch(playing_occupancy=entries)
    vars(moved)["new_occupancy"] = tuple(new)
    assert moved.hands_in_progress == {"a", "c"}


@pytest.mark.parametrize(
    ("before", "after", "keeps"),
    [
        (0.5, 0.5, True),
        (0.5, 0.23, True),
        (0.5, 0.22, False),
        (0.2, 0.2, True),
        (0.2, 0.21, False),
        (0.1, 0.05, True),
        (0.1, 0.5, False),
        (0.21, 0.5, True),
        (0.21, 0.2, False),
    ],
)
@pytest.mark.parametrize("sync", ["stroke", "strokeStart"])
def test_plan_change_keeps_strokes_if_past_ones_stay_past_and_future_ones_are_three_knots_away(
    switch, nod, before, after, keeps, sync
):
    """The transition begins at 0.2 s, and a stroke at that time is past."""
    at = [Syncs([SyncTime("n", sync, 0.0, time)]) for time in (before - 0.25, after - nod.trajectory.zero)]
    playing = merged(syncs=at[0])
    moved = switch(playing=playing, playing_zero=0.25, new_plan=replace(nod, syncs=at[1]))
    vars(moved)["zero"] = nod.trajectory.zero
    assert moved.keeps_strokes is keeps


def test_only_strokes_in_both_plans_decide_whether_strokes_are_kept(switch, nod):
    old = [SyncTime("n", "ready", 0.0, 0.1), SyncTime("n", "stroke", 0.0, 0.1), SyncTime("m", "stroke:1", 0.0, 0.1)]
    new = [SyncTime("n", "ready", 0.0, 9.0), SyncTime("k", "stroke", 0.0, 9.0), SyncTime("m", "stroke:2", 0.0, 9.0)]
    moved = switch(playing=merged(syncs=old), playing_zero=0.0, new_plan=replace(nod, syncs=Syncs(new)))
    assert moved.keeps_strokes


@pytest.mark.parametrize(
    ("running", "layer", "knot", "offset", "count"),
    [(300, 90, 20, 0, 300), (90, 310, 20, 0, 310), (90, 90, 400, 0, 406), (90, 90, 20, 500, None)],
)
def test_plan_change_covers_all_motions_and_six_knots_after_the_change(
    switch, nod, running, layer, knot, offset, count
):
    moved = switch(
        running=motion(running),
        playing=merged(layer=motion(layer)),
        knot=knot,
        playing_zero=nod.trajectory.zero + offset * KNOT_INTERVAL,
    )
    assert len(nod.trajectory.controls) < 290
    assert moved._count == (count or offset + len(nod.trajectory.controls))


def test_motion_without_the_block_lacks_only_its_offsets_of_the_trunk(switch, known):
    arm = arm_hinges("r_hand", known.robot)[0]
    layer = motion(40, **{"h0": 0.1, "h3": 0.2, f"h{arm}": 0.3})
    rest = known.robot.skeleton.rest
    running = replace(motion(), controls=np.tile(rest, (100, 1)) + np.eye(HINGE_COUNT)[[0, 3, arm]].T @ [0.1, 0.2, 0.3])
    base = switch(running=running, playing=merged(layer=layer))._without_block(120)
    assert len(base) == 120
    expected = np.array(rest)
    expected[arm] += 0.3
    np.testing.assert_allclose(base, np.tile(expected, (120, 1)), atol=1e-12)


def test_motion_without_the_block_ends_in_the_posture_held_by_other_blocks(switch, known):
    turn = 0.4 * np.eye(HINGE_COUNT)[NECK]
    running = replace(motion(), controls=np.tile(known.robot.skeleton.rest, (100, 1)))
    others = [use("look", "look", begin=0.0, ready=0.8, offset=turn)]
    base = switch(running=running, others=others)._without_block(100)
    np.testing.assert_allclose(base[-1], known.robot.skeleton.rest + turn, atol=1e-12)


@pytest.mark.parametrize(("knot", "is_corrected"), [(24, True), (25, False)])
@pytest.mark.parametrize("is_possible", [True, False])
def test_motion_without_the_block_is_corrected_if_it_exceeds_limits_after_the_change_time(
    switch, known, monkeypatch, knot, is_corrected, is_possible
):
    """Without the block, the neck jumps in the knot intervals 22 to 24."""
    calls = []

    def keep_limits(column, first, last, _limits, hinge):
        calls.append((hinge, first, last))
        return np.full(len(column), 0.7) if is_possible else None

    monkeypatch.setattr(module, "keep_limits", keep_limits)
    monkeypatch.setattr(module, "add_step_to_held_posture", lambda controls, *_: controls)
    layer = motion()
    layer.controls[25:, NECK] = 1.5 * known.limits.jerk[NECK] * KNOT_INTERVAL**3
    base = switch(playing=merged(layer=layer), knot=knot)._without_block(100)
    assert calls == [(NECK, knot, 97)] * is_corrected
    if is_corrected and not is_possible:
        assert base is None
    else:
        np.testing.assert_array_equal(base[:, NECK], 0.7 if is_corrected else -layer.controls[:, NECK])


@pytest.fixture
def joins(monkeypatch):
    """Replace `_join` by a stub that records its arguments by hinge."""
    calls = {}

    def join(current, goal, knot, coming, _limits, hinge):
        calls[hinge] = (current[0], knot, coming.tolist())
        return goal + 0.5

    monkeypatch.setattr(module, "_join", join)
    return calls


def test_only_hinges_that_differ_after_the_change_time_join_their_new_motion(switch, joins):
    goal = np.zeros((60, HINGE_COUNT))
    goal[20, 0] = 0.1
    goal[19, 1] = 0.1
    goal[59, NECK] = -0.1
    goal[30, 4] = SAME_ANGLE
    goal[:, 5] = 0.2
    controls = switch(running=motion(60, h5=0.2))._catch_up(goal)
    assert joins == {0: (0.0, 20, []), NECK: (0.0, 20, [])}
    expected = np.array(goal)
    expected[:, [0, NECK]] += 0.5
    expected[:23] = motion(23, h5=0.2).controls
    np.testing.assert_array_equal(controls, expected)


def test_arms_join_the_new_plan_at_keys_at_least_three_knots_away(switch, joins, known):
    plan = plan_quickly(parse(ROOT.format('<gesture id="g" lexeme="beat" mode="RIGHT_HAND"/>')), known)
    hinge = next(h for h in arm_hinges("r_hand", known.robot) if np.ptp(plan.trajectory.controls[:, h]) > 0.1)
    times = 0.25 * np.arange(len(plan.motion.planned))
    spaced = replace(plan, motion=replace(plan.motion, planned=times))
    goal = np.zeros((200, HINGE_COUNT))
    goal[100, [hinge, 0]] = 0.1
    exact = module.Keys.of(plan.postures.postures, known.limits).exact_rows[hinge]
    for knot, zero, first in ((22, 0.0, 25.0), (23, 0.0, 50.0), (23, 0.5, 50.0)):
        moved = switch(new_plan=spaced, running=motion(200), knot=knot)
        vars(moved)["zero"] = zero
        moved._catch_up(goal)
        places = [100.0 * zero + 25.0 * row for row in exact]
        assert joins[0][2] == []
        assert joins[hinge][2] == [place for place in places if place >= first]


def test_arm_joins_a_motionless_plan_without_keys(switch, joins, known):
    still = plan_quickly(parse(ROOT.format('<wait id="w" duration="1"/>')), known)
    hinge = arm_hinges("r_hand", known.robot)[0]
    goal = np.zeros((60, HINGE_COUNT))
    goal[40, hinge] = 0.1
    switch(new_plan=still, running=motion(60))._catch_up(goal)
    assert joins == {hinge: (0.0, 20, [])}


def test_change_to_a_new_motion_fails_if_one_hinge_cannot_join_it(switch, monkeypatch):
    monkeypatch.setattr(module, "_join", lambda *_: None)
    goal = np.zeros((60, HINGE_COUNT))
    assert switch(running=motion(60))._catch_up(goal) is not None
    goal[30, 0] = 0.1
    assert switch(running=motion(60))._catch_up(goal) is None


def test_replanned_block_has_old_times_of_finishing_and_new_times_of_other_behaviours(switch, nod):
    old = [SyncTime("g", "stroke", 1.0, 1.1), SyncTime("n", "stroke", 2.0, 2.1)]
    new = [SyncTime("g", "stroke", 1.0, 1.5), SyncTime("n", "stroke", 2.0, 0.4), SyncTime("a", "end", 3.0, 1.07)]
    playing = replace(merged(layer=motion(40, h3=0.2), syncs=old), notices=("an old notice",))
    moved = switch(
        running=motion(60, start=START, h3=0.1),
        playing=playing,
        playing_zero=nod.trajectory.zero + 0.03 - 0.004,
        new_plan=replace(nod, syncs=Syncs(new)),
    )
    controls = np.zeros((80, HINGE_COUNT))
    controls[:50, NECK] = 0.6
    result = moved._result(controls, {"g"}, [use("a", "sign", begin=1.0)])
    assert [(sync.behaviour, sync.planned) for sync in result.syncs] == [
        ("n", pytest.approx(0.404)),
        ("a", pytest.approx(1.074)),
        ("g", 1.1),
    ]
    np.testing.assert_allclose(
        result.layer.controls, controls - motion(80, h3=0.1).controls + motion(80, h3=0.2).controls
    )
    np.testing.assert_array_equal(result.trajectory.controls, controls[:53])
    assert (result.trajectory.start, result.layer.start) == (START, START)
    assert [entry.begin for entry in result.occupancy] == [START + 1.0]
    assert (result.notices, result.zero) == ((), playing.zero)
