import pytest

from kinesic.body.utterance import Phoneme
from kinesic.speech.articulation import CLOSURE_TIME, _find_adjacent_letter, articulate


def articulation_times(*symbols: str, rate: float = 1.0, gap: float = 0.0) -> list[tuple[float, float]]:
    """Return articulation times [s] of sounds that last 0.1 s each."""
    sounds = [
        Phoneme(symbol, 0.1 * k + (gap if k == len(symbols) - 1 else 0.0), 0.1) for k, symbol in enumerate(symbols)
    ]
    return [sound.articulation for sound in articulate(sounds, rate=rate)]


def test_lips_are_closed_before_the_burst_of_a_voiceless_plosive():
    vowel, stop, last = articulation_times("\u02c8a", "p", "a")
    assert stop == pytest.approx((0.1 - CLOSURE_TIME, 0.1))
    assert vowel[1] == stop[0]
    assert last == pytest.approx((0.1, 0.3))  # the mouth moves on at the burst


def test_lip_closure_is_longer_in_slow_speech():
    _, (onset, release), _ = articulation_times("a", "p", "a", rate=0.8)
    assert release - onset == pytest.approx(CLOSURE_TIME / 0.8)


def test_voiced_plosive_is_released_late_after_a_vowel_but_at_its_start_after_a_nasal_or_pause():
    assert articulation_times("a", "b", "a")[1] == pytest.approx((0.1, 0.162))
    assert articulation_times("m", "b", "a")[1] == pytest.approx((0.1 - CLOSURE_TIME, 0.1))
    assert articulation_times("a", "b", gap=0.5)[1] == pytest.approx((0.6 - CLOSURE_TIME, 0.6))
    assert articulation_times("a", "b")[1][1] == pytest.approx(0.15)


def test_mouth_opens_early_after_a_nasal_only_before_a_vowel():
    assert articulation_times("a", "m", "a")[1] == pytest.approx((0.1, 0.17))
    assert articulation_times("a", "m", "s")[1] == pytest.approx((0.1, 0.2))
    (_, released), (onset, burst) = articulation_times("m", "p")
    assert released == pytest.approx(onset)  # a single closure
    assert burst == pytest.approx(0.1)


def test_fricatives_keep_engine_times_and_affricates_add_a_closure_before_them():
    assert articulation_times("s", "f", "a") == [pytest.approx(times) for times in ((0.0, 0.1), (0.1, 0.2), (0.2, 0.3))]
    assert articulation_times("a", "t\u0283", "a")[1] == pytest.approx((0.1 - CLOSURE_TIME, 0.2))


def test_articulation_of_speech_sounds_does_not_cross_a_pause():
    (_, released), (onset, _) = articulation_times("a", "s", gap=0.4)
    assert released == pytest.approx(0.1)
    assert onset == pytest.approx(0.5)


def test_neighbouring_letter_is_the_one_that_touches_the_sound():
    sound = Phoneme("a", 0.1, 0.1)
    assert _find_adjacent_letter(Phoneme("ts", 0.0, 0.1), sound) == "s"
    assert _find_adjacent_letter(Phoneme("ts", 0.2, 0.1), sound) == "t"
    assert _find_adjacent_letter(Phoneme("ts", 0.1, 0.1), sound) == "t"
    assert _find_adjacent_letter(Phoneme("ts", 0.5, 0.1), sound) == ""
    assert _find_adjacent_letter(None, sound) == ""
