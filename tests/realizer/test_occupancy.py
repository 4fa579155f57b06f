import numpy as np
import pytest

from kinesic.bml.parse import parse
from kinesic.planning.quick_plan import plan_quickly
from kinesic.realizer.occupancy import (
    Occupancy,
    arm_hinges,
    freed_hinges,
    occupancy_of,
    settle_occupancy,
    still_occupied,
)

ROOT = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">{}</bml>'


@pytest.fixture(scope="module")
def planned(known):
    return lambda text: plan_quickly(parse(ROOT.format(text)), known)


def need(*roles, begin=0.0, ready=0.5, relax=1.0, end=1.5, offset=None, hinges=22) -> Occupancy:
    return Occupancy("a", frozenset(roles), np.ones(hinges, dtype=bool), begin, ready, relax, end, offset)


def test_each_behaviour_needs_its_own_part(planned, known):
    found = {
        each.behaviour: each
        for each in occupancy_of(
            planned("""
        <gesture id="g" lexeme="offer" mode="BOTH_HANDS" stroke="1"/>
        <pointing id="p" target="left" mode="LEFT_HAND" stroke="4"/>
        <head id="n" lexeme="NOD" start="1"/>
        <gaze id="z" target="left" start="0" end="3"/>
        <posture id="l" start="0" end="3"><pose part="WHOLEBODY" lexeme="LEANING_FORWARD"/></posture>
    """)
        )
    }
    assert {id: set(each.roles) for id, each in found.items()} == {
        "g": {"l_hand", "r_hand"},
        "p": {"l_hand"},
        "n": {"sign"},
        "z": {"look"},
        "l": {"trunk"},
    }
    left = list(known.robot.joints("l_arm"))
    assert found["p"].hinges[left].any()
    assert not np.delete(found["p"].hinges, left).any()
    for each in found.values():
        assert each.begin <= each.ready <= each.relax <= each.end


def test_times_are_those_of_the_plan(planned):
    plan = planned('<gesture id="g" lexeme="offer" mode="RIGHT_HAND" stroke="1.2"/>')
    (need,) = occupancy_of(plan)
    times = {sync.sync: sync.planned + plan.trajectory.zero for sync in plan.syncs}
    assert (need.begin, need.ready, need.relax, need.end) == pytest.approx(
        tuple(times[sync] for sync in ("start", "ready", "relax", "end"))
    )


def test_what_stays_says_by_how_much(planned, known):
    plan = planned('<gazeShift id="z" target="left" start="0" end="1"/>')
    (need,) = occupancy_of(plan)
    assert need.stays
    assert need.relax == need.end
    np.testing.assert_allclose(need.offset, plan.trajectory.controls[-1] - known.robot.skeleton.rest, atol=1e-9)
    (passing,) = occupancy_of(planned('<gaze id="z" target="left" start="0" end="1"/>'))
    assert not passing.stays


def test_two_meet_only_with_the_same_part_at_the_same_time():
    first = need("r_hand")
    assert first.meets(need("r_hand", "l_hand", ready=0.9, relax=2.0))
    assert not first.meets(need("l_hand"))
    assert not first.meets(need("r_hand").later(0.5))  # it is ready when the other relaxes
    assert need("sign").meets(need("sign"))
    assert not need("sign").meets(need("look"))


def test_what_has_given_way_no_longer_counts_but_what_stays_does():
    over, stays = need("r_hand"), need("look", offset=np.full(22, 0.1))
    later = need("look", offset=np.full(22, 0.2)).later(3.0)
    assert still_occupied([over, stays], 0.9) == (over, stays)
    assert still_occupied([over, stays], 2.0) == (stays,)
    assert still_occupied([stays, later], 9.0) == (later,)


def test_latest_held_posture_remains_even_if_an_older_one_is_settled_after_it():
    older, latest = need("look", offset=np.full(22, 0.1)), need("look", offset=np.ones(22)).later(1)
    settled = settle_occupancy([need("r_hand"), latest])
    (left,) = settle_occupancy([*settled, older])
    np.testing.assert_array_equal(left.offset, np.ones(22))
    assert not left.meets(need("look").later(2.5))


def test_an_interrupted_block_frees_the_arms_that_it_holds(known):
    robot, moved = known.robot, np.ones(22, dtype=bool)
    own = [need("r_hand"), need("l_hand").later(-2.0)]
    free = freed_hinges(own, moved, 0.2, robot)
    assert free[list(arm_hinges("r_hand", robot))].all()
    assert not free[list(arm_hinges("l_hand", robot))].any()
    assert free[list(robot.joints("neck"))].all()


def test_a_look_that_another_has_taken_over_from_frees_nothing(known):
    neck = np.zeros(22, dtype=bool)
    neck[list(known.robot.joints("neck"))] = True
    own = need("look", offset=np.where(neck, 0.3, 0.0))
    own = Occupancy(own.behaviour, own.roles, neck, own.begin, own.ready, own.relax, own.end, own.offset)
    assert freed_hinges([own], neck, 2.0, known.robot).any()
    assert not freed_hinges([own], neck, 2.0, known.robot, others=[need("look", offset=np.ones(22)).later(1.0)]).any()
