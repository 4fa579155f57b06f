from collections.abc import Mapping
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from kinesic.body.action_units import CHANNELS
from kinesic.body.arrays import Floats
from kinesic.body.config import ConfigError
from kinesic.body.utterance import Phoneme, Script
from kinesic.expressivity.face.opening import opening
from kinesic.expressivity.face.visemes import LAG, ROUND_LEAD, SOONER, UNSTRESSED, known_visemes, viseme_of, visemes
from kinesic.face.assets.action_units import intensities
from kinesic.face.render.wrinkles import shares
from kinesic.speech.durations import DurationModel
from kinesic.speech.spelling import SOUNDS

TIMES = np.arange(0.0, 6.0, 0.01)


def said(text: str) -> tuple[Phoneme, ...]:
    return DurationModel().say(Script(text)).phonemes


def at(found: Mapping[str, Floats], channel: str, time: float) -> float:
    return float(np.interp(time, TIMES, found[channel]))


def test_lips_are_closed_in_every_p_b_and_m_and_nothing_parts_them():
    phonemes = said("My mother will be happy. Bob pumps up a lamp, maybe, Pam!")
    found = visemes(phonemes, TIMES)
    closing = [sound for sound in phonemes if sound.symbol in "pbm"]
    assert len(closing) > 10
    for sound in closing:
        during = (sound.start <= TIMES) & (sound.end - SOONER >= TIMES)
        np.testing.assert_allclose(found["24"][during], 1.0, atol=1e-6)
        assert found["25"][during].max() == pytest.approx(0.0, abs=0.01)
        assert found["26"][during].max() == pytest.approx(0.0, abs=0.01)


def test_vowels_open_the_jaw_between_closed_lips():
    phonemes = [Phoneme("p", 1.0, 0.1), Phoneme("a", 1.1, 0.3), Phoneme("p", 1.4, 0.1)]
    found = visemes(phonemes, TIMES)
    assert at(found, "26", 1.25) == pytest.approx(viseme_of("a").units["26"], abs=0.03)
    assert at(found, "24", 1.25) == 0.0
    assert at(found, "24", 1.04) == at(found, "24", 1.45) == 1.0


def test_lips_let_go_at_the_burst_and_not_where_the_next_sound_begins():
    late = [Phoneme("p", 1.0, 0.1), Phoneme("a", 1.1, 0.3)]
    bursting = [Phoneme("p", 1.0, 0.1, onset=0.95, release=1.0), Phoneme("a", 1.1, 0.3, onset=1.0)]
    early, usual = visemes(bursting, TIMES), visemes(late, TIMES)
    assert at(early, "24", 0.96) == at(usual, "24", 1.06) == 1.0
    assert at(early, "24", 1.02) < 0.1
    assert at(usual, "24", 1.02) == 1.0
    assert at(early, "26", 1.02) > 0.05


def test_a_burst_opens_the_lips_even_where_nothing_follows():
    found = visemes([Phoneme("a", 1.0, 0.2), Phoneme("p", 1.2, 0.1, onset=1.15, release=1.2)], TIMES)
    assert at(found, "26", 1.17) == pytest.approx(0.0, abs=0.01)
    assert opening({channel: at(found, channel, 1.26) for channel in found}) > 0.003


def test_vowels_without_stress_open_less_where_the_voice_tells_stress():
    def widest(symbol: str, before: str = "t") -> float:
        return float(visemes([Phoneme(before, 0.9, 0.1), Phoneme(symbol, 1.0, 0.3)], TIMES)["26"].max())

    assert widest("a", "\u02c8t") == pytest.approx(UNSTRESSED * widest("\u02c8a"))
    assert widest("a") == widest("\u02c8a")  # who tells none may mean any


def test_a_face_that_only_talks_has_no_furrows():
    for letter, viseme in known_visemes().items():
        assert not shares(intensities(viseme.units)).any(), letter


def test_the_mouth_is_the_same_whatever_else_is_asked_for():
    phonemes = said("Happy people bought a map from my mother.")
    whole = visemes(phonemes, TIMES)
    part = (TIMES > 0.8) & (TIMES < 1.3)
    for channel, row in visemes(phonemes, TIMES[part]).items():
        np.testing.assert_allclose(row, whole[channel][part], atol=1e-9)


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
        assert np.abs(np.diff(values)).max() < 0.8, channel
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
    assert spoken <= known_visemes().keys()
    assert viseme_of("☃") is viseme_of("ə")
    for a, b in pairwise("aiuo"):
        assert viseme_of(a).units != viseme_of(b).units


def test_a_file_of_ones_own_is_checked(tmp_path: Path):
    for number, (wrong, why) in enumerate((("3 = 1.0", "units: no action unit 3"), ("12 = 1.5", "12 is 1.5, must be"))):
        path = tmp_path / f"{number}.toml"
        path.write_text(f'[[viseme]]\nsays = "x"\nsounds = "a"\nunits = {{ {wrong} }}\n', encoding="utf-8")
        with pytest.raises(ConfigError, match=why):
            known_visemes(path)
