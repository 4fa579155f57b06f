"""Tests of the scheduling of whole blocks."""

from collections.abc import Callable

import pytest

from kinesic.bml.block import BmlError, Drop, NoticeType, Timeline
from kinesic.bml.parse import parse
from kinesic.bml.schedule import schedule
from kinesic.body.utterance import Utterance

from .conftest import SPEECH_XML, at, gesture

Timing = Callable[[str], Timeline]


def drop_reasons(timeline: Timeline) -> dict[str, str]:
    return {drop.behaviour.id: drop.reason for drop in timeline.dropped}


def test_empty_block_has_an_empty_timeline(timed: Timing) -> None:
    timeline = timed("")
    assert (timeline.timed, timeline.dropped, timeline.notices, timeline.start, timeline.end) == ((), (), (), 0.0, 0.0)


def test_behaviour_without_time_constraints_starts_at_block_time_zero(timed: Timing) -> None:
    timeline = timed(gesture("g") + SPEECH_XML)
    assert at(timeline, "g:start") == at(timeline, "s:start") == 0.0


def test_post_stroke_hold_absorbs_spare_time_between_given_start_and_end(timed: Timing) -> None:
    timeline = timed(gesture("g", 'start="1" end="7"'))
    assert (at(timeline, "g:start"), at(timeline, "g:end")) == (1.0, 7.0)
    assert at(timeline, "g:relax") - at(timeline, "g:strokeEnd") > 4.0


def test_schedule_uses_the_natural_phase_durations_given_by_the_caller() -> None:
    block = parse('<bml id="b"><gesture id="g" lexeme="BEAT" stroke="9"/></bml>')
    spans = {"g": {"ready": 1.0, "strokeStart": 0.25, "stroke": 0.5, "end": 2.0}}
    timeline = schedule(block, {}, spans)
    assert at(timeline, "g:start") == pytest.approx(7.25)
    assert at(timeline, "g:ready") == pytest.approx(8.25)


# [s] phase durations of a gesture with two strokes
REPEATED_DURATIONS = {"g": {"ready": 0.5, "stroke": 0.3, "stroke:2": 0.6, "strokeEnd": 0.3, "relax": 0.2, "end": 0.5}}


def test_strokes_repeated_by_style_have_sync_points() -> None:
    block = parse('<bml id="b"><gesture id="g" lexeme="BEAT" stroke="2"/><gesture id="h" stroke="g:stroke:2"/></bml>')
    timeline = schedule(block, {}, REPEATED_DURATIONS)
    assert list(timeline.timed[0].times)[3:6] == ["stroke", "stroke:2", "strokeEnd"]
    assert at(timeline, "g:stroke") == 2.0
    assert at(timeline, "g:stroke:2") == at(timeline, "h:stroke") == pytest.approx(2.6)
    assert schedule(block, {}, {}).dropped[0].behaviour.id == "h"


def test_time_constraint_between_gestures_shortens_repeated_strokes_first() -> None:
    block = parse(
        '<bml id="b"><gesture id="g" lexeme="BEAT" start="0"/><gesture id="h" start="g:end" stroke="2.8"/>'
        '<constraint><before ref="h:start"><sync ref="g:relax"/></before></constraint></bml>'
    )
    times = schedule(block, {}, REPEATED_DURATIONS).timed[0].times
    assert times["stroke"] == pytest.approx(0.8)
    assert times["stroke:2"] - times["stroke"] < 0.6


def test_early_stroke_shortens_its_preparation_by_at_most_half(timed: Timing) -> None:
    natural = timed(gesture("g", 'stroke="5"'))
    preparation = at(natural, "g:ready") - at(natural, "g:start")
    lead = 5.0 - at(natural, "g:start")
    assert at(timed(gesture("g", f'stroke="{lead - 0.25 * preparation}"')), "g:start") == 0.0
    early = timed(gesture("g", f'stroke="{lead - preparation}"'))
    assert at(early, "g:start") == pytest.approx(-0.5 * preparation)
    assert at(early, "g:ready") - at(early, "g:start") == pytest.approx(0.5 * preparation)
    stroke_end = timed(gesture("g", 'stroke="-1"'))
    assert at(stroke_end, "g:ready") - at(stroke_end, "g:start") == pytest.approx(preparation)


