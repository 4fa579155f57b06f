import numpy as np
import pytest

from kinesic.body.utterance import Mark, Pause, Script
from kinesic.speech.durations import DurationModel
from kinesic.speech.espeak import Espeak
from kinesic.speech.recorded.rendition import render


def test_rendition_of_a_script_gives_word_and_mark_times_without_the_requested_pauses():
    script = Script("Hello, my dear friend.", (Mark("a", 7), Mark("b", 22)), pauses=(Pause(10, 3.0),))
    rendition = render(script, DurationModel())
    assert rendition.words == ("Hello", "my", "dear", "friend")
    assert np.all(np.diff(rendition.starts) > 0.0)
    assert np.all(rendition.ends > rendition.starts)
    assert rendition.marked_words == {"a": 1}
    assert set(rendition.utterance.marks) == {"a", "b"}
    assert rendition.utterance.duration < 3.0  # the script's pause is left out


def test_words_that_the_engine_reports_together_have_different_times(espeak: Espeak):
    rendition = render(Script("It is of the king to be in it."), espeak)
    assert np.all(np.diff(rendition.starts) >= 0.01 - 1e-9)
    assert rendition.ends[-1] == pytest.approx(rendition.utterance.duration, abs=0.05)


def test_rendition_of_a_text_without_words_has_no_words():
    rendition = render(Script("...", (Mark("a", 0),)), DurationModel())
    assert (rendition.words, len(rendition.starts), rendition.marked_words) == ((), 0, {})
