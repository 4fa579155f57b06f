"""Any sequence of messages keeps limits, continuity and complete feedback."""

import re
from dataclasses import replace
from functools import lru_cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from kinesic.bml.block import BlockOrder, Composition
from kinesic.motion.limit_check import check_limits
from kinesic.planning.setup import Setup
from kinesic.realizer.realizer import PreparedBlock, Scene, ScheduledFeedback, advance, begin, interrupt, prepare_block
from kinesic.realizer.request import Message, read_request
from kinesic.session.setup import set_up

BLOCK_XML = (
    '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" xmlns:bmla="http://www.asap-project.org/bmla" '
    'id="b">{}</bml>'
)
BLOCK_CONTENTS = (
    "",
    '<head id="h" lexeme="NOD"/>',
    '<gesture id="g" lexeme="BEAT" mode="RIGHT_HAND"/>',
    '<gesture id="g" lexeme="BEAT" mode="LEFT_HAND"/><head id="h" lexeme="SHAKE"/>',
    '<gaze id="z" target="left"/>',
    '<bmla:interrupt id="i" target="b1" start="0.3"/><gesture id="g" lexeme="BEAT" mode="RIGHT_HAND" start="i:start"/>',
    '<bmla:interrupt id="i" target="b2" include="g"/><bmla:activate id="a" target="b3" start="0.2"/>',
    '<pointing id="p" target="audience" mode="RIGHT_HAND"/>',
    '<torso id="t" lexeme="lean" amount="1" start="0" end="1.6"/>',
    '<speech id="s"><text>Good <sync id="m"/>morning</text></speech><head id="h" lexeme="NOD" stroke="s:m"/>',
)
WIDE_MOTION = '<gesture id="g" lexeme="large" mode="BOTH_HANDS"/><head id="h" lexeme="SHAKE" repetition="3"/>'
MAX_LIMIT_RATIO = 1.0015  # largest accepted ratio of value / limit
TIME_RESOLUTION = 1e-6  # [s] resolution of the times in messages
REST_TOLERANCE = 2e-6  # [rad] largest distance from rest that counts as rest
CHANGE_TOLERANCES = (
    1e-8,
    1e-6,
    1e-4,
)  # Tolerances of position, velocity and acceleration [rad, rad/s, rad/s^2] at a change


@lru_cache(maxsize=1)
def known() -> Setup:
    return set_up()


@lru_cache(maxsize=16)
def made(inside: str) -> PreparedBlock:
    return prepare_block(read_request(Message(BLOCK_XML.format(inside)), known()), known())


def named(id: str, inside: str, composition: Composition, order: BlockOrder) -> PreparedBlock:
    """Return a copy of a plan with another block id."""
    result = made(inside)
    block = replace(result.plan.timeline.block, id=id, composition=composition, order=order)
    plan = replace(result.plan, timeline=replace(result.plan.timeline, block=block))
    return replace(result, plan=plan, request=replace(result.request, block=block))


ids = st.integers(0, 11).map("b{}".format)
successions = st.one_of(
    st.just(BlockOrder()),
    st.builds(BlockOrder, after=st.tuples(ids)),
    st.builds(BlockOrder, chunk_after=st.tuples(ids)),
    st.builds(BlockOrder, chunk_before=st.tuples(ids)),
    st.builds(BlockOrder, interrupts=st.tuples(ids)),
    st.builds(BlockOrder, activates=st.tuples(ids)),
    st.just(BlockOrder(preplanned=True)),
)
sent = st.tuples(st.sampled_from(BLOCK_CONTENTS), st.sampled_from(Composition), successions)
events = st.lists(st.tuples(st.floats(0.0, 0.6), st.one_of(sent, sent, sent, ids, st.none())), min_size=1, max_size=9)


