from collections.abc import Mapping
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from kinesic.body.action_units import FACE_CHANNELS
from kinesic.body.arrays import Floats
from kinesic.body.config import ConfigError
from kinesic.body.utterance import Phoneme, Script
from kinesic.expressivity.face.opening import BITE_OPENINGS, MAX_LIP_VELOCITY, lip_opening
from kinesic.expressivity.face.visemes import (
    RELEASE_ADVANCE,
    ROUND_LEAD_TIME,
    SHAPE_LAG_TIME,
    UNSTRESSED_OPENING,
    known_visemes,
    viseme_of,
    visemes,
)
from kinesic.face.assets.action_units import read_intensities
from kinesic.face.render.wrinkles import compute_map_strengths
from kinesic.speech.durations import DurationModel
from kinesic.speech.spelling import SPELLING_SOUNDS

SAMPLE_TIMES = np.arange(0.0, 6.0, 0.01)


def said(text: str) -> tuple[Phoneme, ...]:
    return DurationModel().say(Script(text)).phonemes


def at(found: Mapping[str, Floats], channel: str, time: float) -> float:
    return float(np.interp(time, SAMPLE_TIMES, found[channel]))


def test_lips_stay_closed_during_every_p_b_and_m():
    phonemes = said("My mother will be happy. Bob pumps up a lamp, maybe, Pam!")
    mouth_units = visemes(phonemes, SAMPLE_TIMES)
    closing = [sound for sound in phonemes if sound.symbol in "pbm"]
    assert len(closing) > 10
    for sound in closing:
        during = (sound.start <= SAMPLE_TIMES) & (sound.end - RELEASE_ADVANCE >= SAMPLE_TIMES)
        np.testing.assert_allclose(mouth_units["24"][during], 1.0, atol=1e-6)
        assert mouth_units["25"][during].max() == pytest.approx(0.0, abs=0.01)
        assert mouth_units["26"][during].max() == pytest.approx(0.0, abs=0.01)


def test_jaw_opens_for_a_vowel_between_two_closed_plosives():
    phonemes = [Phoneme("p", 1.0, 0.1), Phoneme("a", 1.1, 0.3), Phoneme("p", 1.4, 0.1)]
    mouth_units = visemes(phonemes, SAMPLE_TIMES)
    assert at(mouth_units, "26", 1.25) == pytest.approx(viseme_of("a").units["26"], abs=0.03)
    assert at(mouth_units, "24", 1.25) == 0.0
    assert at(mouth_units, "24", 1.04) == at(mouth_units, "24", 1.45) == 1.0


@pytest.mark.parametrize(("symbol", "is_firm"), [("i", False), ("u", False), ("s", True), ("f", True)])
def test_fricatives_but_not_close_vowels_limit_the_lip_opening_of_the_preceding_vowel(symbol: str, is_firm: bool):
    mouth_units = visemes([Phoneme("a", 1.0, 0.15), Phoneme(symbol, 1.15, 0.15)], SAMPLE_TIMES)
    openings = lip_opening(mouth_units)[(SAMPLE_TIMES > 1.16) & (SAMPLE_TIMES < 1.29)]
    limit = float(lip_opening(viseme_of(symbol).units))
    assert viseme_of(symbol).firm == is_firm
    assert openings.max() <= limit + 1e-6 if is_firm else openings.max() > 1.1 * limit


def test_lips_open_at_the_burst_of_a_plosive():
    late = [Phoneme("p", 1.0, 0.1), Phoneme("a", 1.1, 0.3)]
    bursting = [Phoneme("p", 1.0, 0.1, onset=0.95, release=1.0), Phoneme("a", 1.1, 0.3, onset=1.0)]
    early, usual = visemes(bursting, SAMPLE_TIMES), visemes(late, SAMPLE_TIMES)
    assert at(early, "24", 0.96) == at(usual, "24", 1.06) == 1.0
    assert at(early, "24", 1.02) < 0.1
    assert at(usual, "24", 1.02) == 1.0
    assert at(early, "26", 1.02) > 0.05


def test_lip_bite_of_f_is_zero_while_the_lips_are_closed():
    found = visemes([Phoneme("f", 1.0, 0.15), Phoneme("p", 1.15, 0.15)], SAMPLE_TIMES)
    assert at(found, "32", 1.05) > 0.5
    closed = found["24"] == 1.0
    assert closed.any()
    assert found["32"][closed].max() == 0.0


def test_lips_open_after_a_final_plosive():
    mouth_units = visemes([Phoneme("a", 1.0, 0.2), Phoneme("p", 1.2, 0.1, onset=1.15, release=1.2)], SAMPLE_TIMES)
    assert at(mouth_units, "26", 1.17) == pytest.approx(0.0, abs=0.01)
    assert lip_opening({channel: at(mouth_units, channel, 1.26) for channel in mouth_units}) > 0.003


def test_unstressed_vowels_open_less_if_stress_is_marked():
    def widest(symbol: str, before: str = "t") -> float:
        return float(visemes([Phoneme(before, 0.9, 0.1), Phoneme(symbol, 1.0, 0.3)], SAMPLE_TIMES)["26"].max())

    assert widest("a", "\u02c8t") == pytest.approx(UNSTRESSED_OPENING * widest("\u02c8a"))
    assert widest("a") == widest("\u02c8a")  # Without stress marks, the opening is full