def test_preparation_keeps_its_duration_if_other_behaviours_refer_to_its_start(timed: Timing) -> None:
    natural = timed(gesture("g", 'stroke="5"'))
    preparation = at(natural, "g:ready") - at(natural, "g:start")
    early = gesture("g", f'stroke="{5.0 - at(natural, "g:start") - 0.25 * preparation}"')
    after_ready = timed(early + gesture("h", 'start="g:ready"'))
    assert at(after_ready, "g:start") == 0.0
    after_start = timed(early + gesture("h", 'start="g:start"'))
    assert at(after_start, "h:start") == at(after_start, "g:start") == pytest.approx(-0.25 * preparation)


def test_stroke_coincides_with_the_speech_mark_that_it_references(timed: Timing) -> None:
    timeline = timed(SPEECH_XML.replace('id="s"', 'id="s" start="3"') + gesture("g", 'stroke="s:m" end="s:end+1"'))
    assert at(timeline, "s:m") == pytest.approx(3.6)
    assert at(timeline, "g:stroke") == at(timeline, "s:m")
    assert at(timeline, "g:end") == at(timeline, "s:end") + 1.0


def test_earliest_of_linked_behaviours_without_fixed_times_starts_at_zero(timed: Timing) -> None:
    timeline = timed(SPEECH_XML + gesture("g", 'start="s:start-2" end="s:start"') + gesture("h"))
    assert (at(timeline, "g:start"), at(timeline, "s:start"), at(timeline, "h:start")) == (0.0, 2.0, 0.0)


def test_chains_of_sync_references_are_resolved_in_any_order(timed: Timing) -> None:
    heads = [f'<head id="h{i}" lexeme="NOD" start="h{i + 1}:start-2"/>' for i in range(3)]
    timeline = timed("".join(heads) + '<head id="h3" lexeme="NOD" start="10"/>')
    assert [at(timeline, f"h{i}:start") for i in range(4)] == [4.0, 6.0, 8.0, 10.0]


def test_successive_behaviours_with_too_little_time_are_shortened_equally(timed: Timing) -> None:
    timeline = timed(gesture("a", 'start="0"') + gesture("b", 'start="a:end" end="2"'))
    assert at(timeline, "a:end") == at(timeline, "b:start") == pytest.approx(1.0)


def test_circular_but_consistent_references_are_scheduled(timed: Timing) -> None:
    timeline = timed(gesture("a", 'start="b:start" end="b:end"') + gesture("b"))
    assert timeline.dropped == ()
    assert (at(timeline, "a:start"), at(timeline, "a:end")) == (at(timeline, "b:start"), at(timeline, "b:end"))


def test_schedule_satisfies_after_and_before_constraints(timed: Timing) -> None:
    order = '<constraint><{0} ref="s:m"><sync ref="g:stroke+2"/></{0}></constraint>'
    after = timed(SPEECH_XML + gesture("g") + order.format("after"))
    assert (at(after, "s:start"), at(after, "g:start")) == (0.0, 0.0)
    assert at(after, "g:stroke") + 2.0 >= at(after, "s:m")
    previous = timed(SPEECH_XML + gesture("g") + order.format("before"))
    assert at(previous, "g:stroke") + 2.0 == pytest.approx(at(previous, "s:m"))
    attribute = timed(gesture("g", 'stroke="after(3)"'))
    assert at(attribute, "g:stroke") == pytest.approx(3.0)
    early = timed(SPEECH_XML + '<constraint><before ref="0.5"><sync ref="s:end"/></before></constraint>')
    assert (at(early, "s:start"), at(early, "s:end")) == pytest.approx((-1.0, 0.5))


