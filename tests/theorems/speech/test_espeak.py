"""Properties of every script spoken by eSpeak NG."""

from xml.etree.ElementTree import fromstring

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from kinesic.body.utterance import Emphasis, Mark, Pause, Script
from kinesic.speech.espeak import Espeak
from kinesic.speech.espeak_pool import espeak_fault
from kinesic.speech.ssml import write_ssml

FEW_EXAMPLES = settings(max_examples=25, deadline=None, suppress_health_check=[HealthCheck.too_slow])
WORD_TEXTS = st.lists(
    st.sampled_from(["one", "Banana,", "the.", "3.5", "naïve?", "(Hmm)", "don't", "Dr.", "—", "&", "<b>"])
).map(" ".join)
SAMPLE_TEXTS = WORD_TEXTS | st.text(max_size=60)


@pytest.fixture(scope="module", autouse=True)
def _engine():
    if why := espeak_fault():
        pytest.skip(why)


@st.composite
def scripts(draw: st.DrawFn, texts: st.SearchStrategy[str] = SAMPLE_TEXTS) -> Script:
    text = draw(texts)
    places = st.integers(0, len(text))
    positions = sorted(draw(st.lists(places, max_size=6)))
    pauses = draw(st.lists(st.builds(Pause, places, st.sampled_from([0.05, 0.2]), st.integers(0, 2)), max_size=3))
    spans = draw(st.lists(st.tuples(places, places), max_size=3))
    emphases = tuple(Emphasis(min(span), max(span), "prosody", (("pitch", "high"),)) for span in spans)
    marks = tuple(Mark(f"m{k}", position) for k, position in enumerate(positions))
    return Script(text, marks, pauses=tuple(pauses), emphases=emphases)


@given(scripts())
def test_ssml_for_espeak_is_well_formed_and_keeps_the_words_of_the_script(script: Script):
    written = "".join(fromstring(write_ssml(script)).itertext())
    kept = "".join(character for character in script.text if character.isalnum())
    assert "".join(character for character in written if character.isalnum()) == kept


@FEW_EXAMPLES
@given(scripts())
def test_espeak_marks_and_phonemes_are_ordered_and_within_the_speech(script: Script):
    said = Espeak().say(script)
    times = [said.marks[stop.name] for stop in script.stops() if isinstance(stop, Mark)]
    assert times == sorted(times)
    assert all(0.0 <= time <= said.duration for time in times)
    ends = [0.0, *(phoneme.start + phoneme.duration for phoneme in said.phonemes)]
    assert all(phoneme.duration >= 0.0 for phoneme in said.phonemes)
    assert all(phoneme.start >= end - 1e-9 for phoneme, end in zip(said.phonemes, ends, strict=False))
    assert ends[-1] <= said.duration + 1e-9
    if said.sound is None:
        assert any(remark.startswith("no sound: ") for remark in said.remarks)
    else:
        assert said.sound.duration == pytest.approx(said.duration)
