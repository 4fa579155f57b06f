from pathlib import Path

import numpy as np
import pytest

from kinesic.bench.bml.speech import mark_errors
from kinesic.body.utterance import Emphasis, Mark, Pause, Script
from kinesic.speech import espeak as module
from kinesic.speech.espeak import Espeak, voice_of, voices
from kinesic.speech.espeak_pool import SpeechError, engine

PRECISION = 0.005  # [s]


def test_marks_lie_where_silence_ends_in_the_recorded_sound(espeak: Espeak):
    errors = list(mark_errors(15))
    assert len(errors) == 30
    assert max(map(abs, errors)) <= PRECISION


def test_marks_on_both_sides_of_a_pause_enclose_it(espeak: Espeak):
    script = Script("and one zero", (Mark("a", 8), Mark("b", 8)), pauses=(Pause(8, 0.5, after=1),))
    said = espeak.say(script)
    assert said.sound is not None
    begin, end = (round(said.marks[name] * said.sound.rate) for name in "ab")
    assert said.marks["b"] - said.marks["a"] == pytest.approx(0.5, abs=0.015)  # lips take 12 ms to begin
    assert np.abs(said.sound.samples[begin + 10 : end - 10]).max() == 0.0
    assert np.abs(said.sound.samples[begin - 200 : begin]).max() > 0.0
    assert np.abs(said.sound.samples[end : end + 200]).max() > 0.0


@pytest.mark.parametrize("rate", [0.6, 1.0, 1.8])
def test_a_pause_lasts_as_long_at_every_rate(rate: float, espeak: Espeak):
    said = espeak.say(Script("one zero", (Mark("m", 4),), pauses=(Pause(4, 0.5),)), rate=rate)
    assert said.sound is not None
    before = np.abs(said.sound.samples[: round(said.marks["m"] * said.sound.rate)])
    silence = (len(before) - 1 - np.flatnonzero(before > 1e-3)[-1]) / said.sound.rate
    assert silence == pytest.approx(0.5, abs=0.03)


def test_nothing_is_silent_after_the_last_word_but_a_pause(espeak: Espeak):
    plain, waiting = espeak.say(Script("one two.")), espeak.say(Script("one two.", pauses=(Pause(8, 0.4),)))
    assert plain.sound is not None
    assert plain.duration == pytest.approx(plain.sound.duration)
    assert np.abs(plain.sound.samples[-400:]).max() > 1e-3
    last = waiting.phonemes[-1]
    assert waiting.duration == pytest.approx(last.start + last.duration + 0.4)
    assert waiting.sound is not None
    assert len(waiting.sound.samples) == round(waiting.duration * waiting.sound.rate)


def test_faster_is_shorter_and_higher_sounds_otherwise(espeak: Espeak):
    script = Script("My two hands can do large gestures")
    durations = [espeak.say(script, rate=rate).duration for rate in (0.7, 1.0, 1.4, 2.0)]
    assert durations == sorted(durations, reverse=True)
    assert durations[0] > 1.8 * durations[2]
    usual, higher = espeak.say(script), espeak.say(script, pitch=1.5)
    assert _pitch(higher) == pytest.approx(1.5 * _pitch(usual), rel=0.2)


def _pitch(said) -> float:
    """[Hz] at which a sound is most like itself, 70 to 300."""
    samples, rate = said.sound.samples.astype(float), said.sound.rate
    likeness = np.fft.irfft(np.abs(np.fft.rfft(samples, 2 * len(samples))) ** 2)
    least, most = round(rate / 300), round(rate / 70)
    return rate / (least + int(likeness[least:most].argmax()))


def test_phonemes_are_of_the_phonetic_alphabet_and_fill_what_is_heard(espeak: Espeak):
    said = espeak.say(Script("Hello, my friend"))
    assert [phoneme.symbol for phoneme in said.phonemes][:4] == ["h", "ə", "l", "\u02c8oʊ"]
    assert all(phoneme.duration > 0 for phoneme in said.phonemes)
    ends = [phoneme.start + phoneme.duration for phoneme in said.phonemes]
    assert all(later.start >= end - 1e-9 for end, later in zip(ends, said.phonemes[1:], strict=False))
    assert ends[-1] == pytest.approx(said.duration)
    assert said.voice == "espeak-ng"


