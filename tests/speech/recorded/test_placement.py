"""Tests that place words in the audible parts of hand-made recordings."""

from types import SimpleNamespace

import numpy as np
import pytest

from kinesic.body.utterance import Phoneme, Sound
from kinesic.speech.recorded import placement
from kinesic.speech.recorded.given_times import GivenTime
from kinesic.speech.recorded.placement import (
    EDGE_OFFSET,
    Placement,
    _extend,
    _find_final_closure,
    _find_runs_of_words,
    _join_spans,
    _list_path,
    _make_monotone,
    _place_by_sound,
    _spread,
    analyse,
    place_words,
    stretch_phonemes,
)
from kinesic.speech.recorded.warping import FrameSequence, Warp

# rendition of two words, of 0.5 s and 1 s
TWO_WORDS = SimpleNamespace(starts=np.array([0.0, 1.0]), ends=np.array([0.5, 2.0]))
RECORDED_SPAN = (10.0, 20.0)  # [s] span of the recording in which the words lie


def spread(*audible: tuple[float, float], span: tuple[float, float] = RECORDED_SPAN):
    return _spread(TWO_WORDS, SimpleNamespace(spans=list(audible)), (0, 2), span)


def test_words_are_spread_over_audible_parts_in_proportion_to_their_durations():
    points, spans = spread((10.0, 12.0), (15.0, 17.0))
    third = 4.0 / 3.0  # [s] of the 4 audible seconds for the word of 0.5 s
    np.testing.assert_allclose(spans, [(10.0, 10.0 + third), (10.0 + third, 17.0)])
    expected = [
        (0.0, 10.0),
        (0.5 - EDGE_OFFSET, 10.0 + third),
        (1.0, 10.0 + third),
        (1.25 - EDGE_OFFSET, 12.0),
        (1.25, 15.0),
        (2.0 - EDGE_OFFSET, 17.0),
    ]
    np.testing.assert_allclose(points, expected)


def test_audible_parts_are_clipped_to_the_span_and_the_first_starts_with_the_span():
    _, spans = spread((5.0, 9.0), (12.0, 13.0), (18.0, 25.0))
    np.testing.assert_allclose([spans[0][0], spans[1][1]], [10.0, 20.0])
    np.testing.assert_allclose(spans[0][1], 10.0 + 5.0 / 3.0)


def test_words_of_a_silent_span_fill_it_in_proportion_to_their_durations():
    _, spans = spread((1.0, 2.0))
    np.testing.assert_allclose(spans, [(10.0, 10.0 + 10.0 / 3.0), (10.0 + 10.0 / 3.0, 20.0)])


def test_audible_span_without_duration_gets_all_words_at_its_start():
    _, spans = spread((10.0, 12.0), span=(10.0, 10.0))
    np.testing.assert_allclose(spans, [(10.0, 10.0)] * 2)


@pytest.mark.parametrize(
    ("given", "runs"),
    [
        ([(None, None)] * 3, [(0, 3, 0.0, 9.0)]),
        ([(None, None), (2.0, None), (None, None)], [(0, 1, 0.0, 2.0), (1, 3, 2.0, 9.0)]),
        ([(1.0, 2.0), (None, None), (None, None)], [(0, 1, 1.0, 2.0), (1, 3, 2.0, 9.0)]),
        ([(None, None), (None, 4.0), (20.0, None)], [(0, 2, 0.0, 4.0), (2, 3, 9.0, 9.0)]),
    ],
)
def test_words_are_grouped_into_runs_between_their_given_times(given, runs):
    times = [GivenTime(start, end) for start, end in given]
    assert list(_find_runs_of_words(times, 9.0)) == runs


def test_recorded_time_between_two_placed_words_is_interpolated():
    found = Placement(((0.0, 1.0), (2.0, 5.0)), ())
    assert [found.place(time) for time in (-1.0, 0.5, 3.0)] == [1.0, 2.0, 5.0]


