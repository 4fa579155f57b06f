import numpy as np
import pytest

from kinesic.bench.bml import speech
from kinesic.body.utterance import Sound
from kinesic.controller.perform import plan, set_up
from kinesic.speech.espeak_pool import espeak_fault


@pytest.fixture(scope="module", autouse=True)
def _engine() -> None:
    if espeak_fault():
        pytest.skip(espeak_fault())


def test_silence_ends_where_sound_begins():
    samples = np.zeros(1000)
    samples[100:300], samples[320:400], samples[700:800] = 0.5, 0.5, -0.5
    assert speech.onsets(Sound.of(1000, samples)) == [0.7]  # nobody is silent for 20 ms


def test_strokes_meet_the_words_that_are_heard_on_the_pessimistic_twin():
    errors = list(speech.heard_stroke_errors(3))
    assert len(errors) >= 4
    assert max(map(abs, errors)) <= 0.030


def test_a_word_that_waits_is_met_as_well():
    """Without a pause its stroke would be late; the pause is long enough to be seen in the sound."""
    text = (
        '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b" kinesic:pause="true">'
        '<speech id="s"><text>Now we look <sync id="zero"/>at <sync id="one"/>apples here</text></speech>'
        '<gesture id="right" lexeme="large" mode="RIGHT_HAND" start="s:zero" stroke="s:one"/></bml>'
    )
    known = set_up(voice="espeak")
    assert any("a pause of" in notice.text for notice in plan(text, known).notices)
    (error,) = speech.performed_errors(text, known)
    assert abs(error) <= 0.030


def test_a_voice_that_is_late_is_found_out(monkeypatch: pytest.MonkeyPatch):
    """The measurement does not take the times of the plan for those of the sound."""
    late = speech.sound

    def later(planned):
        heard = late(planned)
        return Sound.of(heard.rate, np.concatenate([np.zeros(heard.rate // 10), heard.samples]))

    monkeypatch.setattr(speech, "sound", later)
    errors = list(speech.heard_stroke_errors(1))
    assert errors == pytest.approx([-0.1] * len(errors), abs=0.03)


def test_every_figure_has_its_goal():
    figures = speech.bench(sentences=4, blocks=1)
    assert {figure.name for figure in figures} >= {"bml.speech.mark_error_max", "bml.speech.stroke_error_max"}
    assert all(figure.ok for figure in figures if "error" in figure.name)
