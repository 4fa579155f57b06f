import pytest

from kinesic.body.utterance import Phoneme
from kinesic.speech.articulation import CLOSED, articulate


def made(*symbols: str, rate: float = 1.0, gap: float = 0.0) -> list[tuple[float, float]]:
    """When each of some sounds of a tenth of a second is made [s]; a gap is before the last."""
    sounds = [
        Phoneme(symbol, 0.1 * k + (gap if k == len(symbols) - 1 else 0.0), 0.1) for k, symbol in enumerate(symbols)
    ]
    return [each.made for each in articulate(sounds, rate=rate)]


def test_a_voiceless_stop_is_closed_before_its_event_which_is_its_burst():
    vowel, stop, last = made("\u02c8a", "p", "a")
    assert stop == pytest.approx((0.1 - CLOSED, 0.1))
    assert vowel[1] == stop[0]
    assert last == pytest.approx((0.1, 0.3))  # the mouth moves on at the burst


def test_it_is_closed_longer_when_speech_is_slow():
    _, (onset, release), _ = made("a", "p", "a", rate=0.8)
    assert release - onset == pytest.approx(CLOSED / 0.8)


def test_a_voiced_stop_bursts_within_after_a_vowel_and_at_its_event_after_anything_else():
    assert made("a", "b", "a")[1] == pytest.approx((0.1, 0.162))
    assert made("m", "b", "a")[1] == pytest.approx((0.1 - CLOSED, 0.1))
    assert made("a", "b", gap=0.5)[1] == pytest.approx((0.6 - CLOSED, 0.6))
    assert made("a", "b")[1][1] == pytest.approx(0.15)


def test_a_nasal_opens_before_a_vowel_and_holds_until_anything_else():
    assert made("a", "m", "a")[1] == pytest.approx((0.1, 0.17))
    assert made("a", "m", "s")[1] == pytest.approx((0.1, 0.2))
    (_, released), (onset, burst) = made("m", "p")
    assert released == pytest.approx(onset)  # one closure
    assert burst == pytest.approx(0.1)


def test_sounds_whose_events_are_right_are_left_alone():
    assert made("s", "f", "a") == [pytest.approx(each) for each in ((0.0, 0.1), (0.1, 0.2), (0.2, 0.3))]
    assert made("a", "t\u0283", "a")[1] == pytest.approx((0.1 - CLOSED, 0.2))


def test_pauses_keep_sounds_apart():
    (_, released), (onset, _) = made("a", "s", gap=0.4)
    assert released == pytest.approx(0.1)
    assert onset == pytest.approx(0.5)
