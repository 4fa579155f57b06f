"""Talks without a server: when something may be said, who has the turn, and what gives way."""

from math import inf, isfinite

import pytest

from kinesic.intent.talk import SETTLED, SILENT
from kinesic.planning.setup import Setup
from kinesic.realizer.realizer import Scene, begin, prepare_block
from kinesic.realizer.request import Message, read_request
from kinesic.serve.messages import Words
from kinesic.serve.queues import MOST_TEXT
from kinesic.serve.talks import LEAD, Talks


@pytest.fixture
def scene(known: Setup) -> Scene:
    return Scene.of(known)


def performed(scene: Scene, bml: str, now: float) -> Scene:
    request = read_request(Message(bml), scene.setup, context=scene.context(now))
    return begin(scene, prepare_block(request, scene.setup), now)


def texts(talks: Talks, scene: Scene, now: float) -> list[tuple[int, str]]:
    """What is said until nothing more is whole, as if it took no time."""
    found = []
    while (phrase := talks.next_phrase(scene, now)) is not None:
        found.append((phrase.sender, phrase.text))
    return found


def test_as_many_letters_wait_as_may():
    talks = Talks()
    assert talks.take(Words("x" * MOST_TEXT, 1), 0.0) == ""
    assert "letters wait" in talks.take(Words("y", 1), 0.0)
    assert talks.take(Words("y", 2), 0.0) == "", "each client for itself"
    assert talks.senders == {1, 2}
    refused = Talks()
    assert refused.take(Words("x" * (MOST_TEXT + 1), 1), 0.0)
    assert refused.senders == frozenset()


def test_bytes_are_words_too(scene: Scene):
    talks = Talks()
    talks.take(Words("Voil\u00e0 all. ".encode(), 1, ends=True), 0.0)
    assert texts(talks, scene, 0.0) == [(1, "Voil\u00e0 all")]


def test_nothing_may_be_said_before_anything_has_come(scene: Scene):
    talks = Talks()
    assert talks.next_time(scene) == inf
    assert talks.next_phrase(scene, 0.0) is None
    assert list(talks.finished(scene.setup)) == []


def test_words_are_looked_at_when_they_have_settled_and_when_it_stays_silent(scene: Scene):
    talks = Talks()
    talks.take(Words("I never saw", 1), 10.0)
    assert talks.next_time(scene) == pytest.approx(10.0 + SETTLED)
    assert talks.next_phrase(scene, 10.0 + SETTLED) is None
    assert talks.next_time(scene) == pytest.approx(10.0 + SILENT)
    phrase = talks.next_phrase(scene, 10.0 + SILENT)
    assert phrase is not None
    assert phrase.text == "I never saw"
    assert talks.next_time(scene) == inf, "more words are awaited"


def test_further_words_begin_the_wait_anew(scene: Scene):
    talks = Talks()
    talks.take(Words("I never", 1), 10.0)
    talks.take(Words(" saw", 1), 11.5)
    assert talks.next_phrase(scene, 12.5) is None
    assert talks.next_phrase(scene, 11.5 + SILENT + 0.01) is not None


def test_clients_have_their_turn_phrase_by_phrase(scene: Scene):
    talks = Talks()
    talks.take(Words("We saw the sea and the sky above it. We went home after that, very late. ", 1, ends=True), 0.0)
    talks.take(Words("Here I am. ", 2, ends=True), 0.0)
    said = texts(talks, scene, 5.0)
    assert [sender for sender, _ in said][:2] == [1, 2]
    assert {sender for sender, _ in said} == {1, 2}


def test_blocks_are_counted_for_each_client_and_the_end_names_the_last(scene: Scene):
    talks = Talks()
    talks.take(Words("We saw the sea and the sky above it. ", 1), 0.0)
    first = talks.next_phrase(scene, 5.0)
    assert first is not None
    assert first.block == "said1-1"
    assert list(talks.finished(scene.setup)) == []
    talks.take(Words("Here I am. ", 1, ends=True), 6.0)
    blocks = []
    while (phrase := talks.next_phrase(scene, 9.0)) is not None:
        blocks.append(phrase.block)
    assert blocks == [f"said1-{k + 2}" for k in range(len(blocks))]
    assert list(talks.finished(scene.setup)) == [(1, blocks[-1])]
    assert talks.senders == frozenset()
    assert list(talks.finished(scene.setup)) == []


def test_the_next_phrase_is_planned_a_little_before_the_last_word(scene: Scene):
    speaking = performed(
        scene,
        '<bml id="a"><speech id="s"><text>One two three four five six seven eight nine ten</text></speech></bml>',
        0.0,
    )
    (spoken,) = speaking.speeches
    talks = Talks()
    talks.take(Words("Here I am. ", 2, ends=True), 0.0)
    assert talks.next_phrase(speaking, 0.2) is None
    assert talks.next_time(speaking) <= spoken.end - LEAD
    assert talks.next_phrase(speaking, spoken.end - LEAD - 0.05) is None
    assert talks.next_time(speaking) == pytest.approx(spoken.end - LEAD)
    phrase = talks.next_phrase(speaking, spoken.end - LEAD + 0.05)
    assert phrase is not None
    assert 'start="a:s:end+' in phrase.bml.replace("'", '"')


def test_nobody_is_waited_for_who_has_spoken(scene: Scene):
    speaking = performed(scene, '<bml id="a"><speech id="s"><text>One two</text></speech></bml>', 0.0)
    talks = Talks()
    talks.take(Words("Here I am. ", 2, ends=True), 0.0)
    phrase = talks.next_phrase(speaking, speaking.speeches[0].end + 0.1)
    assert phrase is not None
    assert "a:s:end" not in phrase.bml


def test_a_block_that_waits_and_will_speak_is_let_first(scene: Scene):
    """Whoever speaks next is known already."""
    speaking = performed(scene, '<bml id="a"><head id="h" lexeme="NOD" repetition="9"/></bml>', 0.0)
    lurking = performed(
        speaking,
        '<bml id="b" composition="APPEND"><speech id="s"><text>One two</text></speech></bml>',
        0.1,
    )
    talks = Talks()
    talks.take(Words("Here I am. ", 2, ends=True), 0.0)
    assert talks.next_phrase(lurking, 0.5) is None
    assert talks.next_phrase(speaking, 0.5) is not None


def test_forgotten_words_are_not_said(scene: Scene):
    talks = Talks()
    talks.take(Words("Here I am. ", 2, ends=True), 0.0)
    talks.clear()
    assert talks.senders == frozenset()
    assert texts(talks, scene, 5.0) == []
    assert not isfinite(talks.next_time(scene))
