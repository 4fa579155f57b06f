"""Tests of marks and pauses in order, and of phoneme times."""

import numpy as np
import pytest

from kinesic.body.utterance import Mark, Pause, Phoneme, Script, Sound


def test_marks_and_pauses_are_listed_in_text_order():
    first, second, third, late = (Mark(name, position) for name, position in (("a", 3), ("b", 3), ("c", 3), ("d", 9)))
    before, between, end = Pause(3, 0.1), Pause(3, 0.2, after=2), Pause(12, 0.3)
    script = Script("text", marks=(late, first, second, third), pauses=(end, between, before))
    assert script.stops() == (before, first, second, between, third, late, end)
    assert Script("text").stops() == ()


def test_phoneme_without_measured_articulation_lasts_from_start_to_end():
    plain = Phoneme("m", 0.5, 0.25)
    assert (plain.end, plain.articulation) == (0.75, (0.5, 0.75))
    assert Phoneme("m", 0.5, 0.25, onset=0.0, release=0.25).articulation == (0.0, 0.25)
    assert Phoneme("m", 0.5, 0.25, release=0.7).articulation == (0.5, 0.7)


@pytest.mark.parametrize(("symbol", "letters"), [("ˈaː", "a"), ("ẽ", "e"), ("T", "t"), ("ʃ", "ʃ"), ("˥", "")])  # noqa: RUF001 - phonetic symbols
def test_letters_of_a_symbol_omit_stress_length_tone_and_diacritics(symbol: str, letters: str):
    assert Phoneme(symbol, 0.0, 0.1).letters == letters


def test_sound_keeps_a_read_only_copy_of_its_samples():
    samples = np.array([0.0, 0.5, -0.5, 1.0])
    sound = Sound.of(8, samples)
    samples[0] = 1.0
    assert sound.samples.tolist() == [0.0, 0.5, -0.5, 1.0]
    assert sound.duration == 0.5
    with pytest.raises(ValueError, match="read-only"):
        sound.samples[0] = 1.0
