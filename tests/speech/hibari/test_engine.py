import socket

import numpy as np
import pytest

from kinesic.bench.bml.speech import find_onsets
from kinesic.bench.face.lips import loudness_steps
from kinesic.body.utterance import Emphasis, Mark, Pause, Script
from kinesic.speech.engines.engine_voice import EngineVoice, speak_phrase
from kinesic.speech.engines.phrase import Phrase
from kinesic.speech.hibari.engine import Hibari

# sentences that were not used to fit the constants
TEST_SENTENCES = (
    "Tomorrow morning my family may come by boat.",
    "Pretty blue umbrellas bob up and down in May.",
    "Please remember to bring the blanket and a bottle of apple juice.",
)
BILABIAL_LETTERS = ("p", "b", "m")  # sounds with closed lips
OPEN_SOUNDS = "aeiouæɐɑɒɔəɚɛɜɪʊʌlɹwj"  # noqa: RUF001 - phonetic letters


def test_neural_voice_speaks_a_phrase_without_the_network(neural: EngineVoice, monkeypatch: pytest.MonkeyPatch):
    def refuse(*_: object, **__: object) -> None:
        raise AssertionError("a network was used")

    monkeypatch.setattr(socket, "socket", refuse)
    monkeypatch.setattr(socket, "create_connection", refuse)
    utterance = neural.say(Script("A sentence of no other test, with Zyxwvu in it."))
    assert utterance.voice == "hibari"
    assert utterance.sound is not None
    assert utterance.sound.duration == utterance.duration > 2.0


def test_neural_voice_gives_the_same_samples_for_the_same_phrase(neural: EngineVoice):
    first = Hibari().speak(Phrase("Hello, my friend."))
    second = Hibari().speak(Phrase("Hello, my friend."))
    assert np.array_equal(first.sound.samples, second.sound.samples)
    assert first.phonemes == second.phonemes


@pytest.mark.parametrize("rate", [0.8, 1.25])
def test_lips_close_before_and_open_at_the_audible_burst_of_each_bilabial(neural: EngineVoice, rate: float):
    for sentence in TEST_SENTENCES:
        utterance = neural.say(Script(sentence), rate=rate)
        assert utterance.sound is not None
        times, steps = loudness_steps(utterance.sound)
        following = (*utterance.phonemes[1:], utterance.phonemes[-1])
        for sound, after in zip(utterance.phonemes, following, strict=True):
            if sound.letters[:1] not in BILABIAL_LETTERS or after.letters[:1] not in OPEN_SOUNDS or sound.start < 0.05:
                continue
            onset, release = sound.articulation
            is_near = (times > onset + 0.02) & (times < release + 0.03)
            burst = float(times[is_near][steps[is_near].argmax()])
            assert onset < burst - 0.015
            assert release == pytest.approx(burst, abs=0.035), (sentence, sound)


def test_mark_of_a_word_after_a_pause_lies_at_the_onset_of_its_sound(neural: EngineVoice):
    text = "apple see table green people"
    positions = [text.index(word) for word in ("see", "green", "people")]
    marks, pauses = (tuple(kind) for kind in ([Mark(str(p), p) for p in positions], [Pause(p, 0.3) for p in positions]))
    utterance = neural.say(Script(text, marks, pauses=pauses))
    assert utterance.sound is not None
    assert [utterance.marks[str(p)] for p in positions] == pytest.approx(find_onsets(utterance.sound), abs=0.005)


def test_prosody_rate_changes_the_duration_of_its_own_words_only(neural: EngineVoice):
    text = "one two three four five six"
    plain = neural.say(Script(text))
    section = Emphasis(14, 18, "prosody", (("rate", "50%"),))
    slow = neural.say(Script(text, (Mark("a", 14), Mark("b", 19)), emphases=(section,)))
    marked = neural.say(Script(text, (Mark("a", 14), Mark("b", 19))))
    assert slow.marks["a"] == pytest.approx(marked.marks["a"], abs=0.05)
    extension = (slow.marks["b"] - slow.marks["a"]) / (marked.marks["b"] - marked.marks["a"])
    assert 1.6 < extension < 2.4
    assert slow.duration - plain.duration == pytest.approx(
        (slow.marks["b"] - slow.marks["a"]) - (marked.marks["b"] - marked.marks["a"]), abs=0.06
    )


def test_prosody_pitch_and_volume_scale_the_pitch_and_amplitude_of_the_sound(neural: EngineVoice):
    text = "one two three four five six"
    phrase = Phrase(text)
    plain = speak_phrase(Hibari(), phrase)
    high = neural.say(Script(text, emphases=(Emphasis(0, 27, "prosody", (("pitch", "+25%"),)),)))
    loud = neural.say(Script(text, emphases=(Emphasis(0, 27, "prosody", (("volume", "soft"),)),)))
    assert high.sound is not None
    assert loud.sound is not None
    assert _pitch(high.sound.samples) == pytest.approx(1.25 * _pitch(plain.sound.samples), rel=0.06)
    assert np.abs(loud.sound.samples).max() == pytest.approx(0.5 * np.abs(plain.sound.samples).max(), rel=0.05)
    assert high.duration == pytest.approx(plain.sound.duration, abs=0.03)


def _pitch(samples: np.ndarray) -> float:
    """Return the mean pitch [Hz] of loud windows, searched in 120..400 Hz."""
    size, pitches = 1200, []
    for begin in range(0, len(samples) - size, size):
        window = samples[begin : begin + size].astype(float)
        correlation = np.correlate(window, window, "full")[size - 1 :]
        lag = 60 + int(correlation[60:200].argmax())
        if correlation[lag] > 0.6 * correlation[0] > 0.0 and np.abs(window).max() > 0.05:
            pitches.append(24000 / lag)
    return float(np.median(pitches))


def test_accents_of_a_sentence_lie_near_stressed_vowels(neural: EngineVoice):
    utterance = neural.say(Script("I never said that, but MAYBE you did."))
    stressed = [phoneme for phoneme in utterance.phonemes if phoneme.symbol.startswith("\u02c8")]
    assert 1 <= len(utterance.accents) <= len(stressed)
    for accent in utterance.accents:
        assert any(vowel.start - 0.07 < accent < vowel.end + 0.11 for vowel in stressed)


def test_neural_voice_omits_unreadable_letters_with_a_remark(neural: EngineVoice):
    utterance = neural.say(Script("one Я two"))
    assert utterance.voice == "hibari"
    assert "Я" in utterance.remarks[0]