def test_action_units_of_speech_cause_no_wrinkles():
    for letter, viseme in known_visemes().items():
        assert not compute_map_strengths(read_intensities(viseme.units)).any(), letter


def test_mouth_shape_at_a_time_does_not_depend_on_other_sampled_times():
    phonemes = said("Happy people bought a map from my mother.")
    whole = visemes(phonemes, SAMPLE_TIMES)
    part = (SAMPLE_TIMES > 0.8) & (SAMPLE_TIMES < 1.3)
    for channel, row in visemes(phonemes, SAMPLE_TIMES[part]).items():
        np.testing.assert_allclose(row, whole[channel][part], atol=1e-9)


def test_lips_round_before_a_rounded_vowel_and_relax_outside_speech():
    mouth_units = visemes([Phoneme("t", 1.0, 0.1), Phoneme("u", 1.1, 0.2)], SAMPLE_TIMES)
    assert mouth_units["18"][np.searchsorted(SAMPLE_TIMES, 1.06)] > 0.1
    silent = (SAMPLE_TIMES < 1.1 - ROUND_LEAD_TIME) | (SAMPLE_TIMES > 1.3 + SHAPE_LAG_TIME)
    assert all(values[silent & (SAMPLE_TIMES > 1.1)].max() == 0.0 for values in mouth_units.values())
    assert mouth_units["18"][silent].max() == 0.0


def test_mouth_motion_of_a_later_speech_is_the_same_but_shifted_by_its_start_time():
    phonemes = said("Hello there")
    early, late = visemes(phonemes, SAMPLE_TIMES), visemes(phonemes, SAMPLE_TIMES, start=2.0)
    for channel in early:
        np.testing.assert_allclose(late[channel][200:], early[channel][:-200], atol=1e-9)


def test_mouth_action_units_stay_between_0_and_1_and_change_by_less_than_0_8_in_10_ms():
    mouth_units = visemes(said("What a wonderful, beautiful morning for a small robot."), SAMPLE_TIMES)
    for channel, values in mouth_units.items():
        assert np.abs(np.diff(values)).max() < 0.8, channel
        assert values.min() >= 0.0
        assert values.max() <= 1.0
        assert channel in FACE_CHANNELS


def test_phonetic_symbols_of_stress_length_and_diphthongs_are_parsed():
    plain = visemes([Phoneme("o", 1.0, 0.1), Phoneme("u", 1.1, 0.1)], SAMPLE_TIMES)
    stressed = visemes([Phoneme("\u02c8oʊ", 1.0, 0.2)], SAMPLE_TIMES)
    for channel in plain:
        np.testing.assert_allclose(stressed[channel], plain[channel], atol=1e-9)
    assert visemes([Phoneme("", 1.0, 0.2), Phoneme("\u02d0", 1.0, 0.1)], SAMPLE_TIMES) == {}


def test_every_phoneme_of_the_spelling_rules_has_a_viseme_and_unknown_ones_use_schwa():
    spoken = {letter for sounds in SPELLING_SOUNDS.values() for sound in sounds for letter in sound}
    assert spoken <= known_visemes().keys()
    assert viseme_of("☃") is viseme_of("ə")
    for a, b in pairwise("aiuo"):
        assert viseme_of(a).units != viseme_of(b).units


def test_invalid_action_unit_in_user_visemes_is_refused(tmp_path: Path):
    for number, (wrong, why) in enumerate((("3 = 1.0", "units: no action unit 3"), ("12 = 1.5", "12 is 1.5, must be"))):
        path = tmp_path / f"{number}.toml"
        path.write_text(f'[[viseme]]\nsays = "x"\nsounds = "a"\nunits = {{ {wrong} }}\n', encoding="utf-8")
        with pytest.raises(ConfigError, match=why):
            known_visemes(path)


def test_loudness_scales_the_lip_opening_of_a_vowel_but_not_lip_closure():
    times = np.arange(0.0, 0.6, 0.005)
    quiet, loud = (
        visemes((Phoneme("m", 0.1, 0.1, opening=value), Phoneme("a", 0.2, 0.3, opening=value)), times)
        for value in (0.6, 1.2)
    )
    assert quiet["26"].max() == pytest.approx(0.5 * loud["26"].max(), rel=0.05)
    assert quiet["24"].max() == loud["24"].max()


@pytest.mark.parametrize("letter", ["\u03b2", "\u0278"])
def test_bilabial_fricatives_bring_both_lips_close_without_contact(letter: str):
    units = viseme_of(letter).units
    assert not units.keys() & {"24", "32"}
    assert 0.0005 < lip_opening(units) < 0.002


def test_lower_lip_reaches_the_teeth_after_closed_lips_within_the_lip_velocity_limit():
    sounds = (Phoneme("a", 0.5, 0.2), Phoneme("p", 0.7, 0.06), Phoneme("f", 0.76, 0.1), Phoneme("a", 0.86, 0.2))
    times = np.arange(0.0, 2.0, 0.005)
    shown = visemes(sounds, times)
    bite = BITE_OPENINGS["32"] * shown["32"]
    assert np.abs(np.diff(bite)).max() / 0.005 <= MAX_LIP_VELOCITY + 1e-9
    assert bite[shown["24"] > 0.99].max() < 0.0005
    assert shown["32"].max() > 0.6
