from dataclasses import replace

import numpy as np
import pytest

from kinesic.bml.parse import parse
from kinesic.planning.quick_plan import plan_quickly
from kinesic.realizer.occupancy import (
    Occupancy,
    arm_hinges,
    freed_hinges,
    occupancy_of,
    remaining_occupancy,
    settle_occupancy,
)

ROOT = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">{}</bml>'


@pytest.fixture(scope="module")
def planned(known):
    return lambda text: plan_quickly(parse(ROOT.format(text)), known)


def need(*roles, begin=0.0, ready=0.5, relax=1.0, end=1.5, offset=None, hinges=22) -> Occupancy:
    return Occupancy("a", frozenset(roles), np.ones(hinges, dtype=bool), begin, ready, relax, end, offset)


def test_each_behaviour_occupies_its_body_part(planned, known):
    occupancies = {
        item.behaviour: item
        for item in occupancy_of(
            planned("""
        <gesture id="g" lexeme="offer" mode="BOTH_HANDS" stroke="1"/>
        <pointing id="p" target="left" mode="LEFT_HAND" stroke="4"/>
        <head id="n" lexeme="NOD" start="1"/>
        <gaze id="z" target="left" start="0" end="3"/>
        <posture id="l" start="0" end="3"><pose part="WHOLEBODY" lexeme="LEANING_FORWARD"/></posture>
    """)
        )
    }
    assert {id: set(each.roles) for id, each in occupancies.items()} == {
        "g": {"l_hand", "r_hand"},
        "p": {"l_hand"},
        "n": {"sign"},
        "z": {"look"},
        "l": {"trunk"},
    }
    left = list(known.robot.joints("l_arm"))
    assert occupancies["p"].hinges[left].any()
    assert not np.delete(occupancies["p"].hinges, left).any()
    for each in occupancies.values():
        assert each.begin <= each.ready <= each.relax <= each.end


@pytest.mark.parametrize(
    ("missing", "ready", "relax"),
    [
        ((), "ready", "relax"),
        (("ready", "relax"), "strokeStart", "strokeEnd"),
        (("ready", "relax", "strokeStart", "strokeEnd"), "stroke", "stroke"),
        (("ready", "relax", "strokeStart", "strokeEnd", "stroke"), "end", "end"),
    ],
)
def test_hand_is_busy_between_the_nearest_available_sync_points(planned, missing, ready, relax):
    plan = planned('<gesture id="g" lexeme="offer" mode="RIGHT_HAND" stroke="1.2"/>')
    times = {sync.sync: sync.planned + plan.trajectory.zero for sync in plan.syncs}
    known_syncs = type(plan.syncs)(sync for sync in plan.syncs if sync.sync not in missing)
    (need,) = occupancy_of(replace(plan, syncs=known_syncs))
    assert (need.ready, need.relax) == pytest.approx((times[ready], times[relax]))


def test_occupancy_times_match_the_plan(planned):
    plan = planned('<gesture id="g" lexeme="offer" mode="RIGHT_HAND" stroke="1.2"/>')
    (need,) = occupancy_of(plan)
    times = {sync.sync: sync.planned + plan.trajectory.zero for sync in plan.syncs}
    assert (need.begin, need.ready, need.relax, need.end) == pytest.approx(
        tuple(times[sync] for sync in ("start", "ready", "relax", "end"))
    )


def test_occupancy_of_a_gaze_shift_contains_its_joint_offset_at_the_end(planned, known):
    plan = planned('<gazeShift id="z" target="left" start="0" end="1"/>')
    (need,) = occupancy_of(plan)
    assert need.is_held
    assert need.relax == need.end
    np.testing.assert_allclose(need.offset, plan.trajectory.controls[-1] - known.robot.skeleton.rest, atol=1e-9)
    (passing,) = occupancy_of(planned('<gaze id="z" target="left" start="0" end="1"/>'))
    assert not passing.is_held
    (turn,) = occupancy_of(planned('<headDirectionShift id="z" target="left" start="0" relax="1" end="2"/>'))
    assert turn.ready < 1.0 < turn.relax == turn.end


def test_behaviours_conflict_only_on_the_same_body_part_at_the_same_time():
    first = need("r_hand")
    assert first.conflicts_with(need("r_hand", "l_hand", ready=0.9, relax=2.0))
    assert not first.conflicts_with(need("l_hand"))
    assert not first.conflicts_with(need("r_hand").shifted(0.5))  # ready when the other one relaxes
    assert need("sign").conflicts_with(need("sign"))
    assert not need("sign").conflicts_with(need("look"))


def test_relaxed_occupancies_are_removed_and_held_ones_kept():
    over, stays = need("r_hand"), need("look", offset=np.full(22, 0.1))
    later = need("look", offset=np.full(22, 0.2)).shifted(3.0)
    assert remaining_occupancy([over, stays], 0.9) == (over, stays)
    assert remaining_occupancy([over, stays], 2.0) == (stays,)
    assert remaining_occupancy([stays, later], 9.0) == (later,)


def test_latest_held_posture_remains_if_an_older_one_is_processed_after_it():
    older, latest = need("look", offset=np.full(22, 0.1)), need("look", offset=np.ones(22)).shifted(1)
    settled = settle_occupancy([need("r_hand"), latest])
    (left,) = settle_occupancy([*settled, older])
    np.testing.assert_array_equal(left.offset, np.ones(22))
    assert not left.conflicts_with(need("look").shifted(2.5))


def test_interrupted_block_releases_only_the_arm_that_it_still_uses(known):
    robot, moved = known.robot, np.ones(22, dtype=bool)
    own = [need("r_hand"), need("l_hand").shifted(-2.0)]
    free = freed_hinges(own, moved, 0.2, robot)
    assert free[list(arm_hinges("r_hand", robot))].all()
    assert not free[list(arm_hinges("l_hand", robot))].any()
    assert free[list(robot.joints("neck"))].all()


def test_interrupted_gaze_that_was_superseded_releases_no_hinges(known):
    neck = np.zeros(22, dtype=bool)
    neck[list(known.robot.joints("neck"))] = True
    own = need("look", offset=np.where(neck, 0.3, 0.0))
    own = Occupancy(own.behaviour, own.roles, neck, own.begin, own.ready, own.relax, own.end, own.offset)
    assert freed_hinges([own], neck, 2.0, known.robot).any()
    assert not freed_hinges([own], neck, 2.0, known.robot, others=[need("look", offset=np.ones(22)).shifted(1.0)]).any()


def test_interrupted_gaze_is_released_if_another_one_ends_at_the_same_time(known):
    own = need("look", offset=np.full(22, 0.3))
    free = freed_hinges([own], np.ones(22, dtype=bool), 2.0, known.robot, others=[need("look", offset=np.ones(22))])
    assert free.all()
