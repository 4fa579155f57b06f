"""Smaller and weaker gestures near people, whose strokes are less late."""

from dataclasses import replace

import pytest

from kinesic.bml.block import Block
from kinesic.planning.plan import Plan
from kinesic.planning.setup import Setup
from kinesic.planning.standing_plan import plan_standing_block
from kinesic.planning.timely_strokes import MAX_LATENESS, find_late_gestures, keep_strokes_in_time
from kinesic.session.documents import read_block
from kinesic.session.setup import set_up

GESTURES = """<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">
  <gesture id="early" lexeme="beat" stroke="1"/><gesture id="g" lexeme="louder" stroke="5"/></bml>"""

LOUDER = GESTURES.replace('<gesture id="early" lexeme="beat" stroke="1"/>', "").replace('stroke="5"', 'stroke="2"')


@pytest.fixture(scope="module")
def near() -> Setup:
    return set_up(near="child")


@pytest.fixture(scope="module")
def planned(near: Setup) -> Plan:
    """Return a plan made without people, as if it were made near children."""
    unlimited = replace(near, policy=None)
    return replace(plan_standing_block(read_block(GESTURES, unlimited, source="test"), unlimited), setup=near)


class Planner:
    """Planner that moves the strokes of a plan by the next given lateness [s]."""

    def __init__(self, plan: Plan, *lateness: float) -> None:
        self.plan, self.lateness, self.blocks = plan, list(lateness), list[Block]()

    def __call__(self, block: Block) -> Plan:
        self.blocks.append(block)
        return late_plan(self.plan, self.lateness.pop(0), block)

    @property
    def manners(self) -> list[tuple[float | None, float | None]]:
        return [(manner.spatial, manner.power) for block in self.blocks for manner in (block.behaviours[1].manner,)]


def late_plan(plan: Plan, lateness: float, block: Block | None = None) -> Plan:
    """Return a plan whose second gesture has a stroke later than requested."""
    syncs = type(plan.syncs)(
        replace(sync, planned=sync.requested + (lateness if sync.behaviour == "g" else 0.0)) for sync in plan.syncs
    )
    timeline = plan.timeline if block is None else replace(plan.timeline, block=block)
    return replace(plan, syncs=syncs, timeline=timeline, notices=(), seconds=1.0)


def test_stroke_that_would_be_late_near_children_is_in_time_with_a_smaller_gesture(near: Setup):
    plan = plan_standing_block(read_block(LOUDER, near, source="test"), near)
    assert find_late_gestures(plan) == {}
    (notice,) = [notice for notice in plan.notices if "performed with" in notice.text]
    assert notice.id == "b:g"
    assert notice.text.startswith("performed with spatial -1, because its stroke would be 0.")


def test_only_late_gestures_are_reduced_until_they_are_in_time(planned: Plan):
    planner = Planner(planned, 0.5, 0.0)
    best = keep_strokes_in_time(late_plan(planned, 0.8), planner)
    assert planner.manners == [(-1.0, None), (None, -1.0)]
    assert [block.behaviours[0].manner.spatial for block in planner.blocks] == [None, None]
    assert best.timeline.block is planner.blocks[1]
    assert [notice.text for notice in best.notices] == [
        "performed with power -1, because its stroke would be 0.80 s late near people"
    ]
    assert best.seconds == 3.0


def test_gesture_is_not_reduced_if_that_does_not_help(planned: Plan):
    first, planner = late_plan(planned, 0.8), Planner(planned, 0.9, 0.79)
    best = keep_strokes_in_time(first, planner)
    assert planner.manners == [(-1.0, None), (None, -1.0)]
    assert best.syncs is first.syncs
    assert best.notices == ()


def test_smaller_gesture_that_is_dropped_is_no_improvement(planned: Plan):
    outcomes = {name: replace(outcome, kind="dropped") for name, outcome in planned.keyframes.outcomes.items()}
    nothing = replace(planned, keyframes=replace(planned.keyframes, outcomes=outcomes))
    best = keep_strokes_in_time(late_plan(planned, 0.8), Planner(nothing, 0.0, 0.0))
    assert find_late_gestures(best) == {"g": pytest.approx(0.8)}


@pytest.mark.parametrize(("audience", "lateness"), [("nobody", 0.8), ("child", MAX_LATENESS)])
def test_gestures_are_not_replanned_without_people_or_without_late_strokes(
    planned: Plan, near: Setup, audience: str, lateness: float
):
    setup = near if audience == "child" else replace(near, policy=None)
    first = replace(late_plan(planned, lateness - 1e-9), setup=setup)
    assert keep_strokes_in_time(first, Planner(planned)) is first
