"""Crowds: whoever has no hand goes first, then the newest; required behaviours and those aside stay."""

import re
from dataclasses import replace

import pytest

from kinesic.bml.block import Notice, NoticeType, TimedBehaviour, Timeline
from kinesic.bml.parse import parse
from kinesic.expressivity.keyframes import KeyFrames, Outcome
from kinesic.planning.thinning import thin_out

ROOT = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">{}</bml>'
SPANS = {"a": (0.0, 2.0), "b": (1.0, 3.0), "c": (2.5, 4.0), "d": (3.0, 5.0), "aside": (5.5, 6.0)}
ALONE = {"aside": (5.5, 6.0)}


def frames(spans, *, required=(), waiting=(), uses=None):
    """Gestures of the right hand in the order of the document; those that wait found no hand."""
    lines = {id: f'<gesture id="{id}" lexeme="BEAT"/>' for id in spans}
    block = parse(
        ROOT.format("".join(f"<required>{lines[id]}</required>" if id in required else lines[id] for id in lines))
    )
    by_id = {behaviour.id: behaviour for behaviour in block.behaviours}
    timed = tuple(TimedBehaviour(by_id[id], {"start": begin, "end": end}) for id, (begin, end) in spans.items())
    outcomes = {id: Outcome("dropped", "busy") if id in waiting else Outcome("realised") for id in spans}
    notices = tuple(Notice(NoticeType.IMPOSSIBLE_TO_SCHEDULE, f"b:{id}", "busy") for id in waiting)
    parts = {id: frozenset() if id in waiting else frozenset({"r_hand"}) for id in spans} | (uses or {})
    return KeyFrames(Timeline(block, timed), (), outcomes, parts, notices)


def test_the_newest_of_a_crowd_go_and_what_is_aside_stays():
    assert thin_out(frames(SPANS), {"b"}, 0.5).keys() == {"c", "d"}
    assert thin_out(frames(SPANS), {"aside"}, 0.5) == {}


def test_what_the_document_requires_stays_before_what_is_older():
    assert thin_out(frames(SPANS, required=("d",)), {"b"}, 0.5).keys() == {"b", "c"}


def test_who_found_no_hand_goes_first_where_the_crowd_is():
    spans = {**SPANS, "late": (7.0, 8.0)}
    assert thin_out(frames(spans, waiting=("b", "late")), {"c"}).keys() == {"b"}


def test_parts_that_have_nothing_in_common_make_no_crowd():
    head = {id: frozenset({"head"}) for id in ("c", "d")}
    assert thin_out(frames(SPANS, uses=head), {"a"}, 0.5).keys() == {"b"}


def test_a_behaviour_of_both_parts_joins_their_crowds():
    parts = {"b": frozenset({"r_hand", "head"}), "c": frozenset({"head"}), "d": frozenset({"head"})}
    assert thin_out(frames(SPANS, uses=parts), {"a"}, 0.5).keys() == {"c", "d"}


@pytest.mark.parametrize("share", [0.5, 1.0])
def test_the_reason_says_how_many_when_and_how_many_are_kept(share):
    reasons = set(thin_out(frames(SPANS, waiting=("b",)), {"c"}, share).values())
    (why,) = reasons
    assert re.match(r"\d behaviours overlap from 2\.50 to 5\.00 s", why)
    assert f"{round(2 * share)} of them are kept, the others need times of their own" in why


def test_crowd_of_one_is_left_alone_and_a_share_is_rounded_up():
    assert thin_out(frames({"a": (0.0, 1.0)}), {"a"}, 0.0) == {}
    three = {id: SPANS[id] for id in "abc"}
    assert thin_out(frames(three), {"a"}, 0.5).keys() == {"c"}
    assert thin_out(frames(three), {"a"}, 0.0).keys() == {"a", "b", "c"}


def test_behaviours_that_only_touch_are_no_crowd():
    spans = {"a": (0.0, 1.0), "b": (1.0, 2.0), "c": (1.5, 3.0)}
    assert thin_out(frames(spans), {"a"}, 0.0) == {}
    assert thin_out(frames(spans), {"c"}, 0.0).keys() == {"b", "c"}


def test_long_behaviour_joins_all_that_begin_before_it_ends():
    spans = {"long": (0.0, 5.0), "a": (1.0, 2.0), "b": (3.0, 4.0), "c": (5.0, 6.0)}
    assert thin_out(frames(spans), {"b"}, 0.0).keys() == {"long", "a", "b"}


def test_who_found_no_hand_beside_the_crowd_stays():
    spans = {"before": (0.0, 1.0), "a": (1.0, 2.0), "b": (1.5, 3.0), "after": (3.0, 4.0)}
    assert thin_out(frames(spans, waiting=("before", "after")), {"a"}, 0.5).keys() == {"b"}
    spans["after"] = (2.9, 4.0)
    assert thin_out(frames(spans, waiting=("before", "after")), {"a"}, 0.5).keys() == {"b", "after"}


def test_who_was_dropped_for_another_reason_than_its_hand_stays():
    found = frames(SPANS, waiting=("b",))
    other = replace(found, notices=())
    assert thin_out(other, {"c"}).keys() == set()
    assert thin_out(found, {"c"}).keys() == {"b"}
    told = replace(found, outcomes={**found.outcomes, "b": Outcome("substituted", "other hand")})
    assert thin_out(told, {"c"}).keys() == set()
