"""Which sync points a document ties to words."""

import pytest

from kinesic.bml.timing.words import find_words
from kinesic.controller.perform import plan

ROOT = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">{}</bml>'
SPEECH = '<speech id="s" start="1.5"><text>Well, <sync id="m"/>hello to <sync id="n"/>you</text></speech>'


@pytest.fixture
def tied(known):
    def tied(text):
        timeline = plan(ROOT.format(SPEECH + text), known).timeline
        return find_words(timeline), {timed.behaviour.id: timed.times for timed in timeline.timed}

    return tied


def test_a_point_has_the_word_of_its_attribute_with_the_offset_of_the_document(tied):
    found, times = tied('<gesture id="g" lexeme="beat" stroke="s:m + 0.3"/><head id="h" lexeme="NOD" start="s:n"/>')
    assert {point: word.name for point, word in found.items()} == {("g", "stroke"): "s:m", ("h", "start"): "s:n"}
    assert found["g", "stroke"].time == pytest.approx(times["s"]["m"] + 0.3)


def test_words_are_found_through_other_behaviours_and_constraints(tied):
    points = "".join(f'<sync ref="{ref}"/>' for ref in ("h:stroke", "s:n"))
    found, _ = tied(
        f"<constraint><synchronize>{points}</synchronize></constraint>"
        '<head id="h" lexeme="NOD"/><gesture id="g" lexeme="beat" stroke="h:stroke"/>'
    )
    assert {point: word.name for point, word in found.items()} == {("h", "stroke"): "s:n", ("g", "stroke"): "s:n"}


def test_a_time_the_end_of_a_speech_and_an_order_are_no_words(tied):
    after = '<constraint><after ref="s:m"><sync ref="k:stroke"/></after></constraint>'
    found, _ = tied(
        after + '<gesture id="g" lexeme="beat" stroke="s:end"/><head id="h" lexeme="NOD" stroke="2"/>'
        '<gesture id="k" lexeme="up" mode="LEFT_HAND"/>'
    )
    assert found == {}
