"""Interruptions, busy hands and overlapping speech between blocks made by hand."""

from dataclasses import replace
from types import SimpleNamespace

import pytest

from kinesic.bml.actions import Interrupt
from kinesic.bml.block import NoticeType
from kinesic.bml.composition import BlockState
from kinesic.body.utterance import Utterance
from kinesic.expressivity.hands.busy_hands import BusyHand
from kinesic.realizer.contention import (
    drop_overlapping_speech,
    interrupted_by,
    occupancy_of_others,
    planned_interruptions,
    with_busy_hands,
)
from kinesic.realizer.scene import Scene

from .small_blocks import small_block, small_motion, use

STOP = '<bmla:interrupt id="i" target="{}"/>'
SPEECH = '<speech id="s"><text>Yes</text></speech>'


@pytest.fixture
def scene(known) -> Scene:
    return Scene.of(known)


def stopping(id: str, target: str, start: float, *, zero=0.0, extra: str = "", state=BlockState.IN_EXEC):
    """Return a block that interrupts another one at a block time [s]."""
    return small_block(id, {"i": {"start": start}}, inside=STOP.format(target) + extra, zero=zero, state=state)


@pytest.mark.parametrize(
    ("include", "exclude", "stopped"),
    [
        ((), (), {"g", "h"}),
        (("g",), (), {"g"}),
        (("g", "missing"), (), {"g"}),
        ((), ("g",), {"h"}),
        (("g", "h"), ("h",), {"g"}),
    ],
)
def test_interrupt_stops_the_included_behaviours_except_the_excluded_ones(include, exclude, stopped):
    assert interrupted_by(Interrupt("a", include, exclude), small_block("a", {"g": {}, "h": {}})) == stopped


def test_earliest_of_two_interruptions_of_a_behaviour_is_planned(scene):
    scene = scene.with_block(small_block("a", {"g": {}, "h": {}})).with_block(stopping("b", "a", 2.0, zero=10.0))
    assert planned_interruptions(scene, stopping("c", "a", 1.0, zero=10.0)) == {("a", "g"): 11.0, ("a", "h"): 11.0}
    assert planned_interruptions(scene, stopping("c", "a", 3.0, zero=10.0)) == {("a", "g"): 12.0, ("a", "h"): 12.0}


def test_interrupt_command_that_waits_or_was_dropped_or_has_no_target_stops_no_behaviour(scene):
    scene = scene.with_block(small_block("a", {"g": {}}))
    waiting = scene.with_block(stopping("w", "a", 1.0, state=BlockState.LURKING))
    dropped = small_block("d", {}, inside=STOP.format("a") + '<head id="h" lexeme="NOD"/>')
    assert planned_interruptions(waiting, dropped) == {}
    assert planned_interruptions(scene, stopping("b", "gone", 1.0)) == {}


@pytest.mark.parametrize(
    ("stop", "ready", "relax"), [(3.0, 2.0, 3.0), (1.5, 1.5, 1.5), (0.5, 1.0, 1.0), (9.0, 2.0, 4.0)]
)
def test_occupancy_relaxes_at_the_planned_interruption_and_keeps_its_end(scene, stop, ready, relax):
    entries = [use("g", "l_hand"), use("k", "r_hand")]
    scene = scene.with_block(small_block("a", {"g": {}}, motion=small_motion(), occupancy=entries))
    cut, whole = occupancy_of_others(scene, stopping("b", "a", stop))
    assert (cut.begin, cut.ready, cut.relax, cut.end) == (1.0, ready, relax, 5.0)
    assert (whole.behaviour, whole.ready, whole.relax) == ("a:k", 2.0, 4.0)


def request(attributes: str = "", *, start: float = -0.5):
    """Return a request whose time 0 is at 1.0 s."""
    made = small_block("b", attributes=attributes, zero=1.0).prepared.request
    return replace(made, timeline=SimpleNamespace(start=start, timed=()))


@pytest.fixture
def busy(scene) -> Scene:
    entries = [use("g", "l_hand"), use("k", "r_hand", "look", ready=2.5, relax=3.5), use("z", "look")]
    return scene.with_block(small_block("a", {"g": {}}, motion=small_motion(), occupancy=entries))


def test_busy_hands_of_running_blocks_are_given_in_the_time_of_the_new_block(busy):
    left, right = with_busy_hands(busy, request()).busy_hands
    assert left == BusyHand("l", pytest.approx(2.0 - 1.0 - 0.15), 3.0, "a:g")
    assert right == BusyHand("r", pytest.approx(2.5 - 1.0 - 0.15), 2.5, "a:k")


@pytest.mark.parametrize(("start", "busy_sides"), [(2.4, "lr"), (2.5, "l"), (2.6, "l"), (3.0, "")])
def test_hand_that_relaxes_before_the_block_starts_is_free(busy, start, busy_sides):
    found = with_busy_hands(busy, request(start=start)).busy_hands
    assert "".join(hand.side for hand in found) == busy_sides


@pytest.mark.parametrize(
    ("attributes", "count"),
    [
        ("", 2),
        ('bmla:interrupt="a"', 0),
        ('bmla:interrupt="other"', 2),
        ('composition="REPLACE"', 0),
        ('bmla:preplan="true"', 0),
    ],
)
def test_hands_are_free_for_a_block_that_is_preplanned_or_stops_the_block_that_uses_them(busy, attributes, count):
    assert len(with_busy_hands(busy, request(attributes)).busy_hands) == count


def speaking(id: str, zero: float, extra: str = "", times=None):
    """Return a block that speaks for one second."""
    at = {"s": {"start": 0.0}, **(times or {})}
    return small_block(id, at, inside=SPEECH + extra, utterances={"s": Utterance(1.0)}, zero=zero)


@pytest.mark.parametrize(
    ("zero", "is_dropped"), [(3.0, False), (3.1, True), (4.0, True), (4.9, True), (5.0, False), (6.0, False)]
)
def test_speech_that_overlaps_other_speech_is_dropped(scene, zero, is_dropped):
    coming, notices = drop_overlapping_speech(scene.with_block(speaking("a", 4.0)), speaking("b", zero))
    assert list(coming.times) == ([] if is_dropped else ["s"])
    assert [(notice.id, notice.type) for notice in notices] == [("b:s", NoticeType.IMPOSSIBLE_TO_SCHEDULE)] * is_dropped
    if is_dropped:
        assert "a:s speaks until 5.00 s" in notices[0].text


def test_speech_of_a_block_is_not_dropped_as_overlapping_with_itself(scene):
    own = speaking("b", 4.0)
    coming, notices = drop_overlapping_speech(scene.with_block(own), own)
    assert (list(coming.times), notices) == (["s"], ())


@pytest.mark.parametrize(("stop", "is_dropped"), [(0.0, False), (0.2, True), (9.0, True)])
def test_speech_may_begin_when_the_other_speech_is_interrupted(scene, stop, is_dropped):
    coming = speaking("b", 4.5, STOP.format("a"), {"i": {"start": stop}})
    _, notices = drop_overlapping_speech(scene.with_block(speaking("a", 4.0)), coming)
    assert len(notices) == is_dropped
