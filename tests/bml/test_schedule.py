"""Times of whole blocks: natural phases, what is dropped, what is refused."""

from collections.abc import Callable

import pytest

from kinesic.bml.block import BmlError, Drop, NoticeType, Timeline
from kinesic.bml.parse import parse
from kinesic.bml.schedule import schedule
from kinesic.body.utterance import Utterance

from .conftest import SPEECH, at, gesture

Timing = Callable[[str], Timeline]


def why(timeline: Timeline) -> dict[str, str]:
    return {drop.behaviour.id: drop.why for drop in timeline.dropped}


def test_an_empty_block(timed: Timing) -> None:
    found = timed("")
    assert (found.timed, found.dropped, found.notices, found.start, found.end) == ((), (), (), 0.0, 0.0)


def test_what_is_tied_to_nothing_starts_at_zero(timed: Timing) -> None:
    found = timed(gesture("g") + SPEECH)
    assert at(found, "g:start") == at(found, "s:start") == 0.0


def test_given_times_are_met_and_the_hold_after_the_stroke_takes_the_rest(timed: Timing) -> None:
    found = timed(gesture("g", 'start="1" end="7"'))
    assert (at(found, "g:start"), at(found, "g:end")) == (1.0, 7.0)
    assert at(found, "g:relax") - at(found, "g:strokeEnd") > 4.0


def test_natural_spans_are_taken_over() -> None:
    block = parse('<bml id="b"><gesture id="g" lexeme="BEAT" stroke="9"/></bml>')
    spans = {"g": {"ready": 1.0, "strokeStart": 0.25, "stroke": 0.5, "end": 2.0}}
    found = schedule(block, {}, spans)
    assert at(found, "g:start") == pytest.approx(7.25)
    assert at(found, "g:ready") == pytest.approx(8.25)


REPEATED = {"g": {"ready": 0.5, "stroke": 0.3, "stroke:2": 0.6, "strokeEnd": 0.3, "relax": 0.2, "end": 0.5}}


def test_a_stroke_that_style_repeats_has_sync_points_of_its_own() -> None:
    block = parse('<bml id="b"><gesture id="g" lexeme="BEAT" stroke="2"/><gesture id="h" stroke="g:stroke:2"/></bml>')
    found = schedule(block, {}, REPEATED)
    assert list(found.timed[0].times)[3:6] == ["stroke", "stroke:2", "strokeEnd"]
    assert at(found, "g:stroke") == 2.0
    assert at(found, "g:stroke:2") == at(found, "h:stroke") == pytest.approx(2.6)
    assert schedule(block, {}, {}).dropped[0].behaviour.id == "h"


def test_repetition_gives_way_where_gestures_hang_on_one_another() -> None:
    block = parse(
        '<bml id="b"><gesture id="g" lexeme="BEAT" start="0"/><gesture id="h" start="g:end" stroke="2.8"/>'
        '<constraint><before ref="h:start"><sync ref="g:relax"/></before></constraint></bml>'
    )
    times = schedule(block, {}, REPEATED).timed[0].times
    assert times["stroke"] == pytest.approx(0.8)
    assert times["stroke:2"] - times["stroke"] < 0.6


def test_an_early_stroke_shortens_its_preparation_to_half_at_most(timed: Timing) -> None:
    natural = timed(gesture("g", 'stroke="5"'))
    preparation = at(natural, "g:ready") - at(natural, "g:start")
    lead = 5.0 - at(natural, "g:start")
    assert at(timed(gesture("g", f'stroke="{lead - 0.25 * preparation}"')), "g:start") == 0.0
    early = timed(gesture("g", f'stroke="{lead - preparation}"'))
    assert at(early, "g:start") == pytest.approx(-0.5 * preparation)
    assert at(early, "g:ready") - at(early, "g:start") == pytest.approx(0.5 * preparation)
    asked = timed(gesture("g", 'stroke="-1"'))
    assert at(asked, "g:ready") - at(asked, "g:start") == pytest.approx(preparation)


def test_a_preparation_is_shortened_unless_others_hang_on_its_start(timed: Timing) -> None:
    natural = timed(gesture("g", 'stroke="5"'))
    preparation = at(natural, "g:ready") - at(natural, "g:start")
    early = gesture("g", f'stroke="{5.0 - at(natural, "g:start") - 0.25 * preparation}"')
    after_ready = timed(early + gesture("h", 'start="g:ready"'))
    assert at(after_ready, "g:start") == 0.0
    after_start = timed(early + gesture("h", 'start="g:start"'))
    assert at(after_start, "h:start") == at(after_start, "g:start") == pytest.approx(-0.25 * preparation)