def test_references_to_the_block_end_are_resolved(timed: Timing) -> None:
    timeline = timed(gesture("g", 'start="1"') + '<gaze id="z" target="t" start="0" end="bml:end"/>')
    assert at(timeline, "z:end") == pytest.approx(at(timeline, "g:end"))
    assert "leaves no time" in drop_reasons(timed(gesture("g", 'start="bml:end"')))["g"]
    fixed = timed(gesture("a", 'start="0" end="1"') + gesture("g", 'end="bml:end"'))
    assert at(fixed, "g:end") == pytest.approx(1.0)


def test_repeated_strokes_can_be_referenced(timed: Timing) -> None:
    nod = '<head id="h" lexeme="NOD" repetition="3" start="0" end="6"/>'
    timeline = timed(nod + gesture("g", 'stroke="h:stroke:2"') + gesture("f", 'stroke="h:stroke:4"'))
    assert (
        at(timeline, "h:stroke") < at(timeline, "h:stroke:2") < at(timeline, "h:stroke:3") < at(timeline, "h:strokeEnd")
    )
    assert at(timeline, "g:stroke") == at(timeline, "h:stroke:2")
    assert "no sync point 'stroke:4'" in drop_reasons(timeline)["f"]


@pytest.mark.parametrize(
    ("content", "dropped", "reason"),
    [
        (gesture("g", 'start="2" end="0"'), ["g"], "contradict each other by 2 s: g:start, g:end"),
        (gesture("g", 'start="g:start+1"'), ["g"], "by 1 s: g:start"),
        (gesture("g", 'stroke="s:nope"') + SPEECH_XML, ["g"], "s has no sync point 'nope', but start, m, end"),
        (gesture("g", 'stroke="other:x:end"'), ["g"], "other:x:end is unknown"),
        (gesture("a", 'start="b:end"') + gesture("b", 'start="a:end"'), ["b", "a"], "a:end -> b:start -> b:end"),
        (gesture("a", 'start="b:start+1"') + gesture("b", 'start="a:start+1"'), ["b", "a"], "a:start -> b:start"),
        (SPEECH_XML + gesture("g", 'start="s:m" end="s:start"'), ["g"], "contradict each other"),
    ],
)
def test_behaviours_with_infeasible_times_are_dropped_with_a_reason(
    timed: Timing, content: str, dropped: list[str], reason: str
) -> None:
    timeline = timed(content + gesture("other", 'start="1"'))
    assert list(drop_reasons(timeline)) == dropped
    assert reason in drop_reasons(timeline)[dropped[0]]
    assert [n.id for n in timeline.notices if ("is dropped" in n.text and n.id != "b:s") or "s" in dropped] != []
    assert {n.type for n in timeline.notices} == {NoticeType.IMPOSSIBLE_TO_SCHEDULE}
    assert at(timeline, "other:start") == 1.0


def test_each_dropped_behaviour_has_a_notice(timed: Timing) -> None:
    timeline = timed(gesture("a", 'start="1" end="0"') + gesture("b", 'start="a:end"') + gesture("c", 'end="b:end"'))
    assert list(drop_reasons(timeline)) == ["a", "b", "c"]
    assert [n.id for n in timeline.notices] == ["b:a", "b:b", "b:c"]


def test_references_to_dropped_behaviours_are_removed_but_their_owners_are_kept(timed: Timing) -> None:
    others = gesture("b", 'start="a:end" stroke="9"') + SPEECH_XML.replace('id="s"', 'id="s" start="a:end"')
    timeline = timed(gesture("a", 'start="1" end="0"') + others)
    assert list(drop_reasons(timeline)) == ["a"]
    assert (at(timeline, "b:stroke"), at(timeline, "s:start")) == (9.0, 0.0)
    assert {n.id for n in timeline.notices} == {"b:a", "b:b", "b:s"}


