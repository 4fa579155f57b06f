import numpy as np
import pytest

from kinesic.bench.bml import speech
from kinesic.body.utterance import Sound
from kinesic.session.plan import plan
from kinesic.session.setup import set_up
from kinesic.speech.espeak_pool import espeak_fault


@pytest.fixture(scope="module", autouse=True)
def _engine() -> None:
    if espeak_fault():
        pytest.skip(espeak_fault())


def test_audible_word_onsets_are_found_only_after_long_silences():
    samples = np.zeros(1000)
    samples[100:300], samples[320:400], samples[700:800] = 0.5, 0.5, -0.5
    assert speech.find_onsets(Sound.of(1000, samples)) == [0.7]  # pauses of 20 ms do not count as silence


def test_strokes_are_within_30_ms_of_audible_words():
    errors = list(speech.heard_stroke_errors(3))
    assert len(errors) >= 4
    assert max(map(abs, errors)) <= 0.030


def test_stroke_is_within_30_ms_of_a_word_delayed_by_a_pause():
    """Check a stroke that needs a pause before its word.

    The pause is long enough to be found in the sound.
    """
    text = (
        '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b" kinesic:pause="true">'
        '<speech id="s"><text>Now we look <sync id="zero"/>at <sync id="one"/>apples here</text></speech>'
        '<gesture id="right" lexeme="large" mode="RIGHT_HAND" start="s:zero" stroke="s:one"/></bml>'
    )
    setup = set_up(voice="espeak")
    assert any("a pause of" in notice.text for notice in plan(text, setup).notices)
    (error,) = speech.block_stroke_errors(text, setup)
    assert abs(error) <= 0.030


def test_stroke_error_metric_detects_a_delayed_voice(monkeypatch: pytest.MonkeyPatch):
    """Check that word times are measured in the sound."""
    original_sound = speech.sound

    def delayed_sound(planned):
        audio = original_sound(planned)
        return Sound.of(audio.rate, np.concatenate([np.zeros(audio.rate // 10), audio.samples]))

    monkeypatch.setattr(speech, "sound", delayed_sound)
    errors = list(speech.heard_stroke_errors(1))
    assert errors == pytest.approx([-0.1] * len(errors), abs=0.03)


def test_speech_mark_and_stroke_errors_meet_their_benchmark_goals():
    metrics = speech.bench(sentences=2, blocks=1)
    assert {metric.name for metric in metrics} >= {"bml.speech.mark_error_max", "bml.speech.stroke_error_max"}
    assert all(metric.ok for metric in metrics if "error" in metric.name)