def test_word_placement_maps_increasing_synthesised_times_to_nondecreasing_recorded_times():
    points = [(0.0, 0.0), (0.0, 0.5), (1.0, 2.0), (1.0, 3.0), (2.0, 1.0), (3.0, 9.0), (3.0 + 2e-9, 9.5), (2.0, 4.0)]
    assert _make_monotone(points, 8.0) == ((0.0, 0.5), (1.0, 3.0), (2.0, 3.0), (3.0, 8.0), (3.0 + 2e-9, 8.0))
    assert _make_monotone([(0.0, 0.0), (5e-10, 1.0)], 8.0) == ((0.0, 0.0),)


def test_warping_path_of_a_word_keeps_every_third_frame_without_the_first_and_last_three():
    frames = np.arange(14)
    points = _list_path(frames / 10, frames / 5, np.arange(2, 14))
    assert points == [(0.5, 1.0), (0.8, 1.6)]


@pytest.mark.parametrize(("begins", "joined"), [(1.29, [(0.0, 2.0)]), (1.31, [(0.0, 1.0), (1.31, 2.0)])])
def test_speech_is_joined_across_silences_shorter_than_0_3_seconds(begins, joined):
    assert _join_spans([(0.0, 1.0), (begins, 2.0)]) == joined


@pytest.mark.parametrize(
    ("letter", "start", "closure"),
    [("p", 1.5, 1.5), ("b", 1.0, 1.0), ("m", 1.99, 1.99), ("a", 1.5, None), ("p", 2.0, None), ("p", 0.9, None)],
)
def test_word_ends_with_a_closure_if_its_last_sound_closes_the_lips(letter, start, closure):
    phonemes = (Phoneme("p", 0.2, 0.1), Phoneme(letter, start, 0.1))
    rendition = SimpleNamespace(
        starts=TWO_WORDS.starts, ends=TWO_WORDS.ends, utterance=SimpleNamespace(phonemes=phonemes)
    )
    assert _find_final_closure(rendition, 1) == closure


def test_last_word_is_extended_up_to_its_given_end_within_0_15_seconds():
    placed = [(0.0, 3.0), (0.4, 3.5), (0.6, 3.6), (0.9, 3.9)], [(2.0, 3.0), (3.0, 4.0)]
    assert _extend(placed, 4.1, 0.4) == ([(0.0, 3.0), (0.4, 3.5), (0.9, 4.1)], [(2.0, 3.0), (3.0, 4.1)])
    assert _extend(placed, 9.0, 0.4)[1][-1] == (3.0, 4.15)
    assert _extend(placed, 4.0, 0.4) is placed


def sounds_at(*phonemes: Phoneme, points=((0.0, 0.0), (10.0, 10.0)), spans=((1.0, 2.0), (4.0, 5.0))):
    return stretch_phonemes(phonemes, Placement(points, ()), SimpleNamespace(spans=list(spans)))


def test_phonemes_are_stretched_with_their_words():
    (sound,) = sounds_at(Phoneme("a", 0.6, 0.2), points=((0.0, 0.0), (1.0, 2.0)))
    assert (sound.start, sound.end) == pytest.approx((1.2, 1.6), abs=1e-4)
    assert sound.articulation == pytest.approx((1.2, 1.6), abs=1e-4)
    assert sound.end < 1.6


@pytest.mark.parametrize(
    ("symbol", "start", "end", "expected"),
    [
        ("a", 0.5, 1.5, (0.92, 1.5)),
        ("a", 1.5, 3.0, (1.5, 2.08)),
        ("p", 1.5, 3.0, (1.5, 2.15)),
        ("a", 2.0, 4.5, (3.92, 4.5)),
        ("p", 2.1, 4.5, (2.1, 2.15)),
        ("p", 2.15, 4.5, (3.92, 4.5)),
        ("a", 5.5, 6.0, (5.5, 6.0)),
    ],
)
def test_phonemes_are_clipped_to_audible_speech_plus_a_margin(symbol, start, end, expected):
    (sound,) = sounds_at(Phoneme(symbol, start, end - start))
    assert (sound.start, sound.end) == pytest.approx(expected, abs=1e-4)


def test_phoneme_in_a_long_silence_is_left_out():
    assert sounds_at(Phoneme("a", 2.5, 0.5)) == ()


