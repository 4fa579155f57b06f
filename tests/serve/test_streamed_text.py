"""Tests of streamed text that is read shortly before it is spoken."""

from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.expressivity.style.style import Style
from kinesic.intent.behaviour_sets import builtin_sets
from kinesic.intent.reading.language import load_language
from kinesic.intent.talk import Talk, next_part
from kinesic.serve.streamed_text import MAX_PARSED_AHEAD, PIECE_LENGTH, StreamedText

SENTENCE = "We never saw the old house on the hill. "


def speak_all(speech):
    """Return all phrases of a text, and the longest read text."""
    lexicon, style, language, sets = Lexicon.load(), Style.load("calm"), load_language(), builtin_sets()
    phrases, longest = [], 0
    while (part := next_part(speech.talk, lexicon, style, language, sets, quiet=speech.quiet(99.0))) is not None:
        phrases.append(part.text)
        speech.talk = part.talk
        speech.read_ahead()
        longest = max(longest, speech.talk.length)
    return phrases, longest


def test_long_streamed_text_is_read_only_shortly_before_it_is_spoken():
    speech = StreamedText(Talk(), 0.0)
    speech.take(SENTENCE * 120, 0.0, ends=False, instead=False)
    assert MAX_PARSED_AHEAD <= speech.talk.length < MAX_PARSED_AHEAD + PIECE_LENGTH
    assert speech.waiting == 120 * len(SENTENCE)
    assert speech.quiet(99.0) == 0.0
    assert not speech.is_read
    speech.take("The end", 0.0, ends=True, instead=False)
    phrases, longest = speak_all(speech)
    assert " ".join(phrases).split() == (SENTENCE * 120 + "The end").replace(".", "").split()
    assert longest < MAX_PARSED_AHEAD + 2 * PIECE_LENGTH
    assert speech.is_read
    assert speech.quiet(99.0) == 99.0
    assert speech.talk.is_over


def test_replacing_a_streamed_text_drops_its_unread_pieces():
    speech = StreamedText(Talk(), 0.0)
    speech.take(SENTENCE * 120, 0.0, ends=True, instead=False)
    speech.take("Or not. ", 1.0, ends=True, instead=True)
    assert speak_all(speech)[0] == ["Or not"]
    assert speech.is_read


def test_text_streamed_after_a_finished_one_begins_a_new_sentence_on_the_server():
    speech = StreamedText(Talk(), 0.0)
    speech.take("We met. " * (MAX_PARSED_AHEAD // 8 + 1) + "We are here", 0.0, ends=True, instead=False)
    speech.take("you are there", 0.0, ends=True, instead=False)
    assert not speech.is_read
    speech.talk = Talk()
    speech.read_ahead()
    assert speech.talk.text.endswith("We are here. you are there")