class Watched:
    """Scene that checks limits and continuity after every change of its motion."""

    def __init__(self, ahead: float) -> None:
        self.scene = Scene.of(known(), ahead=ahead)
        self.told: list[ScheduledFeedback] = []

    def take(self, after: Scene, now: float) -> None:
        before, self.scene = self.scene, after
        self.told += after.outgoing_feedback
        if self.scene.motion is not before.motion:
            self._look(before, now + before.ahead)

    def _look(self, before: Scene, cut: float) -> None:
        scene = self.scene
        times = np.array([max(cut - 0.2, before.motion.start, scene.motion.start), cut])
        was, after = before.motion.sample(times), scene.motion.sample(times)
        for one, other, alike in zip(was, after, CHANGE_TOLERANCES, strict=True):
            np.testing.assert_allclose(other, one, rtol=0.0, atol=alike)
        for name, peak in check_limits(scene.motion, known().limits).by_quantity.items():
            assert peak.ratios.max() <= MAX_LIMIT_RATIO, name


@settings(max_examples=25, deadline=None)
@given(events, st.sampled_from([0.0, 0.13]))
def test_any_sequence_of_blocks_keeps_limits_continuity_and_complete_feedback(
    script: list[tuple[float, tuple[str, Composition, BlockOrder] | str | None]], ahead: float
) -> None:
    watched, now = Watched(ahead), 0.0
    for number, (pause, event) in enumerate(script):
        now += pause
        if event is None:
            watched.take(advance(watched.scene, now), now)
        elif isinstance(event, str):
            watched.take(interrupt(watched.scene, now, event), now)
        else:
            watched.take(begin(watched.scene, named(f"b{number}", *event), now), now)
    for _ in range(12):
        now += 1.7
        watched.take(advance(watched.scene, now), now)
    watched.take(interrupt(watched.scene, now), now)  # Blocks that were never activated
    watched.take(advance(watched.scene, now + 30.0), now + 30.0)
    check(watched.told)
    assert watched.scene.blocks == watched.scene.agenda == ()
    rest = known().robot.skeleton.rest
    assert watched.scene.motion.controls == pytest.approx(np.tile(rest, (4, 1)), abs=REST_TOLERANCE)


@pytest.mark.soak
@settings(max_examples=20, deadline=None)
@given(
    st.floats(0.0, 2.2), st.floats(0.0, 0.5), st.sampled_from(BLOCK_CONTENTS[1:5]), st.sampled_from(BLOCK_CONTENTS[1:5])
)
def test_repeated_replacement_during_motion_keeps_limits(first: float, second: float, one: str, other: str) -> None:
    watched = Watched(0.0)
    watched.take(begin(watched.scene, named("b0", WIDE_MOTION, Composition.MERGE, BlockOrder()), 0.0), 0.0)
    for time, id, inside in ((first, "b1", one), (first + second, "b2", other)):
        watched.take(begin(watched.scene, named(id, inside, Composition.REPLACE, BlockOrder()), time), time)
    watched.take(advance(watched.scene, 30.0), 30.0)
    check(watched.told)


def check(told: list[ScheduledFeedback]) -> None:
    """Assert that the feedback of every block is complete and ordered."""
    progress = [due for due in told if "Progress " in due.xml]
    keys = [written(due.xml, "id") for due in progress]
    assert len(set(keys)) == len(keys)
    latest: dict[str, float] = {}
    for due, key in zip(progress, keys, strict=True):
        time, block = float(written(due.xml, "globalTime")), key.partition(":")[0]
        assert time == pytest.approx(due.time, abs=TIME_RESOLUTION)
        assert (block in latest) != (key == f"{block}:start")
        assert time >= latest.get(block, time) - TIME_RESOLUTION
        latest[block] = time
    ends = {key.partition(":")[0] for key in keys if re.fullmatch(r"b\d+:end", key)}
    assert ends == latest.keys()
    revoked = {written(due.xml, "id") for due in told if "revoked before" in due.xml}
    assert revoked.isdisjoint(ends)
    asked_for = {
        key for due in told if "<predictionFeedback" in due.xml for key in re.findall(r'<bml id="([^"]*)"', due.xml)
    }
    assert asked_for == ends | revoked


def written(xml: str, attribute: str) -> str:
    result = re.search(rf' {attribute}="([^"]*)"', xml)
    assert result is not None
    return result[1]


def test_realizer_scene_is_deterministic() -> None:
    def played() -> np.ndarray:
        scene = Scene.of(known())
        for number, inside in enumerate(BLOCK_CONTENTS):
            scene = begin(scene, named(f"b{number}", inside, Composition.MERGE, BlockOrder()), 0.3 * number)
        return scene.motion.controls

    np.testing.assert_array_equal(played(), played())