@pytest.mark.parametrize(
    ("onset", "release", "expected"),
    [(1.48, 1.6, (1.48, 1.6)), (1.3, 1.9, (1.45, 1.7)), (1.55, 1.52, (1.55, 1.52)), (1.8, 1.2, (1.7, 1.5))],
)
def test_mouth_takes_its_shape_up_to_0_05_seconds_before_a_sound_and_keeps_it_to_its_end(onset, release, expected):
    (sound,) = sounds_at(Phoneme("a", 1.5, 0.2, onset=onset, release=release))
    assert (sound.onset, sound.release) == pytest.approx(expected, abs=1e-4)


def test_words_start_at_the_frames_that_time_warping_finds(monkeypatch):
    asked = []

    def warp(recording, rendition, word_frames):
        asked.append((len(recording.is_speech), len(rendition.is_speech), word_frames.tolist()))
        return Warp(np.array([1, 31]), np.arange(1, 61), np.arange(60.0))

    monkeypatch.setattr(placement, "warp", warp)
    rendition = SimpleNamespace(starts=np.array([0.0, 0.5, 0.8]), ends=np.array([0.4, 0.78, 1.1]))
    frames, rendered = (
        SimpleNamespace(sequence=FrameSequence(np.zeros((count, 1)), np.ones(count, dtype=bool)))
        for count in (300, 200)
    )
    points, spans = _place_by_sound(rendition, frames, rendered, (1, 3), (1.0, 2.0), keeps_start=False)
    assert asked == [(100, 61, [0, 30])]
    np.testing.assert_allclose(spans, [(1.01, 1.31), (1.31, 1.61)])
    np.testing.assert_allclose(points[0], (0.5, 1.01))
    np.testing.assert_allclose(points[1], (0.53, 1.04))
    np.testing.assert_allclose(points[-1], (1.1 - EDGE_OFFSET, 1.61))
    words_starts = [point for point in points if abs(point[0] - 0.8) < 1e-9]
    np.testing.assert_allclose(words_starts, [(0.8, 1.31)])
    _, kept = _place_by_sound(rendition, frames, rendered, (1, 3), (0.995, 2.0), keeps_start=True)
    assert kept[0][0] == 0.995
    monkeypatch.setattr(placement, "warp", lambda *_: None)
    assert _place_by_sound(rendition, frames, rendered, (1, 3), (1.0, 2.0), keeps_start=False) is None


@pytest.mark.parametrize("has_sound", [True, False])
def test_warped_or_spread_words_with_a_final_closure_are_extended_towards_the_given_end(monkeypatch, has_sound):
    asked = []

    def place_by_sound(rendition, frames, rendered, words, span, *, keeps_start):
        asked.append((words, span, keeps_start))
        return ([(0.0, span[0]), (2.0, span[1] - 0.1)], [(span[0], span[1] - 0.1)]) if has_sound else None

    monkeypatch.setattr(placement, "_place_by_sound", place_by_sound)
    monkeypatch.setattr(placement, "_spread", lambda *_: ([(0.0, 0.5), (2.0, 0.6)], [(0.5, 0.6)]))
    monkeypatch.setattr(placement, "_find_final_closure", lambda rendition, word: 1.0 if word == 0 else None)
    given = [GivenTime(0.5, 1.0), GivenTime(None, 3.0)]
    found = place_words(TWO_WORDS, "frames", given, 9.0, "rendered")
    assert asked == [((0, 1), (0.5, 1.0), True), ((1, 2), (1.0, 3.0), False)]
    expected = [(0.5, 1.0), (1.0, 2.9)] if has_sound else [(0.5, 0.75), (0.5, 0.6)]
    np.testing.assert_allclose(found.words, expected)
    assert found.points[0][0] == 0.0
    assert found.points[-1][0] == 2.0


def test_speech_analysis_bridges_silences_up_to_a_given_number_of_frames():
    rate = 16_000
    samples = 0.5 * np.sin(2 * np.pi * 500.0 * np.arange(rate) / rate)
    samples[6400:8000] = 0.0
    whole, split = (analyse(Sound.of(rate, samples), bridged=bridged) for bridged in (20, 2))
    assert len(whole.spans) == 1
    (first, second) = split.spans
    assert (first[1], second[0]) == pytest.approx((0.4, 0.5), abs=0.03)
    assert analyse(Sound.of(rate, np.zeros(10))).levels.shape == (0,)
