import numpy as np
import pytest

from kinesic.body.utterance import Emphasis, Mark, Phoneme, Script, Utterance
from kinesic.expressivity.prosody import (
    BROW_SPACING,
    NOD_SPACING,
    choose_accents,
    find_phrase_ends,
    scale_openings,
)

VOWEL_PERIOD = 0.25  # [s] from one syllable to the next
TEXT = Script("la " * 400)


def speak(accents=(), marks=None, count=400):
    sounds = tuple(Phoneme("a", VOWEL_PERIOD * k, VOWEL_PERIOD) for k in range(count))
    return Utterance(VOWEL_PERIOD * count, marks or {}, sounds, accents=tuple(accents))


def test_at_least_70_percent_of_pitch_accents_have_a_nod_or_raised_brows():
    accents = np.arange(0.5, 99.0, 0.8)
    chosen = choose_accents("s", speak(accents), TEXT, 0)
    assert {accent.time for accent in chosen} <= {*accents}
    assert len(chosen) >= 0.7 * len(accents)
    assert all(accent.nod > 0.0 or accent.brow > 0.0 for accent in chosen)
    nods = [accent for accent in chosen if accent.nod]
    brows = [accent for accent in chosen if accent.brow]
    assert len(nods) > 1.5 * len(brows) > 0


def test_nods_and_raised_brows_keep_their_minimum_and_mean_intervals():
    chosen = choose_accents("s", speak(), TEXT, 3)
    for spacing, times in (
        (NOD_SPACING, [accent.time for accent in chosen if accent.nod]),
        (BROW_SPACING, [accent.time for accent in chosen if accent.brow]),
    ):
        assert np.diff(times).min() >= spacing[0] - 1e-9
        assert np.mean(np.diff(times)) <= spacing[1] + 2 * VOWEL_PERIOD


def test_chosen_accents_are_reproducible_by_seed_and_speech():
    assert choose_accents("s", speak(), TEXT, 3) == choose_accents("s", speak(), TEXT, 3)
    assert choose_accents("s", speak(), TEXT, 3) != choose_accents("s", speak(), TEXT, 4)
    assert choose_accents("s", speak(), TEXT, 3) != choose_accents("t", speak(), TEXT, 3)


@pytest.mark.parametrize(("level", "is_strong"), [("strong", True), ("moderate", True), ("reduced", False)])
def test_strong_and_moderate_but_not_reduced_emphasis_enlarge_nod_and_brow_raise(level, is_strong):
    begin = 3 * 200  # the word at 50 s
    script = Script(TEXT.text, emphases=(Emphasis(begin, begin + 2, "emphasis", (("level", level),)),))
    for seed in range(5):
        near = [a for a in choose_accents("s", speak(), script, seed) if abs(a.time - 50.1) < 0.4]
        assert any(accent.nod > 1.0 and accent.brow > 0.45 for accent in near) == is_strong


def test_nod_on_an_emphasised_word_follows_the_speech_marks():
    script = Script(TEXT.text, marks=(Mark("m", 600),), emphases=(Emphasis(600, 602, "emphasis"),))
    strong = [a.time for a in choose_accents("s", speak(marks={"m": 20.0}), script, 1) if a.nod > 1.0]
    assert strong
    assert all(abs(time - 20.1) < 0.4 for time in strong)


def test_emphasis_in_a_speech_without_phonemes_has_no_motion():
    script = Script("la", emphases=(Emphasis(0, 2, "emphasis"),))
    assert choose_accents("s", Utterance(1.0), script, 0) == ()


def test_phrases_end_before_silences_and_with_the_speech():
    sounds = (Phoneme("a", 0.0, 0.4), Phoneme("b", 0.45, 0.15), Phoneme("a", 1.0, 0.5))
    assert find_phrase_ends(Utterance(1.5, {}, sounds)) == pytest.approx((0.6, 1.5))
    assert find_phrase_ends(Utterance(1.5)) == ()


def test_effect_of_loudness_on_the_lips_scales_with_the_amount():
    loud = (Phoneme("a", 0.0, 0.4, opening=1.2),)
    assert [scale_openings(loud, amount)[0].opening for amount in (0.0, 1.0, 2.0)] == pytest.approx([1.0, 1.2, 1.4])