def test_dropped_behaviour_is_removed_from_all_time_constraints(timed: Timing) -> None:
    constraint = '<constraint><synchronize><sync ref="a:end"/><sync ref="c:end"/><sync ref="d:end"/></synchronize>'
    orders = '<after ref="a:end"><sync ref="c:start"/></after><after ref="1"><sync ref="a:end"/><sync ref="d:start"/>'
    timeline = timed(
        gesture("a", 'start="1" end="0"') + gesture("c") + gesture("d") + f"{constraint}{orders}</after></constraint>"
    )
    assert at(timeline, "c:end") == at(timeline, "d:end")
    assert at(timeline, "d:start") >= 1.0


def test_infeasible_time_constraints_are_ignored_with_a_notice(timed: Timing) -> None:
    mixed = '<constraint><after ref="5"><sync ref="3"/><sync ref="g:end"/></after></constraint>'
    assert [n.id for n in timed(gesture("g") + mixed).notices] == ["b"]
    timeline = timed(gesture("g") + '<constraint><after ref="5"><sync ref="3"/></after></constraint>')
    assert [n.id for n in timeline.notices] == ["b"]
    timeline = timed(gesture("g") + '<constraint><after ref="g:nope"><sync ref="g:end"/></after></constraint>')
    assert (len(timeline.notices), timeline.dropped) == (1, ())


@pytest.mark.parametrize(
    "content",
    [
        "<required>" + gesture("g", 'start="2" end="0"') + "</required>",
        "<required>" + gesture("g", 'start="s:nope"') + f"</required>{SPEECH_XML}",
        gesture("a", 'start="2" end="0"') + "<required>" + gesture("g", 'start="a:end"') + "</required>",
        gesture("a", 'start="2" end="0"')
        + '<required><constraint><synchronize><sync ref="a:end"/><sync ref="3"/></synchronize></constraint></required>',
        '<required><constraint><after ref="5"><sync ref="3"/></after></constraint></required>',
    ],
)
def test_infeasible_required_behaviour_or_constraint_rejects_the_block(timed: Timing, content: str) -> None:
    with pytest.raises(BmlError, match=r"^<text>:1:\d+: .*required.*; "):
        timed(content)


def test_optional_behaviour_that_contradicts_a_required_one_is_dropped(timed: Timing) -> None:
    loop = "<required>" + gesture("a", 'start="1"') + "</required>" + gesture("b", 'start="a:end" end="a:start"')
    assert list(drop_reasons(timed(loop + gesture("c", 'start="a:end"')))) == ["b"]


def test_speech_with_an_unknown_end_reference_keeps_its_start_time(timed: Timing) -> None:
    timeline = timed(SPEECH_XML.replace('id="s"', 'id="s" end="other:x:end" start="2"'))
    assert (at(timeline, "s:start"), timeline.dropped) == (2.0, ())
    assert [n.text for n in timeline.notices] == ["'s' is spoken without its end: other:x:end is unknown"]


def test_speech_that_contradicts_a_required_behaviour_is_dropped(timed: Timing) -> None:
    order = '<constraint><before ref="g:start"><sync ref="s:end"/></before></constraint>'
    required = "<required>" + gesture("g", 'start="1"') + "</required>"
    timeline = timed(SPEECH_XML.replace('id="s"', 'id="s" start="5"') + required + order)
    assert list(drop_reasons(timeline)) == ["s"]
    assert at(timeline, "g:start") == 1.0


def test_only_the_constraint_infeasible_for_speech_is_ignored(timed: Timing) -> None:
    met = '<constraint><after ref="1"><sync ref="g:start"/></after>'
    unmet = '<synchronize><sync ref="s:start"/><sync ref="s:end"/></synchronize></constraint>'
    timeline = timed(SPEECH_XML + gesture("g") + met + unmet)
    assert (at(timeline, "s:start"), at(timeline, "g:start")) == (0.0, 1.0)
    assert [n.text.split(":")[0] for n in timeline.notices] == ["a constraint (line 1) is ignored"]


def test_speech_whose_start_refers_to_its_own_mark_starts_at_zero(timed: Timing) -> None:
    timeline = timed(SPEECH_XML.replace('id="s"', 'id="s" start="s:m-0.6"'))
    assert (at(timeline, "s:start"), timeline.dropped) == (0.0, ())


