from pathlib import Path

import numpy as np
import pytest

from kinesic.bench.bml.speech import mark_errors
from kinesic.body.utterance import Emphasis, Mark, Pause, Script
from kinesic.speech import espeak as module
from kinesic.speech.espeak import Espeak, find_voice, list_voices
from kinesic.speech.espeak_pool import SpeechError, find_engine

MARK_PRECISION = 0.005  # [s] accepted error of mark times


def test_speech_marks_lie_at_audible_word_onsets(espeak: Espeak):
    errors = list(mark_errors(15))
    assert len(errors) == 30
    assert max(map(abs, errors)) <= MARK_PRECISION


def test_speech_marks_before_and_after_a_pause_enclose_the_silence(espeak: Espeak):
    script = Script("and one zero", (Mark("a", 8), Mark("b", 8)), pauses=(Pause(8, 0.5, after=1),))
    utterance = espeak.say(script)
    assert utterance.sound is not None
    begin, end = (round(utterance.marks[name] * utterance.sound.rate) for name in "ab")
    assert utterance.marks["b"] - utterance.marks["a"] == pytest.approx(0.5, abs=0.015)  # lips take 12 ms to open
    assert np.abs(utterance.sound.samples[begin + 10 : end - 10]).max() == 0.0
    assert np.abs(utterance.sound.samples[begin - 200 : begin]).max() > 0.0
    assert np.abs(utterance.sound.samples[end : end + 200]).max() > 0.0


@pytest.mark.parametrize("rate", [0.6, 1.0, 1.8])
def test_speech_pause_has_the_same_length_at_slow_normal_and_fast_rates(rate: float, espeak: Espeak):
    utterance = espeak.say(Script("one zero", (Mark("m", 4),), pauses=(Pause(4, 0.5),)), rate=rate)
    assert utterance.sound is not None
    before = np.abs(utterance.sound.samples[: round(utterance.marks["m"] * utterance.sound.rate)])
    silence = (len(before) - 1 - np.flatnonzero(before > 1e-3)[-1]) / utterance.sound.rate
    assert silence == pytest.approx(0.5, abs=0.03)


def test_synthesised_speech_ends_with_its_last_word_or_requested_pause(espeak: Espeak):
    plain, waiting = espeak.say(Script("one two.")), espeak.say(Script("one two.", pauses=(Pause(8, 0.4),)))
    assert plain.sound is not None
    assert plain.duration == pytest.approx(plain.sound.duration)
    assert np.abs(plain.sound.samples[-400:]).max() > 1e-3
    last = waiting.phonemes[-1]
    assert waiting.duration == pytest.approx(last.start + last.duration + 0.4)
    assert waiting.sound is not None
    assert len(waiting.sound.samples) == round(waiting.duration * waiting.sound.rate)


def test_higher_rate_shortens_espeak_speech_and_higher_pitch_factor_raises_its_pitch(espeak: Espeak):
    script = Script("My two hands can do large gestures")
    durations = [espeak.say(script, rate=rate).duration for rate in (0.7, 1.0, 1.4, 2.0)]
    assert durations == sorted(durations, reverse=True)
    assert durations[0] > 1.8 * durations[2]
    usual, higher = espeak.say(script), espeak.say(script, pitch=1.5)
    assert _pitch(higher) == pytest.approx(1.5 * _pitch(usual), rel=0.2)


def _pitch(utterance) -> float:
    """Return the fundamental frequency [Hz] (70 to 300), by autocorrelation."""
    samples, rate = utterance.sound.samples.astype(float), utterance.sound.rate
    correlation = np.fft.irfft(np.abs(np.fft.rfft(samples, 2 * len(samples))) ** 2)
    shortest, longest = round(rate / 300), round(rate / 70)
    return rate / (shortest + int(correlation[shortest:longest].argmax()))


def test_espeak_phonemes_are_ipa_symbols_that_fill_the_sound(espeak: Espeak):
    utterance = espeak.say(Script("Hello, my friend"))
    assert [phoneme.symbol for phoneme in utterance.phonemes][:4] == ["h", "ə", "l", "\u02c8oʊ"]
    assert all(phoneme.duration > 0 for phoneme in utterance.phonemes)
    ends = [phoneme.start + phoneme.duration for phoneme in utterance.phonemes]
    assert all(later.start >= end - 1e-9 for end, later in zip(ends, utterance.phonemes[1:], strict=False))
    assert ends[-1] == pytest.approx(utterance.duration)
    assert utterance.voice == "espeak-ng"


def test_prosody_rate_and_language_change_the_synthesised_speech(espeak: Espeak):
    plain = espeak.say(Script("one two three"))
    slow = espeak.say(Script("one two three", emphases=(Emphasis(0, 13, "prosody", (("rate", "50%"),)),)))
    assert slow.duration > 1.4 * plain.duration
    french = espeak.say(Script("bonjour", language="fr"))
    assert "ʒ" in [phoneme.symbol for phoneme in french.phonemes]
    inside = espeak.say(Script("one bonjour", emphases=(Emphasis(4, 11, "voice", (("xml:lang", "fr"),)),)))
    assert "ʒ" in [phoneme.symbol for phoneme in inside.phonemes]


