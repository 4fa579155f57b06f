"""Merged, replaced or appended blocks keep every limit, continuity and clearance."""

from functools import cache, lru_cache

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from kinesic.bml.parse import parse
from kinesic.motion.limit_check import check_limits
from kinesic.motion.trajectory import KNOT_INTERVAL, Trajectory, stay
from kinesic.motion.transition import extend_controls, knot_at
from kinesic.planning.clearance import LAG_RESERVE, scan_clearance
from kinesic.planning.plan import Plan, plan_block
from kinesic.planning.quick_plan import plan_quickly
from kinesic.realizer.merge import merge, replace_motion
from kinesic.realizer.occupancy import freed_hinges, remaining_occupancy
from kinesic.realizer.release import release_motion
from kinesic.realizer.replan import replan
from kinesic.session.setup import set_up

BLOCK_XML = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">{}</bml>'
BLOCK_CONTENTS = (
    '<head id="n" lexeme="NOD" repetition="2"/>',
    '<head id="s" lexeme="SHAKE"/>',
    '<gesture id="r" lexeme="beat" mode="RIGHT_HAND"/>',
    '<gesture id="l" lexeme="offer" mode="LEFT_HAND"/>',
    '<gesture id="b" lexeme="large" mode="BOTH_HANDS"/>',
    '<pointing id="p" target="left" mode="LEFT_HAND"/>',
    '<gaze id="z" target="right" start="0" end="1.6"/>',
    '<gazeShift id="g" target="left"/>',
    '<headDirectionShift id="d" target="right"/>',
    '<posture id="t" start="0" end="3"><pose part="WHOLEBODY" lexeme="LEANING_FORWARD"/></posture>',
    '<gesture id="v" lexeme="beat" mode="RIGHT_HAND" stroke="0.9"/><gesture id="w" lexeme="offer" mode="RIGHT_HAND" '
    'stroke="2.2"/><head id="m" lexeme="NOD" start="1"/>',
)
SCENE_ACTIONS = st.tuples(
    st.sampled_from(["over", "over", "over", "instead", "back", "otherwise"]),
    st.integers(0, len(BLOCK_CONTENTS) - 1),
    st.floats(0.0, 1.2),
)


@lru_cache(maxsize=1)
def known():
    return set_up()


@cache
def planned(index: int, *, quickly: bool) -> Plan:
    block = parse(BLOCK_XML.format(BLOCK_CONTENTS[index]))
    return plan_quickly(block, known()) if quickly else plan_block(block, known())


def check(before: Trajectory, after: Trajectory, time: float) -> None:
    count = knot_at(time) + 3
    same = [extend_controls(item.controls, count)[:count] for item in (before, after)]
    np.testing.assert_allclose(*same, atol=1e-8)
    for name, peak in check_limits(after, known().limits).by_quantity.items():
        assert peak.ratios.max() <= 1.001, name
    least = known().robot.min_clearance + LAG_RESERVE
    assert scan_clearance(after, known().distances)[1].distances.min() >= least - 1e-4
    np.testing.assert_allclose(after.controls[-3:], after.controls[[-1] * 3], atol=1e-8)


@settings(max_examples=12, deadline=None)
@given(st.lists(SCENE_ACTIONS, min_size=2, max_size=5), st.booleans())
def test_merging_replacing_and_releasing_blocks_keeps_limits_and_clearance(deeds, quickly):
    motion, time, playing = stay(known().robot.skeleton.rest), 0.0, []
    for what, index, later in deeds:
        time += later
        needs = [need for _, each in playing for need in each.occupancy]
        if what == "instead":
            replaced = replace_motion(motion, time, planned(index, quickly=quickly))
            after, playing = replaced.trajectory, [(index, replaced)]
        elif what == "back" and playing:
            _, gone = playing.pop(0)
            others = [need for _, each in playing for need in each.occupancy]
            moved = np.ptp(gone.layer.controls, axis=0) > 0.0
            free = freed_hinges(gone.occupancy, moved, time, known().robot, others=others)
            after = release_motion(motion, time, free, known(), layer=gone.layer, others=others)
        elif what == "otherwise" and playing:
            own, gone = playing.pop()
            others = [need for _, each in playing for need in each.occupancy]
            replaced = replan(motion, time, gone, planned(own, quickly=not quickly), others=others) or gone
            after = motion if replaced is gone else replaced.trajectory
            playing.append((own, replaced))
        else:
            replaced = merge(
                motion, time, planned(index, quickly=quickly), begin=time, occupied=remaining_occupancy(needs, time)
            )
            after = replaced.trajectory
            playing.append((index, replaced))
        check(motion, after, time)
        motion = after


@settings(max_examples=20, deadline=None)
@given(
    st.integers(0, len(BLOCK_CONTENTS) - 1),
    st.integers(0, len(BLOCK_CONTENTS) - 1),
    st.floats(0.0, 3.0),
    st.integers(0, 200),
)
def test_truncating_past_motion_does_not_change_a_later_merge(first, second, time, pieces):
    pieces = min(pieces, knot_at(time))
    one = merge(stay(known().robot.skeleton.rest), 0.0, planned(first, quickly=True), begin=0.0)
    other = one.since(pieces * KNOT_INTERVAL)
    over = merge(one.trajectory, time, planned(second, quickly=True), begin=time, occupied=one.occupancy)
    again = merge(other.trajectory, time, planned(second, quickly=True), begin=time, occupied=other.occupancy)
    assert again.dropped == over.dropped
    times = pieces * KNOT_INTERVAL + np.linspace(0.0, 6.0, 100)
    np.testing.assert_allclose(again.trajectory.sample(times)[0], over.trajectory.sample(times)[0], atol=1e-6)