def test_prosody_and_languages_reach_the_engine(espeak: Espeak):
    plain = espeak.say(Script("one two three"))
    slow = espeak.say(Script("one two three", emphases=(Emphasis(0, 13, "prosody", (("rate", "50%"),)),)))
    assert slow.duration > 1.4 * plain.duration
    french = espeak.say(Script("bonjour", language="fr"))
    assert "ʒ" in [phoneme.symbol for phoneme in french.phonemes]
    inside = espeak.say(Script("one bonjour", emphases=(Emphasis(4, 11, "voice", (("xml:lang", "fr"),)),)))
    assert "ʒ" in [phoneme.symbol for phoneme in inside.phonemes]


def test_an_unknown_language_is_remarked(espeak: Espeak):
    said = espeak.say(Script("hello", language="tlh"))
    assert said.sound is not None
    assert "tlh" in said.remarks[0]


@pytest.mark.parametrize("text", ["", "   ", "...", "?!"])
def test_nothing_to_say_takes_no_time(text: str, espeak: Espeak):
    said = espeak.say(Script(text, (Mark("m", 0), Mark("n", len(text)))))
    assert (said.duration, said.marks, said.phonemes) == (0.0, {"m": 0.0, "n": 0.0}, ())


def test_a_mark_before_a_comma_stays_at_the_end_of_its_word(espeak: Espeak):
    said = espeak.say(Script("one, two", (Mark("end", 3), Mark("two", 5))))
    word = espeak.say(Script("one"))
    assert said.marks["end"] == pytest.approx(word.duration, abs=0.1)
    assert said.marks["two"] > said.marks["end"] + 0.1


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
def test_a_mark_after_a_full_stop_is_told_and_changes_nothing(text: str, espeak: Espeak):
    place, plain = text.index("|"), text.replace("|", "")
    said = espeak.say(Script(plain, (Mark("m", place),)))
    assert said.remarks == ()
    assert said.duration == pytest.approx(espeak.say(Script(plain)).duration, abs=0.005)
    assert said.marks["m"] > 0.1


def test_prosody_after_a_full_stop_is_heard(espeak: Espeak):
    text = "One. You go there"
    slow = Script(text, emphases=(Emphasis(5, len(text), "prosody", (("rate", "50%"),)),))
    assert espeak.say(slow).duration > 1.3 * espeak.say(Script(text)).duration


def test_every_mark_has_a_time_inside_in_order(espeak: Espeak):
    text = "a b, c. D (exactly) 12 % & <e> fish—chips; don't 'go' now"
    marks = tuple(Mark(f"m{k}", k) for k in range(len(text) + 1))
    said = espeak.say(Script(text, marks))
    times = [said.marks[mark.name] for mark in marks]
    assert times == sorted(times)
    assert 0.0 <= times[0] <= times[-1] <= said.duration


@pytest.mark.parametrize("kind", ["rate", "pitch"])
@pytest.mark.parametrize("value", [0.0, -1.0, float("nan"), float("inf")])
def test_a_number_that_is_none_is_refused(kind: str, value: float):
    with pytest.raises(ValueError, match=f"{kind} is"):
        Espeak().say(Script("one"), **{kind: value})


def test_an_engine_that_fails_leaves_the_times_and_says_so(espeak: Espeak, monkeypatch: pytest.MonkeyPatch):
    def fails(*_: object, **__: object) -> None:
        raise SpeechError("it broke")

    monkeypatch.setattr(module, "synthesise", fails)
    said = espeak.say(Script("never said before, in no other test"))
    assert (said.voice, said.sound) == ("durations", None)
    assert said.duration > 1.0
    assert "it broke" in said.remarks[0]


def test_a_text_without_end_is_not_waited_for(espeak: Espeak):
    said = espeak.say(Script("on and " * 20_000))
    assert (said.voice, said.sound) == ("durations", None)
    assert "140000 characters" in said.remarks[0]


@pytest.fixture(scope="module")
def data() -> Path:
    place = engine()
    if place is None:
        pytest.skip("espeak-ng is not installed")
    return place.data


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
def test_a_tag_finds_its_voice_in_any_spelling(tag: str, voice: str, data: Path):
    found, remark = voice_of(tag, data)
    assert found.rpartition("/")[2] == voice
    assert remark == ""


@pytest.mark.parametrize("tag", ["tlh", "", "klingon", "-"])
def test_a_language_that_nobody_speaks_is_read_as_english_and_says_so(tag: str, data: Path):
    found, remark = voice_of(tag, data)
    assert found == voices(data)["en-us"]
    assert repr(tag) in remark
