from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from kinesic.body.action_units import CHANNELS
from kinesic.body.config import ConfigError
from kinesic.body.utterance import Phoneme, Script
from kinesic.expressivity.face.visemes import LAG, ROUND_LEAD, shape_of, shapes, visemes
from kinesic.speech.durations import DurationModel
from kinesic.speech.spelling import SOUNDS

TIMES = np.arange(0.0, 6.0, 0.01)


def said(text: str) -> tuple[Phoneme, ...]:
    return DurationModel().say(Script(text)).phonemes


def test_lips_are_closed_through_every_p_b_and_m_and_nothing_parts_them():
    phonemes = said("My mother will be happy. Bob pumps up a lamp, maybe, Pam!")
    found = visemes(phonemes, TIMES)
    closing = [sound for sound in phonemes if sound.symbol in "pbm"]
    assert len(closing) > 10
    for sound in closing:
        during = (sound.start <= TIMES) & (sound.start + sound.duration >= TIMES)
        np.testing.assert_allclose(found["24"][during], 1.0)
        assert found["25"][during].max() == pytest.approx(0.0, abs=1e-12)
        assert found["26"][during].max() < 0.35


def test_vowels_open_the_jaw_between_closed_lips():
    phonemes = [Phoneme("p", 1.0, 0.1), Phoneme("a", 1.1, 0.2), Phoneme("p", 1.3, 0.1)]
    found = visemes(phonemes, TIMES)
    at = {time: np.searchsorted(TIMES, time - 1e-9) for time in (1.05, 1.2, 1.35)}
    assert found["26"][at[1.2]] == pytest.approx(0.75)
    assert found["24"][at[1.2]] < 0.05
    assert found["24"][at[1.05]] == found["24"][at[1.35]] == 1.0


def test_lips_round_before_the_sound_and_the_mouth_is_at_rest_before_and_after():
    found = visemes([Phoneme("t", 1.0, 0.1), Phoneme("u", 1.1, 0.2)], TIMES)
    assert found["18"][np.searchsorted(TIMES, 1.06)] > 0.1
    silent = (TIMES < 1.1 - ROUND_LEAD) | (TIMES > 1.3 + LAG)
    assert all(values[silent & (TIMES > 1.1)].max() == 0.0 for values in found.values())
    assert found["18"][silent].max() == 0.0


def test_it_begins_when_the_speech_begins():
    phonemes = said("Hello there")
    early, late = visemes(phonemes, TIMES), visemes(phonemes, TIMES, start=2.0)
    for channel in early:
        np.testing.assert_allclose(late[channel][200:], early[channel][:-200], atol=1e-9)


def test_nothing_jumps():
    found = visemes(said("What a wonderful, beautiful morning for a small robot."), TIMES)
    for channel, values in found.items():
        assert np.abs(np.diff(values)).max() < 0.55, channel
        assert values.min() >= 0.0
        assert values.max() <= 1.0
        assert channel in CHANNELS


def test_stress_length_and_diphthongs_are_understood():
    plain = visemes([Phoneme("o", 1.0, 0.1), Phoneme("u", 1.1, 0.1)], TIMES)
    stressed = visemes([Phoneme("\u02c8oʊ", 1.0, 0.2)], TIMES)
    for channel in plain:
        np.testing.assert_allclose(stressed[channel], plain[channel], atol=1e-9)
    assert visemes([Phoneme("", 1.0, 0.2), Phoneme("\u02d0", 1.0, 0.1)], TIMES) == {}


def test_every_sound_of_the_speech_has_a_shape_and_each_stands_in_one_kind():
    spoken = {letter for sounds in SOUNDS.values() for sound in sounds for letter in sound}
    assert spoken <= shapes().keys()
    assert shape_of("☃") == shape_of("ə")
    for a, b in pairwise("aiuo"):
        assert shape_of(a) != shape_of(b)


def test_a_file_of_ones_own_is_checked(tmp_path: Path):
    for number, (wrong, why) in enumerate((("3 = 1.0", "units: no action unit 3"), ("12 = 1.5", "12 is 1.5, must be"))):
        path = tmp_path / f"{number}.toml"
        path.write_text(f'[[viseme]]\nsays = "x"\nsounds = "a"\nunits = {{ {wrong} }}\n', encoding="utf-8")
        with pytest.raises(ConfigError, match=why):
            shapes(path)
