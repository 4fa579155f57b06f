"""Tests of overlapping behaviours dropped by priority."""

import re
from dataclasses import replace

import pytest

from kinesic.bml.block import Notice, NoticeType, TimedBehaviour, Timeline
from kinesic.bml.parse import parse
from kinesic.expressivity.keyframes import KeyFrames, Outcome
from kinesic.planning.thinning import drop_by_priority

# document whose {} is replaced by behaviours
BML_TEMPLATE = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">{}</bml>'
# [s] start and end of each behaviour; only the last one overlaps no other
BEHAVIOUR_SPANS = {"a": (0.0, 2.0), "b": (1.0, 3.0), "c": (2.5, 4.0), "d": (3.0, 5.0), "aside": (5.5, 6.0)}


def frames(spans, *, required=(), waiting=(), uses=None):
    """Return key frames of right-hand gestures, some without a free hand."""
    lines = {id: f'<gesture id="{id}" lexeme="BEAT"/>' for id in spans}
    block = parse(
        BML_TEMPLATE.format(
            "".join(f"<required>{lines[id]}</required>" if id in required else lines[id] for id in lines)
        )
    )
    by_id = {behaviour.id: behaviour for behaviour in block.behaviours}
    timed = tuple(TimedBehaviour(by_id[id], {"start": begin, "end": end}) for id, (begin, end) in spans.items())
    outcomes = {id: Outcome("dropped", "busy") if id in waiting else Outcome("realised") for id in spans}
    notices = tuple(Notice(NoticeType.IMPOSSIBLE_TO_SCHEDULE, f"b:{id}", "busy") for id in waiting)
    parts = {id: frozenset() if id in waiting else frozenset({"r_hand"}) for id in spans} | (uses or {})
    return KeyFrames(Timeline(block, timed), (), outcomes, parts, notices)


def test_last_half_of_overlapping_behaviours_is_dropped():
    assert drop_by_priority(frames(BEHAVIOUR_SPANS), {"b"}, 0.5).keys() == {"c", "d"}
    assert drop_by_priority(frames(BEHAVIOUR_SPANS), {"aside"}, 0.5) == {}


def test_required_overlapping_behaviours_are_dropped_last():
    assert drop_by_priority(frames(BEHAVIOUR_SPANS, required=("d",)), {"b"}, 0.5).keys() == {"b", "c"}


def test_overlapping_behaviours_without_free_hand_are_dropped_first():
    spans = {**BEHAVIOUR_SPANS, "late": (7.0, 8.0)}
    assert drop_by_priority(frames(spans, waiting=("b", "late")), {"c"}).keys() == {"b"}


def test_behaviours_of_different_body_parts_do_not_count_as_overlapping():
    head = {id: frozenset({"head"}) for id in ("c", "d")}
    assert drop_by_priority(frames(BEHAVIOUR_SPANS, uses=head), {"a"}, 0.5).keys() == {"b"}


def test_behaviour_with_two_body_parts_joins_both_groups_of_overlaps():
    parts = {"b": frozenset({"r_hand", "head"}), "c": frozenset({"head"}), "d": frozenset({"head"})}
    assert drop_by_priority(frames(BEHAVIOUR_SPANS, uses=parts), {"a"}, 0.5).keys() == {"c", "d"}


@pytest.mark.parametrize("share", [0.5, 1.0])
def test_drop_reason_of_overlapping_behaviours_names_counts_and_times(share):
    reasons = set(drop_by_priority(frames(BEHAVIOUR_SPANS, waiting=("b",)), {"c"}, share).values())
    (why,) = reasons
    assert re.match(r"\d behaviours overlap from 2\.50 to 5\.00 s", why)
    assert f"{round(2 * share)} of them are kept, the others need other times" in why


def test_number_of_kept_overlapping_behaviours_is_rounded_up():
    assert drop_by_priority(frames({"a": (0.0, 1.0)}), {"a"}, 0.0) == {}
    three = {id: BEHAVIOUR_SPANS[id] for id in "abc"}
    assert drop_by_priority(frames(three), {"a"}, 0.5).keys() == {"c"}
    assert drop_by_priority(frames(three), {"a"}, 0.0).keys() == {"a", "b", "c"}


def test_successive_behaviours_without_a_gap_do_not_count_as_overlapping():
    spans = {"a": (0.0, 1.0), "b": (1.0, 2.0), "c": (1.5, 3.0)}
    assert drop_by_priority(frames(spans), {"a"}, 0.0) == {}
    assert drop_by_priority(frames(spans), {"c"}, 0.0).keys() == {"b", "c"}


def test_long_behaviour_overlaps_all_behaviours_during_it():
    spans = {"long": (0.0, 5.0), "a": (1.0, 2.0), "b": (3.0, 4.0), "c": (5.0, 6.0)}
    assert drop_by_priority(frames(spans), {"b"}, 0.0).keys() == {"long", "a", "b"}


def test_behaviour_without_free_hand_is_dropped_only_inside_the_overlap():
    spans = {"before": (0.0, 1.0), "a": (1.0, 2.0), "b": (1.5, 3.0), "after": (3.0, 4.0)}
    assert drop_by_priority(frames(spans, waiting=("before", "after")), {"a"}, 0.5).keys() == {"b"}
    spans["after"] = (2.9, 4.0)
    assert drop_by_priority(frames(spans, waiting=("before", "after")), {"a"}, 0.5).keys() == {"b", "after"}


def test_overlap_drops_only_behaviours_without_a_free_hand():
    result = frames(BEHAVIOUR_SPANS, waiting=("b",))
    other = replace(result, notices=())
    assert drop_by_priority(other, {"c"}).keys() == set()
    assert drop_by_priority(result, {"c"}).keys() == {"b"}
    outcome = replace(result, outcomes={**result.outcomes, "b": Outcome("substituted", "other hand")})
    assert drop_by_priority(outcome, {"c"}).keys() == set()
