"""Merged motion of blocks with dropped behaviours."""

from functools import lru_cache

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from kinesic.bml.parse import parse
from kinesic.motion.trajectory import stay
from kinesic.planning.plan import Plan, plan_block
from kinesic.planning.quick_plan import plan_quickly
from kinesic.planning.setup import Setup
from kinesic.realizer.merge import merge
from kinesic.realizer.occupancy import ARM_ROLES, Occupancy, arm_hinges, occupancy_of
from kinesic.session.setup import set_up

from ...examples import examples

BLOCK_XML = (
    '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b"><wait id="w" start="0" duration="9"/>{}</bml>'
)
BEHAVIOUR_ELEMENTS = {
    "nod": '<head id="nod" lexeme="NOD" start="0.5" end="3.5" repetition="4"/>',
    "shake": '<head id="shake" lexeme="SHAKE" start="4" end="6"/>',
    "gaze": '<gaze id="gaze" target="right" start="0.2" ready="1.2" relax="5" end="6"/>',
    "shift": '<gazeShift id="shift" target="left" start="6.5" end="8"/>',
    "lean": '<torso id="lean" lexeme="lean" amount="1" start="1" end="4"/>',
    "posture": '<posture id="posture" start="2" end="8"><pose part="BODY" lexeme="LEANING_FORWARD"/></posture>',
    "beat": '<gesture id="beat" lexeme="beat" mode="RIGHT_HAND" stroke="2"/>',
    "offer": '<gesture id="offer" lexeme="offer" mode="LEFT_HAND" stroke="3"/>',
    "large": '<gesture id="large" lexeme="large" mode="BOTH_HANDS" stroke="6"/>',
    "point": '<pointing id="point" target="left" mode="LEFT_HAND" stroke="6.5"/>',
}
# sets of behaviours of one block
BEHAVIOUR_SETS = st.lists(st.sampled_from(sorted(BEHAVIOUR_ELEMENTS)), min_size=2, max_size=5, unique=True)
ANGLE_TOLERANCE = 1e-6  # [rad] largest difference of equal angles


@lru_cache(maxsize=1)
def setup_once() -> Setup:
    return set_up()


def planned(ids: list[str], *, quickly: bool) -> Plan:
    block = parse(BLOCK_XML.format("".join(BEHAVIOUR_ELEMENTS[id] for id in ids)))
    return plan_quickly(block, setup_once()) if quickly else plan_block(block, setup_once())


@examples(33)
@given(BEHAVIOUR_SETS, st.integers(0, 4), st.booleans())
def test_merged_block_with_dropped_behaviours_equals_its_plan_without_them(
    ids: list[str], choice: int, quickly: bool
) -> None:
    robot = setup_once().robot
    plan = planned(ids, quickly=quickly)
    entries = occupancy_of(plan)
    busy = entries[choice % len(entries)]
    still = np.zeros(len(robot.skeleton.hinges), dtype=np.bool_)
    others = [Occupancy("other:o", busy.roles, still, begin=-2.0, ready=-1.0, relax=99.0, end=99.0)]
    merged = merge(stay(robot.skeleton.rest), 0.0, plan, begin=30.0, occupied=others)
    assert set(merged.dropped) == {entry.behaviour for entry in entries if entry.roles & busy.roles}
    remaining = [id for id in ids if id not in merged.dropped]
    if not remaining:
        assert not merged.layer.controls.any()
        return
    expected = planned(remaining, quickly=quickly)
    hinges = [*robot.joints("torso"), *robot.joints("neck")]
    hinges += [
        hinge
        for role in ARM_ROLES
        for entry in merged.occupancy
        if role in entry.roles
        for hinge in arm_hinges(role, robot)
    ]
    times = np.linspace(0.0, expected.trajectory.duration + 0.5, 300)
    shift = merged.zero - expected.trajectory.zero
    result, alone = (
        trajectory.sample(at)[0][:, hinges]
        for trajectory, at in ((merged.trajectory, times + shift), (expected.trajectory, times))
    )
    np.testing.assert_allclose(result, alone, atol=ANGLE_TOLERANCE)
