"""Times at which a block begins when it is merged with a running motion."""

from dataclasses import replace

import pytest

from kinesic.bml.parse import parse
from kinesic.motion.trajectory import stay
from kinesic.planning.quick_plan import plan_quickly
from kinesic.realizer.merge import _Merge, merge, replace_motion

from .certified import certified

ROOT = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">{}</bml>'
NOD = '<head id="n" lexeme="NOD"/>'
SPOKEN = '<speech id="s"><text>Yes, <sync id="m"/>indeed.</text></speech>'


@pytest.fixture(scope="module")
def planned(known):
    return lambda text: plan_quickly(parse(ROOT.format(text)), known)


@pytest.fixture(scope="module")
def rest(known):
    return stay(known.robot.skeleton.rest)


def gesture(hand: str, stroke: float = 0.9, id: str = "g", lexeme: str = "beat") -> str:
    return f'<gesture id="{id}" lexeme="{lexeme}" mode="{hand}_HAND" stroke="{stroke}"/>'


def test_silent_block_is_delayed_to_resolve_conflicts(planned, rest, known):
    first = merge(rest, 0.0, planned(NOD), begin=0.0)
    merged = merge(first.trajectory, 0.1, planned('<head id="m" lexeme="SHAKE"/>'), begin=0.1, occupied=first.occupancy)
    certified(merged.trajectory, known, first.trajectory, 0.1)
    assert merged.dropped == ()
    assert 0.1 < merged.zero - 0.1 <= 0.61
    assert [notice.id for notice in merged.notices] == ["b:m"]
    assert f"delayed by {merged.zero - 0.1:.3f} s" in merged.notices[0].text
    (need,) = merged.occupancy
    assert need.ready >= first.occupancy[0].relax - 1e-9


def test_replacing_block_is_not_reported_as_late_if_it_moves_before_its_time_zero(planned, rest):
    plan = planned(gesture("RIGHT", 0.2, lexeme="offer"))
    assert plan.trajectory.zero > 0.3
    replaced = replace_motion(rest, 1.0, plan)
    assert replaced.zero == pytest.approx(1.0 + plan.trajectory.zero, abs=0.01)
    assert replaced.notices == ()


def test_block_with_speech_is_not_delayed(planned, rest):
    first = merge(rest, 0.0, planned(NOD), begin=0.0)
    plan = planned(SPOKEN + '<head id="m" lexeme="SHAKE"/>')
    merged = merge(first.trajectory, 0.1, plan, begin=0.1, occupied=first.occupancy)
    assert merged.dropped == ("m",)
    assert merged.zero == pytest.approx(0.1)
    assert merged.trajectory is first.trajectory


@pytest.mark.parametrize(("spare", "delay"), [(0.07, 0.4), (0.22, 0.2), (0.37, 0.1), (0.52, 0.0)])
def test_block_is_delayed_until_its_arm_no_longer_collides_with_the_other_arm(planned, rest, known, spare, delay):
    """`spare` [s] after the first arm has relaxed, the second one is raised."""
    point = '<pointing id="{}" target="{}" mode="{}_HAND"/>'
    first = merge(rest, 0.0, planned(point.format("r", "left", "RIGHT")), begin=0.0)
    plan, time = planned(point.format("l", "right", "LEFT")), first.occupancy[0].relax + spare
    merged = merge(first.trajectory, time, plan, begin=time, occupied=first.occupancy)
    assert merged.dropped == ()
    assert merged.zero - plan.trajectory.zero - time == pytest.approx(delay, abs=0.0101)


def test_motion_of_a_block_with_its_stroke_at_time_zero_begins_before_the_block_start(planned, rest):
    plan = planned('<head id="n" lexeme="NOD" stroke="0"/>')
    assert plan.trajectory.zero > 0.2
    merged = merge(rest, 0.0, plan, begin=3.0)
    assert 0.0 <= merged.zero - 3.0 < 0.01
    assert merged.occupancy[0].begin == pytest.approx(3.0 - plan.trajectory.zero, abs=0.01)


def test_behaviour_relaxed_before_the_change_time_causes_no_conflict(planned, rest):
    first = merge(rest, 0.0, planned(gesture("RIGHT", 1.0, lexeme="offer")), begin=0.0)
    over = first.occupancy[0].relax + 0.005
    merged = merge(
        first.trajectory, over, planned(SPOKEN + gesture("RIGHT", 0.9)), begin=over, occupied=first.occupancy
    )
    assert merged.dropped == ()


@pytest.mark.parametrize(
    ("lacking", "delays"), [(0.4, [40, 50, 60]), (0.55, [55]), (0.595, [60]), (0.605, []), (0.9, [])]
)
def test_block_waits_at_most_0_6_seconds_for_a_conflict_to_end(planned, rest, lacking, delays):
    plan = planned(NOD)
    (own,) = _Merge.of(rest, 0.0, plan, (), 0.0).block_occupancy
    other = replace(own, begin=0.0, ready=own.ready, relax=own.ready + lacking, end=9.0)
    assert _Merge.of(rest, 0.0, plan, [other], plan.trajectory.zero)._delays == delays