def test_speech_in_an_unknown_language_has_a_remark(espeak: Espeak):
    utterance = espeak.say(Script("hello", language="tlh"))
    assert utterance.sound is not None
    assert "tlh" in utterance.remarks[0]


@pytest.mark.parametrize("text", ["", "   ", "...", "?!"])
def test_empty_speech_is_synthesised_with_duration_zero(text: str, espeak: Espeak):
    utterance = espeak.say(Script(text, (Mark("m", 0), Mark("n", len(text)))))
    assert (utterance.duration, utterance.marks, utterance.phonemes) == (0.0, {"m": 0.0, "n": 0.0}, ())


def test_sync_mark_before_a_comma_is_reached_at_the_end_of_its_word(espeak: Espeak):
    utterance = espeak.say(Script("one, two", (Mark("end", 3), Mark("two", 5))))
    word = espeak.say(Script("one"))
    assert utterance.marks["end"] == pytest.approx(word.duration, abs=0.1)
    assert utterance.marks["two"] > utterance.marks["end"] + 0.1


@pytest.mark.parametrize(
    "text",
    [
        "small ones. |You write",
        "small ones.| You",
        "Dr. |Smith",
        "one! |Two",
        "one... |Two",
        "1. |2 dogs",
        'A. |"B"',
        "É. |Été",
    ],
)
def test_speech_mark_after_a_full_stop_does_not_change_the_sound(text: str, espeak: Espeak):
    position, plain = text.index("|"), text.replace("|", "")
    utterance = espeak.say(Script(plain, (Mark("m", position),)))
    assert utterance.remarks == ()
    assert utterance.duration == pytest.approx(espeak.say(Script(plain)).duration, abs=0.005)
    assert utterance.marks["m"] > 0.1


def test_prosody_after_a_full_stop_is_audible(espeak: Espeak):
    text = "One. You go there"
    slow = Script(text, emphases=(Emphasis(5, len(text), "prosody", (("rate", "50%"),)),))
    assert espeak.say(slow).duration > 1.3 * espeak.say(Script(text)).duration


def test_speech_mark_times_are_ordered_within_the_utterance(espeak: Espeak):
    text = "a b, c. D (exactly) 12 % & <e> fish—chips; don't 'go' now"
    marks = tuple(Mark(f"m{k}", k) for k in range(len(text) + 1))
    utterance = espeak.say(Script(text, marks))
    times = [utterance.marks[mark.name] for mark in marks]
    assert times == sorted(times)
    assert 0.0 <= times[0] <= times[-1] <= utterance.duration


@pytest.mark.parametrize("kind", ["rate", "pitch"])
@pytest.mark.parametrize("value", [0.0, -1.0, float("nan"), float("inf")])
def test_speech_rate_or_pitch_outside_its_range_is_rejected_by_espeak(kind: str, value: float):
    with pytest.raises(ValueError, match=f"{kind} is"):
        Espeak().say(Script("one"), **{kind: value})


def test_failed_speech_synthesis_gives_estimated_times_with_a_remark(espeak: Espeak, monkeypatch: pytest.MonkeyPatch):
    def fails(*_: object, **__: object) -> None:
        raise SpeechError("it broke")

    monkeypatch.setattr(module, "synthesise", fails)
    utterance = espeak.say(Script("a text of no other test"))
    assert (utterance.voice, utterance.sound) == ("durations", None)
    assert utterance.duration > 1.0
    assert "it broke" in utterance.remarks[0]


def test_very_long_text_is_not_synthesised(espeak: Espeak):
    utterance = espeak.say(Script("on and " * 20_000))
    assert (utterance.voice, utterance.sound) == ("durations", None)
    assert "140000 characters" in utterance.remarks[0]


@pytest.fixture(scope="module")
def data() -> Path:
    paths = find_engine()
    if paths is None:
        pytest.skip("espeak-ng is not installed")
    return paths.data


@pytest.mark.parametrize(
    ("tag", "voice"),
    [
        ("en", "en-US"),
        ("EN_gb", "en"),
        ("fr", "fr"),
        ("de-AT", "de"),
        ("pt-br", "pt-BR"),
        ("zh-Hans-CN", "cmn"),
        ("no", "nb"),
    ],
)
def test_language_tag_selects_its_voice_despite_case_separator_and_region(tag: str, voice: str, data: Path):
    spoken_by, remark = find_voice(tag, data)
    assert spoken_by.rpartition("/")[2] == voice
    assert remark == ""


@pytest.mark.parametrize("tag", ["tlh", "", "klingon", "-"])
def test_unsupported_language_is_read_as_english_with_a_remark(tag: str, data: Path):
    spoken_by, remark = find_voice(tag, data)
    assert spoken_by == list_voices(data)["en-us"]
    assert repr(tag) in remark