def test_gestures_meet_the_marks_of_a_speech(timed: Timing) -> None:
    found = timed(SPEECH.replace('id="s"', 'id="s" start="3"') + gesture("g", 'stroke="s:m" end="s:end+1"'))
    assert at(found, "s:m") == pytest.approx(3.6)
    assert at(found, "g:stroke") == at(found, "s:m")
    assert at(found, "g:end") == at(found, "s:end") + 1.0


def test_what_hangs_together_but_on_nothing_else_starts_at_zero(timed: Timing) -> None:
    found = timed(SPEECH + gesture("g", 'start="s:start-2" end="s:start"') + gesture("h"))
    assert (at(found, "g:start"), at(found, "s:start"), at(found, "h:start")) == (0.0, 2.0, 0.0)


def test_a_chain_is_followed_in_any_order(timed: Timing) -> None:
    heads = [f'<head id="h{i}" lexeme="NOD" start="h{i + 1}:start-2"/>' for i in range(3)]
    found = timed("".join(heads) + '<head id="h3" lexeme="NOD" start="10"/>')
    assert [at(found, f"h{i}:start") for i in range(4)] == [4.0, 6.0, 8.0, 10.0]


def test_too_little_time_for_two_is_shared(timed: Timing) -> None:
    found = timed(gesture("a", 'start="0"') + gesture("b", 'start="a:end" end="2"'))
    assert at(found, "a:end") == at(found, "b:start") == pytest.approx(1.0)


def test_a_loop_that_can_be_met_is_met(timed: Timing) -> None:
    found = timed(gesture("a", 'start="b:start" end="b:end"') + gesture("b"))
    assert found.dropped == ()
    assert (at(found, "a:start"), at(found, "a:end")) == (at(found, "b:start"), at(found, "b:end"))


def test_after_and_before(timed: Timing) -> None:
    order = '<constraint><{0} ref="s:m"><sync ref="g:stroke+2"/></{0}></constraint>'
    after = timed(SPEECH + gesture("g") + order.format("after"))
    assert (at(after, "s:start"), at(after, "g:start")) == (0.0, 0.0)
    assert at(after, "g:stroke") + 2.0 >= at(after, "s:m")
    before = timed(SPEECH + gesture("g") + order.format("before"))
    assert at(before, "g:stroke") + 2.0 == pytest.approx(at(before, "s:m"))
    attribute = timed(gesture("g", 'stroke="after(3)"'))
    assert at(attribute, "g:stroke") == pytest.approx(3.0)


def test_the_end_of_the_block(timed: Timing) -> None:
    found = timed(gesture("g", 'start="1"') + '<gaze id="z" target="t" start="0" end="bml:end"/>')
    assert at(found, "z:end") == pytest.approx(at(found, "g:end"))
    assert "leave no time" in why(timed(gesture("g", 'start="bml:end"')))["g"]


def test_repeated_strokes(timed: Timing) -> None:
    nod = '<head id="h" lexeme="NOD" repetition="3" start="0" end="6"/>'
    found = timed(nod + gesture("g", 'stroke="h:stroke:2"') + gesture("f", 'stroke="h:stroke:4"'))
    assert at(found, "h:stroke") < at(found, "h:stroke:2") < at(found, "h:stroke:3") < at(found, "h:strokeEnd")
    assert at(found, "g:stroke") == at(found, "h:stroke:2")
    assert "no sync point 'stroke:4'" in why(found)["f"]


@pytest.mark.parametrize(
    ("inside", "dropped", "reason"),
    [
        (gesture("g", 'start="2" end="0"'), ["g"], "contradict one another by 2 s: g:start, g:end"),
        (gesture("g", 'start="g:start+1"'), ["g"], "by 1 s: g:start"),
        (gesture("g", 'stroke="s:nope"') + SPEECH, ["g"], "s has no sync point 'nope', but start, m, end"),
        (gesture("g", 'stroke="other:x:end"'), ["g"], "other:x:end is not known here"),
        (gesture("a", 'start="b:end"') + gesture("b", 'start="a:end"'), ["b", "a"], "a:end -> b:start -> b:end"),
        (gesture("a", 'start="b:start+1"') + gesture("b", 'start="a:start+1"'), ["b", "a"], "a:start -> b:start"),
        (SPEECH + gesture("g", 'start="s:m" end="s:start"'), ["g"], "contradict one another"),
    ],
)
def test_dropped(timed: Timing, inside: str, dropped: list[str], reason: str) -> None:
    found = timed(inside + gesture("other", 'start="1"'))
    assert list(why(found)) == dropped
    assert reason in why(found)[dropped[0]]
    assert [n.id for n in found.notices if ("is dropped" in n.text and n.id != "b:s") or "s" in dropped] != []
    assert {n.type for n in found.notices} == {NoticeType.IMPOSSIBLE_TO_SCHEDULE}
    assert at(found, "other:start") == 1.0


