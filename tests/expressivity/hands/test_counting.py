"""Tests of counting with one hand, and of reported repetitions."""

import pytest

from kinesic.bml.parse import parse
from kinesic.bml.schedule import schedule
from kinesic.expressivity.context import BlockContext
from kinesic.expressivity.durations import natural_durations
from kinesic.expressivity.keyframes import KeyFrames
from kinesic.expressivity.realise import make_keyframes

NUMBER_WORDS = ("one", "two", "three", "four", "five")


@pytest.fixture
def realise(known):
    def realise(inside: str) -> KeyFrames:
        block = parse(f'<bml id="b">{inside}</bml>')
        context = BlockContext(block, known.context)
        return make_keyframes(schedule(block, {}, natural_durations(context)), context)

    return realise


def count(apart: float, attributes: str = "") -> str:
    return "".join(
        f'<gesture id="g{k}" lexeme="{name}" stroke="{2 + k * apart}" {attributes}/>'
        for k, name in enumerate(NUMBER_WORDS)
    )


def hands(frames: KeyFrames) -> list[frozenset[str]]:
    return [frames.uses[f"g{k}"] for k in range(len(NUMBER_WORDS))]


@pytest.mark.parametrize("apart", [0.45, 0.7, 1.0, 2.0])
def test_finger_counting_uses_only_the_right_hand(realise, apart):
    frames = realise(count(apart))
    assert hands(frames) == [frozenset({"r_hand"})] * len(NUMBER_WORDS)
    for timed in frames.timeline.timed:
        assert list(timed.times.values()) == sorted(timed.times.values())


def test_shortened_counting_strokes_are_reported(realise):
    outcomes = realise(count(0.35)).outcomes.values()
    brief = [outcome for outcome in outcomes if "shown once, without its movement" in outcome.why]
    assert brief
    assert all(outcome.kind == "substituted" for outcome in brief)
    assert not any("without its movement" in outcome.why for outcome in realise(count(4.0)).outcomes.values())


def test_shortened_counting_stroke_has_equal_stroke_start_stroke_and_stroke_end_times(realise):
    frames = realise(count(0.35))
    assert any("without its movement" in outcome.why for outcome in frames.outcomes.values())
    for timed in frames.timeline.timed:
        if "without its movement" in frames.outcomes[timed.behaviour.id].why:
            assert timed.times["strokeStart"] == timed.times["stroke"] == timed.times["strokeEnd"]


def test_counting_strokes_0_24_s_apart_are_shortened_instead_of_dropped(realise):
    frames = realise(count(0.24))
    assert "dropped" not in {outcome.kind for outcome in frames.outcomes.values()}
    assert hands(frames) == [frozenset({"r_hand"})] * len(NUMBER_WORDS)
    assert frames.outcomes["g1"].why.endswith("shown once, without its movement: the right hand does g2 from 2.48 s on")
    strokes = [timed.times["stroke"] for timed in frames.timeline.timed]
    assert strokes == pytest.approx([2 + 0.24 * k for k in range(len(NUMBER_WORDS))])


def test_counting_stroke_with_a_fixed_end_is_dropped_instead_of_shortening_the_stroke_before(realise):
    held = count(0.24).replace('lexeme="two"', 'lexeme="two" strokeEnd="2.66"')
    outcomes = realise(held).outcomes
    assert outcomes["g2"].kind == "dropped"
    assert "without its movement" not in outcomes["g1"].why


def test_document_may_choose_the_hand_that_counts_on_fingers(realise):
    assert hands(realise(count(2.0, 'mode="LEFT_HAND"'))) == [frozenset({"l_hand"})] * len(NUMBER_WORDS)
    mixed = realise(count(2.0).replace('lexeme="two"', 'lexeme="two" mode="LEFT_HAND"'))
    assert [sorted(used) for used in hands(mixed)] == [["r_hand"], ["l_hand"], *[["r_hand"]] * 3]


def test_successive_beats_0_3_s_apart_use_both_hands(realise):
    beats = "".join(f'<gesture id="g{k}" lexeme="beat" stroke="{2 + k * 0.3}"/>' for k in range(len(NUMBER_WORDS)))
    assert len(set(hands(realise(beats)))) == 2


def test_dropped_stroke_repetition_has_no_sync_point(realise):
    again = '<gesture id="g" lexeme="beat" kinesic:repetition="1" stroke="1" {}/>'
    none, all_of_them = (realise(again.format(end)) for end in ('strokeEnd="1"', 'strokeEnd="4"'))
    assert not any(sync.startswith("stroke:") for sync in none.timeline.timed[0].times)
    assert any("done once, not 3" in notice.text for notice in none.notices)
    assert {"stroke:2", "stroke:3"} <= all_of_them.timeline.timed[0].times.keys()


def test_face_behaviour_without_lexeme_or_action_unit_is_dropped(realise):
    frames = realise('<face id="f" start="0"/><face id="happy" type="happy"/><face id="unit" au="1"/>')
    assert {id: outcome.kind for id, outcome in frames.outcomes.items()} == {
        "f": "dropped",
        "happy": "realised",
        "unit": "realised",
    }
