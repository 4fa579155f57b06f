"""Streamed texts without a server: times, alternating clients and replaced behaviours."""

from math import inf, isfinite

import pytest

from kinesic.intent.talk import MAX_SILENCE, SETTLING_TIME
from kinesic.planning.setup import Setup
from kinesic.realizer.realizer import Scene, begin, prepare_block
from kinesic.realizer.request import Message, read_request
from kinesic.serve.messages import Words
from kinesic.serve.queues import MAX_TEXT_LENGTH
from kinesic.serve.talks import PHRASE_PLANNING_TIME, Phrase, Talks


@pytest.fixture
def scene(known: Setup) -> Scene:
    return Scene.of(known)


def performed(scene: Scene, bml: str, now: float) -> Scene:
    request = read_request(Message(bml), scene.setup, context=scene.context(now))
    return begin(scene, prepare_block(request, scene.setup), now)


def texts(talks: Talks, scene: Scene, now: float) -> list[tuple[int, str]]:
    """Return all complete phrases, as if speech took no time."""
    results = []
    while (phrase := talks.next_phrase(scene, now)) is not None:
        results.append((phrase.sender, phrase.text))
    return results


def test_length_of_streamed_text_that_waits_is_limited():
    talks = Talks()
    assert talks.take(Words("x " * (MAX_TEXT_LENGTH // 2), 1), 0.0) == ""
    assert "characters already wait" in talks.take(Words("y", 1), 0.0)
    assert talks.take(Words("y", 2), 0.0) == "", "each client for itself"
    assert talks.senders == {1, 2}
    refused = Talks()
    assert refused.take(Words("x" * (MAX_TEXT_LENGTH + 1), 1), 0.0)
    assert refused.senders == frozenset()


def test_streamed_text_is_written_in_the_style_requested_with_its_words(scene: Scene):
    talks = Talks()
    assert talks.take(Words("Look at me. ", 1, ends=True, style="joyful"), 0.0) == ""
    assert "no style loud" in talks.take(Words("Look at me. ", 2, style="loud"), 0.0)
    phrase = talks.next_phrase(scene, 0.0)
    assert phrase is not None
    assert f'id="{phrase.block}" kinesic:style="joyful">' in phrase.bml


def test_streamed_words_may_be_utf_8_bytes(scene: Scene):
    talks = Talks()
    talks.take(Words("Voil\u00e0 all. ".encode(), 1, ends=True), 0.0)
    assert texts(talks, scene, 0.0) == [(1, "Voil\u00e0 all.")]


def test_no_phrase_is_planned_before_words_are_received(scene: Scene):
    talks = Talks()
    assert talks.next_time(scene) == inf
    assert talks.next_phrase(scene, 0.0) is None
    assert list(talks.finished(scene.setup)) == []


def test_incomplete_streamed_sentence_is_spoken_after_the_maximum_silence(scene: Scene):
    talks = Talks()
    talks.take(Words("I never saw", 1), 10.0)
    assert talks.next_time(scene) == pytest.approx(10.0 + SETTLING_TIME)
    assert talks.next_phrase(scene, 10.0 + SETTLING_TIME) is None
    assert talks.next_time(scene) == pytest.approx(10.0 + MAX_SILENCE)
    phrase = talks.next_phrase(scene, 10.0 + MAX_SILENCE)
    assert phrase is not None
    assert phrase.text == "I never saw"
    assert talks.next_time(scene) == inf, "more words are awaited"


def test_additional_streamed_words_restart_the_silence_timeout(scene: Scene):
    talks = Talks()
    talks.take(Words("I never", 1), 10.0)
    talks.take(Words(" saw", 1), 11.5)
    assert talks.next_phrase(scene, 12.5) is None
    assert talks.next_phrase(scene, 11.5 + MAX_SILENCE + 0.01) is not None


def test_clients_that_stream_words_take_turns_by_phrase(scene: Scene):
    talks = Talks()
    talks.take(Words("We saw the sea and the sky above it. We went home after that, very late. ", 1, ends=True), 0.0)
    talks.take(Words("Here I am. ", 2, ends=True), 0.0)
    said = texts(talks, scene, 5.0)
    assert [sender for sender, _ in said][:2] == [1, 2]
    assert {sender for sender, _ in said} == {1, 2}


def test_streamed_phrases_are_blocks_numbered_per_client_and_the_last_is_reported(scene: Scene):
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


def test_next_streamed_phrase_is_planned_only_shortly_before_the_running_speech_ends(scene: Scene):
    speaking = performed(
        scene,
        '<bml id="a"><speech id="s"><text>One two three four five six seven eight nine ten</text></speech></bml>',
        0.0,
    )
    (spoken,) = speaking.speeches
    talks = Talks()
    talks.take(Words("Here I am. ", 2, ends=True), 0.0)
    assert talks.next_phrase(speaking, 0.2) is None
    assert talks.next_time(speaking) <= spoken.end - PHRASE_PLANNING_TIME
    assert talks.next_phrase(speaking, spoken.end - PHRASE_PLANNING_TIME - 0.05) is None
    assert talks.next_time(speaking) == pytest.approx(spoken.end - PHRASE_PLANNING_TIME)
    phrase = talks.next_phrase(speaking, spoken.end - PHRASE_PLANNING_TIME + 0.05)
    assert phrase is not None
    assert 'start="a:s:end+' in phrase.bml.replace("'", '"')


def test_streamed_phrase_does_not_refer_to_a_speech_that_has_ended(scene: Scene):
    speaking = performed(scene, '<bml id="a"><speech id="s"><text>One two</text></speech></bml>', 0.0)
    talks = Talks()
    talks.take(Words("Here I am. ", 2, ends=True), 0.0)
    phrase = talks.next_phrase(speaking, speaking.speeches[0].end + 0.1)
    assert phrase is not None
    assert "a:s:end" not in phrase.bml


def test_streamed_phrase_waits_for_a_pending_block_with_speech(scene: Scene):
    """The pending block speaks next, so the phrase must wait for it."""
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


def test_streamed_phrase_removes_replaced_behaviours_that_have_not_begun(scene: Scene):
    nods = '<bml id="a"><head id="now" lexeme="NOD" start="0" end="2"/><head id="later" lexeme="NOD" start="4"/></bml>'
    nodding = performed(scene, nods, 0.0)
    both = frozenset({"now", "later", "unknown"})
    after, unchanged = (
        Phrase(1, "b", "", "", both, before=before).scene_change(nodding, 0.5).find("a") for before in ("a", "gone")
    )
    assert after is not None
    assert unchanged is not None
    assert set(after.times) == {"now"}
    assert set(unchanged.times) == {"now", "later"}


def test_cleared_streamed_words_are_not_spoken(scene: Scene):
    talks = Talks()
    talks.take(Words("Here I am. ", 2, ends=True), 0.0)
    talks.clear()
    assert talks.senders == frozenset()
    assert texts(talks, scene, 5.0) == []
    assert not isfinite(talks.next_time(scene))
