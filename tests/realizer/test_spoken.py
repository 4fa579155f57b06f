"""Division of a speech into spoken and unspoken words."""

import pytest

from kinesic.body.utterance import Mark, Phoneme, Script, Utterance
from kinesic.realizer.scene import Scene
from kinesic.realizer.spoken import divide_speeches, divide_text
from kinesic.speech.voice import voice

from .small_blocks import small_block

TEXT = "one two three four"


def phonemes(*spans):
    return tuple(Phoneme("a", start, duration) for start, duration in spans)


@pytest.mark.parametrize(
    ("elapsed", "said"), [(-1.0, ""), (0.1, ""), (0.4, "one"), (1.0, "one two"), (1.6, "one two three"), (2.1, TEXT)]
)
def test_words_of_a_speech_without_phonemes_are_timed_by_their_letters(elapsed, said):
    result = divide_text(Script(TEXT), Utterance(2.0), elapsed)
    assert result.said == said
    assert f"{result.said} {result.unsaid}".split() == TEXT.split()


def test_marks_of_a_speech_determine_the_times_of_words():
    script = Script(TEXT, (Mark("m", TEXT.index("three")),))
    utterance = Utterance(10.0, {"m": 8.0})
    assert divide_text(script, utterance, 7.0).said == "one two"
    assert divide_text(script, utterance, 8.1).unsaid == "three four"


def test_words_after_a_pause_are_not_spoken_during_the_pause():
    utterance = Utterance(
        4.0, phonemes=(*phonemes((0.0, 0.3), (0.3, 0.3)), Phoneme("_", 0.6, 2.8), *phonemes((3.4, 0.6)))
    )
    for elapsed in (0.8, 2.0, 3.3):
        assert divide_text(Script("go on  right now"), utterance, elapsed).said.split()[:2] == ["go", "on"]
        assert "now" in divide_text(Script("go on  right now"), utterance, elapsed).unsaid


def test_estimated_spoken_words_are_within_one_word_of_the_marks_of_the_voice():
    """Compare estimated words with a voice's marks before each word.

    The estimate does not use the marks.
    """
    text = "My sister bought a new car last week, and it is bright red and very fast."
    starts = [index for index in range(len(text)) if index == 0 or text[index - 1] == " "]
    marked = voice("espeak").say(Script(text, tuple(Mark(f"w{k}", start) for k, start in enumerate(starts))))
    errors = [
        len(divide_text(Script(text), marked, marked.marks[f"w{k}"]).said.split()) - k for k in range(len(starts))
    ]
    assert max(map(abs, errors)) <= 1


def test_text_of_each_speaking_block_is_divided_into_spoken_and_unspoken_words_at_one_time(known):
    inside = '<speech id="s"><text>one two three four</text></speech>'
    spoken = {"utterances": {"s": Utterance(2.0)}, "inside": inside}
    scene = Scene.of(known).with_block(small_block("a", {"s": {"start": 0.5, "end": 2.5}}, zero=10.0, **spoken))
    scene = scene.with_block(small_block("b", {"h": {"start": 0.0}}, inside='<head id="h" lexeme="NOD"/>'))
    texts = divide_speeches(scene, 11.5)
    assert {id: (text.said, text.unsaid) for id, text in texts.items()} == {
        "a": ("one two", "three four"),
        "b": ("", ""),
    }
    assert divide_speeches(scene, 11.5, "b").keys() == {"b"}
