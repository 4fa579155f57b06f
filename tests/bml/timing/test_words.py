"""Tests of sync points tied to words."""

import pytest

from kinesic.bml.timing.words import find_tied_words
from kinesic.session.plan import plan

BML_TEMPLATE = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">{}</bml>'
SPEECH_XML = '<speech id="s" start="1.5"><text>Well, <sync id="m"/>hello to <sync id="n"/>you</text></speech>'


@pytest.fixture
def tied(known):
    def tied(text):
        timeline = plan(BML_TEMPLATE.format(SPEECH_XML + text), known).timeline
        return find_tied_words(timeline), {timed.behaviour.id: timed.times for timed in timeline.timed}

    return tied


def test_sync_point_is_tied_to_the_word_in_its_attribute(tied):
    words, times = tied('<gesture id="g" lexeme="beat" stroke="s:m + 0.3"/><head id="h" lexeme="NOD" start="s:n"/>')
    assert {point: word.name for point, word in words.items()} == {("g", "stroke"): "s:m", ("h", "start"): "s:n"}
    assert words["g", "stroke"].time == pytest.approx(times["s"]["m"] + 0.3)


def test_sync_points_are_tied_to_words_through_behaviours_and_constraints(tied):
    points = "".join(f'<sync ref="{ref}"/>' for ref in ("h:stroke", "s:n"))
    words, _ = tied(
        f"<constraint><synchronize>{points}</synchronize></constraint>"
        '<head id="h" lexeme="NOD"/><gesture id="g" lexeme="beat" stroke="h:stroke"/>'
    )
    assert {point: word.name for point, word in words.items()} == {("h", "stroke"): "s:n", ("g", "stroke"): "s:n"}


def test_fixed_times_speech_ends_and_after_constraints_tie_no_stroke_to_a_word(tied):
    after = '<constraint><after ref="s:m"><sync ref="k:stroke"/></after></constraint>'
    words, _ = tied(
        after + '<gesture id="g" lexeme="beat" stroke="s:end"/><head id="h" lexeme="NOD" stroke="2"/>'
        '<gesture id="k" lexeme="up" mode="LEFT_HAND"/>'
    )
    assert words == {}