def test_every_drop_has_a_notice_that_names_it(timed: Timing) -> None:
    found = timed(gesture("a", 'start="1" end="0"') + gesture("b", 'start="a:end"') + gesture("c", 'end="b:end"'))
    assert list(why(found)) == ["a", "b", "c"]
    assert [n.id for n in found.notices] == ["b:a", "b:b", "b:c"]


def test_who_referred_to_a_dropped_behaviour_keeps_its_other_times_and_speech_always_stays(timed: Timing) -> None:
    others = gesture("b", 'start="a:end" stroke="9"') + SPEECH.replace('id="s"', 'id="s" start="a:end"')
    found = timed(gesture("a", 'start="1" end="0"') + others)
    assert list(why(found)) == ["a"]
    assert (at(found, "b:stroke"), at(found, "s:start")) == (9.0, 0.0)
    assert {n.id for n in found.notices} == {"b:a", "b:b", "b:s"}


def test_constraints_lose_what_is_dropped(timed: Timing) -> None:
    constraint = '<constraint><synchronize><sync ref="a:end"/><sync ref="c:end"/><sync ref="d:end"/></synchronize>'
    orders = '<after ref="a:end"><sync ref="c:start"/></after><after ref="1"><sync ref="a:end"/><sync ref="d:start"/>'
    found = timed(
        gesture("a", 'start="1" end="0"') + gesture("c") + gesture("d") + f"{constraint}{orders}</after></constraint>"
    )
    assert at(found, "c:end") == at(found, "d:end")
    assert at(found, "d:start") >= 1.0


def test_impossible_constraints_are_passed_over_with_a_notice(timed: Timing) -> None:
    mixed = '<constraint><after ref="5"><sync ref="3"/><sync ref="g:end"/></after></constraint>'
    assert [n.id for n in timed(gesture("g") + mixed).notices] == ["b"]
    found = timed(gesture("g") + '<constraint><after ref="5"><sync ref="3"/></after></constraint>')
    assert [n.id for n in found.notices] == ["b"]
    found = timed(gesture("g") + '<constraint><after ref="g:nope"><sync ref="g:end"/></after></constraint>')
    assert (len(found.notices), found.dropped) == (1, ())


@pytest.mark.parametrize(
    "inside",
    [
        "<required>" + gesture("g", 'start="2" end="0"') + "</required>",
        "<required>" + gesture("g", 'start="s:nope"') + f"</required>{SPEECH}",
        gesture("a", 'start="2" end="0"') + "<required>" + gesture("g", 'start="a:end"') + "</required>",
        gesture("a", 'start="2" end="0"')
        + '<required><constraint><synchronize><sync ref="a:end"/><sync ref="3"/></synchronize></constraint></required>',
        '<required><constraint><after ref="5"><sync ref="3"/></after></constraint></required>',
    ],
)
def test_what_is_required_refuses_the_block(timed: Timing, inside: str) -> None:
    with pytest.raises(BmlError, match=r"^<text>:1:\d+: .*required.*; "):
        timed(inside)


def test_what_is_required_stays_and_the_rest_gives(timed: Timing) -> None:
    loop = "<required>" + gesture("a", 'start="1"') + "</required>" + gesture("b", 'start="a:end" end="a:start"')
    assert list(why(timed(loop + gesture("c", 'start="a:end"')))) == ["b"]


def test_a_speech_loses_the_time_that_cannot_be_met_and_keeps_the_others(timed: Timing) -> None:
    found = timed(SPEECH.replace('id="s"', 'id="s" end="other:x:end" start="2"'))
    assert (at(found, "s:start"), found.dropped) == (2.0, ())
    assert [n.text for n in found.notices] == ["'s' is said without its end: other:x:end is not known here"]


def test_a_speech_gives_way_to_what_is_required(timed: Timing) -> None:
    order = '<constraint><before ref="g:start"><sync ref="s:end"/></before></constraint>'
    required = "<required>" + gesture("g", 'start="1"') + "</required>"
    found = timed(SPEECH.replace('id="s"', 'id="s" start="5"') + required + order)
    assert list(why(found)) == ["s"]
    assert at(found, "g:start") == 1.0


