"""What holds for every text that the duration model says."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kinesic.body.utterance import Mark, Script
from kinesic.speech.durations import DurationModel

VOICE = DurationModel()
WORDS = st.lists(st.sampled_from(["one", "banana,", "the", "3.5", "naïve?", "你好。", "\n", "hmm;", "don't"])).map(
    " ".join
)
TEXTS = WORDS | st.text(max_size=80)


@st.composite
def scripts(draw: st.DrawFn) -> Script:
    text = draw(TEXTS)
    positions = sorted(draw(st.lists(st.integers(0, len(text)), max_size=8)))
    return Script(text, tuple(Mark(f"m{k}", position) for k, position in enumerate(positions)))


@given(scripts())
def test_marks_keep_their_order_and_stay_inside(script: Script):
    said = VOICE.say(script)
    times = [said.marks[mark.name] for mark in script.marks]
    assert times == sorted(times)
    assert all(0.0 <= time <= said.duration for time in times)


@given(scripts(), st.floats(0.1, 10.0))
def test_every_time_scales_with_the_inverse_of_the_rate(script: Script, rate: float):
    normal, said = VOICE.say(script), VOICE.say(script, rate=rate)
    assert said.duration * rate == pytest.approx(normal.duration)
    assert {name: time * rate for name, time in said.marks.items()} == pytest.approx(dict(normal.marks))
    assert [p.symbol for p in said.phonemes] == [p.symbol for p in normal.phonemes]


@given(scripts())
def test_phonemes_follow_one_another(script: Script):
    said = VOICE.say(script)
    ends = [0.0] + [phoneme.start + phoneme.duration for phoneme in said.phonemes]
    assert all(phoneme.duration > 0 for phoneme in said.phonemes)
    assert all(phoneme.start >= end - 1e-9 for phoneme, end in zip(said.phonemes, ends, strict=False))
    assert ends[-1] == pytest.approx(said.duration)


@given(scripts())
def test_saying_it_twice_gives_the_same(script: Script):
    assert VOICE.say(script) == VOICE.say(script)


@given(TEXTS, TEXTS)
def test_more_text_never_takes_less_time(text: str, more: str):
    assert VOICE.say(Script(f"{text} {more}")).duration >= VOICE.say(Script(text)).duration - 1e-9
