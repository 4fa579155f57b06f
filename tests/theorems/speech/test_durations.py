"""Properties of every text spoken by the duration model."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kinesic.body.utterance import Mark, Script
from kinesic.speech.durations import DurationModel

DURATION_MODEL = DurationModel()
WORD_TEXTS = st.lists(st.sampled_from(["one", "banana,", "the", "3.5", "naïve?", "你好。", "\n", "hmm;", "don't"])).map(
    " ".join
)
SAMPLE_TEXTS = WORD_TEXTS | st.text(max_size=80)


@st.composite
def scripts(draw: st.DrawFn) -> Script:
    text = draw(SAMPLE_TEXTS)
    positions = sorted(draw(st.lists(st.integers(0, len(text)), max_size=8)))
    return Script(text, tuple(Mark(f"m{k}", position) for k, position in enumerate(positions)))


@given(scripts())
def test_estimated_speech_marks_are_ordered_and_within_the_speech(script: Script):
    said = DURATION_MODEL.say(script)
    times = [said.marks[mark.name] for mark in script.marks]
    assert times == sorted(times)
    assert all(0.0 <= time <= said.duration for time in times)


@given(scripts(), st.floats(0.1, 10.0))
def test_speech_times_are_inversely_proportional_to_the_rate(script: Script, rate: float):
    normal, said = DURATION_MODEL.say(script), DURATION_MODEL.say(script, rate=rate)
    assert said.duration * rate == pytest.approx(normal.duration)
    assert {name: time * rate for name, time in said.marks.items()} == pytest.approx(dict(normal.marks))
    assert [p.symbol for p in said.phonemes] == [p.symbol for p in normal.phonemes]


@given(scripts())
def test_estimated_phonemes_do_not_overlap(script: Script):
    said = DURATION_MODEL.say(script)
    ends = [0.0] + [phoneme.start + phoneme.duration for phoneme in said.phonemes]
    assert all(phoneme.duration > 0 for phoneme in said.phonemes)
    assert all(phoneme.start >= end - 1e-9 for phoneme, end in zip(said.phonemes, ends, strict=False))
    assert ends[-1] == pytest.approx(said.duration)


@given(scripts())
def test_speech_durations_are_deterministic(script: Script):
    assert DURATION_MODEL.say(script) == DURATION_MODEL.say(script)


@given(SAMPLE_TEXTS, SAMPLE_TEXTS)
def test_speech_duration_never_shrinks_with_appended_text(text: str, more: str):
    assert DURATION_MODEL.say(Script(f"{text} {more}")).duration >= DURATION_MODEL.say(Script(text)).duration - 1e-9