def test_of_the_constraints_the_one_that_a_speech_cannot_meet_is_passed_over(timed: Timing) -> None:
    met = '<constraint><after ref="1"><sync ref="g:start"/></after>'
    unmet = '<synchronize><sync ref="s:start"/><sync ref="s:end"/></synchronize></constraint>'
    found = timed(SPEECH + gesture("g") + met + unmet)
    assert (at(found, "s:start"), at(found, "g:start")) == (0.0, 1.0)
    assert [n.text.split(":")[0] for n in found.notices] == ["a constraint (line 1) is passed over"]


def test_a_speech_that_is_placed_by_its_own_mark_starts_at_zero(timed: Timing) -> None:
    found = timed(SPEECH.replace('id="s"', 'id="s" start="s:m-0.6"'))
    assert (at(found, "s:start"), found.dropped) == (0.0, ())


def test_the_longest_block(timed: Timing) -> None:
    assert timed('<gazeShift id="z" start="0" end="915"/>').end == 915.0
    with pytest.raises(BmlError, match=r"at most 1200 s: split it"):
        timed(gesture("a", 'end="1200"') + gesture("b", 'start="a:end"'))


def test_a_very_short_behaviour(timed: Timing) -> None:
    found = timed('<head id="h" lexeme="NOD" start="0" end="0.00001"/><head id="i" lexeme="NOD" start="1" end="1"/>')
    assert (at(found, "h:end"), at(found, "i:end"), found.dropped) == (1e-5, 1.0, ())


def test_a_speech_that_nobody_says_is_dropped() -> None:
    block = parse('<bml id="b"><speech id="s"/></bml>')
    (drop,) = schedule(block, {}, {}).dropped
    assert drop == Drop(block.behaviours[0], "nobody says its text")


def test_marks_come_in_the_order_of_their_times() -> None:
    block = parse('<bml id="b"><speech id="s"><tm id="x"/>a<tm id="y"/>b<tm id="z"/></speech></bml>')
    (timed,) = schedule(block, {"s": Utterance(2.0, {"y": 0.5, "x": 0.75})}, {}).timed
    assert list(timed.times.items()) == [
        *((sync, 0.0) for sync in ("start", "ready", "strokeStart", "stroke")),
        *(("y", 0.5), ("x", 0.75)),
        *((sync, 2.0) for sync in ("strokeEnd", "relax", "end")),
    ]


def test_other_blocks_that_are_known_give_times() -> None:
    block = parse('<bml id="b"><gesture id="g" lexeme="B" start="o:x:end+1"/></bml>')
    found = schedule(block, {}, {}, elsewhere={("o", "x", "end"): -0.5})
    assert at(found, "g:start") == 0.5


def test_gaze_and_face_of_the_drafts_have_the_points_of_both_versions() -> None:
    block = parse('<bml id="b"><gaze id="z" start="0"/><face id="f" end="4" lexeme="X"/></bml>')
    gaze, face = schedule(block, {}, {}).timed
    assert list(gaze.times) == ["start", "ready", "strokeStart", "stroke", "strokeEnd", "relax", "end"]
    assert set(face.times) == {*gaze.times, "attackPeak"}


DRAFT_FACE = (
    '<bml xmlns="http://www.mindmakers.org/projects/BML" id="b"><face id="f" type="facs" au="12" start="1" {}/>{}</bml>'
)


@pytest.mark.parametrize(
    ("asked", "more", "relax", "end"),
    [
        ("", "", 2.1, 2.5),
        ('stroke_end="2"', "", 2.0, 2.4),
        ('stroke="1.5" stroke_end="3" end="4"', "", 3.0, 4.0),
        ('stroke_end="2" relax="2.5"', "", 2.5, 2.9),
        (
            'stroke_end="2"',
            '<gaze id="z" start="3"/><constraint><synchronize ref="z:start"><sync ref="f:relax"/>'
            "</synchronize></constraint>",
            3.0,
            3.4,
        ),
    ],
)
def test_a_face_relaxes_where_its_stroke_is_to_end(asked: str, more: str, relax: float, end: float) -> None:
    found = schedule(parse(DRAFT_FACE.format(asked, more)), {}, {})
    assert not found.dropped
    assert (at(found, "f:relax"), at(found, "f:end")) == pytest.approx((relax, end))


def test_many_broken_behaviours(timed: Timing) -> None:
    found = timed("".join(gesture(f"g{i}", 'start="2" end="1"') for i in range(200)) + gesture("other"))
    assert len(found.dropped) == 200
    assert [x.behaviour.id for x in found.timed] == ["other"]


def test_a_long_chain_of_drops(timed: Timing) -> None:
    chain = "".join(gesture(f"g{i}", f'start="g{i - 1}:start"') for i in range(600, 0, -1))
    assert len(timed(chain + gesture("g0", 'start="2" end="1"')).dropped) == 601