def test_block_with_times_beyond_the_maximum_duration_is_rejected(timed: Timing) -> None:
    assert timed('<gazeShift id="z" start="0" end="915"/>').end == 915.0
    with pytest.raises(BmlError, match=r"at most 1200 s: split it"):
        timed(gesture("a", 'end="1200"') + gesture("b", 'start="a:end"'))


def test_behaviour_of_zero_or_ten_microseconds_is_scheduled(timed: Timing) -> None:
    timeline = timed('<head id="h" lexeme="NOD" start="0" end="0.00001"/><head id="i" lexeme="NOD" start="1" end="1"/>')
    assert (at(timeline, "h:end"), at(timeline, "i:end"), timeline.dropped) == (1e-5, 1.0, ())


def test_speech_for_which_no_voice_exists_is_dropped() -> None:
    block = parse('<bml id="b"><speech id="s"/></bml>')
    (drop,) = schedule(block, {}, {}).dropped
    assert drop == Drop(block.behaviours[0], "no voice speaks its text")


def test_marks_of_a_recorded_speech_are_sorted_by_time() -> None:
    block = parse('<bml id="b"><speech id="s"><tm id="x"/>a<tm id="y"/>b<tm id="z"/></speech></bml>')
    (timed,) = schedule(block, {"s": Utterance(2.0, {"y": 0.5, "x": 0.75})}, {}).timed
    assert list(timed.times.items()) == [
        *((sync, 0.0) for sync in ("start", "ready", "strokeStart", "stroke")),
        *(("y", 0.5), ("x", 0.75)),
        *((sync, 2.0) for sync in ("strokeEnd", "relax", "end")),
    ]


def test_references_to_other_blocks_use_the_given_times_of_those_blocks() -> None:
    block = parse('<bml id="b"><gesture id="g" lexeme="B" start="o:x:end+1"/></bml>')
    assert at(schedule(block, {}, {}, external_times={("o", "x", "end"): -0.5}), "g:start") == 0.5


def test_bml_draft_gaze_and_face_have_sync_points_of_draft_and_version_1_0() -> None:
    block = parse('<bml id="b"><gaze id="z" start="0"/><face id="f" end="4" lexeme="X"/></bml>')
    gaze, face = schedule(block, {}, {}).timed
    assert list(gaze.times) == ["start", "ready", "strokeStart", "stroke", "strokeEnd", "relax", "end"]
    assert set(face.times) == {*gaze.times, "attackPeak"}


DRAFT_FACE = (  # block of the BML draft; {} are attributes of the face and further elements
    '<bml xmlns="http://www.mindmakers.org/projects/BML" id="b"><face id="f" type="facs" au="12" start="1" {}/>{}</bml>'
)
RELAX_CONSTRAINT = (  # constraint that puts the relax point of the face at 3 s
    '<gaze id="z" start="3"/><constraint><synchronize ref="z:start"><sync ref="f:relax"/></synchronize></constraint>'
)


@pytest.mark.parametrize(
    ("stroke_end", "other_syncs", "relax", "end"),
    [
        ("", "", 2.1, 2.5),
        ('stroke_end="2"', "", 2.0, 2.4),
        ('stroke="1.5" stroke_end="3" end="4"', "", 3.0, 4.0),
        ('stroke_end="2" relax="2.5"', "", 2.5, 2.9),
        ('stroke_end="2"', RELAX_CONSTRAINT, 3.0, 3.4),
    ],
)
def test_bml_draft_face_relaxes_at_its_stroke_end_unless_relax_is_constrained(
    stroke_end: str, other_syncs: str, relax: float, end: float
) -> None:
    timeline = schedule(parse(DRAFT_FACE.format(stroke_end, other_syncs)), {}, {})
    assert not timeline.dropped
    assert (at(timeline, "f:relax"), at(timeline, "f:end")) == pytest.approx((relax, end))
