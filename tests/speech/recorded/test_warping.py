from itertools import product

import numpy as np
import pytest

from kinesic.speech.recorded.warping import (
    FrameSequence,
    _average,
    _find_path,
    _search,
    _shorten_silences,
    _trace,
    _window,
    warp,
)

WORD_FRAMES = np.array([0, 40, 90, 150])  # first frame of each word
FRAME_COUNT = 200  # number of frames of the rendition


def make_rendition() -> FrameSequence:
    rng = np.random.default_rng(3)
    smooth = np.cumsum(rng.normal(size=(FRAME_COUNT, 18)), axis=0)
    smooth = (smooth - smooth.mean(axis=0)) / smooth.std(axis=0)
    return FrameSequence(smooth, np.ones(FRAME_COUNT, dtype=bool))


def stretch(rendition: FrameSequence, frames: np.ndarray, pauses: dict[int, int]) -> tuple[FrameSequence, np.ndarray]:
    """Return a recording of given frames, with silent frames before words."""
    features, is_speech = rendition.features[frames], np.ones(len(frames), dtype=bool)
    starts = np.searchsorted(frames, WORD_FRAMES)
    for word, count in sorted(pauses.items(), reverse=True):
        features = np.insert(features, [starts[word]] * count, 9.0, axis=0)
        is_speech = np.insert(is_speech, [starts[word]] * count, False)
        starts[word:] += count
    return FrameSequence(features, is_speech), starts


@pytest.mark.parametrize("factor", [0.7, 1.0, 1.6])
@pytest.mark.parametrize("pauses", [{}, {0: 50, 2: 200}])
def test_time_warping_finds_word_starts_at_other_speech_rates_and_after_pauses(factor: float, pauses: dict[int, int]):
    rendition = make_rendition()
    frames = np.minimum((np.arange(round(FRAME_COUNT * factor)) / factor).astype(int), FRAME_COUNT - 1)
    recording, starts = stretch(rendition, frames, pauses)
    found = warp(recording, rendition, WORD_FRAMES)
    assert found is not None
    assert found.word_frames == pytest.approx(starts, abs=2)
    assert recording.is_speech[found.frames].all()
    assert np.all(np.diff(found.rendition_frames) >= 0)


def test_time_warping_follows_a_rate_change_within_the_recording():
    rendition = make_rendition()
    frames = np.concatenate([np.repeat(np.arange(90), 2), np.arange(90, FRAME_COUNT)])
    recording, starts = stretch(rendition, frames, {})
    found = warp(recording, rendition, WORD_FRAMES)
    assert found is not None
    assert found.word_frames == pytest.approx(starts, abs=3)


def test_silent_recording_or_rendition_gives_no_warping():
    rendition = make_rendition()
    silent = FrameSequence(np.zeros((50, 18)), np.zeros(50, dtype=bool))
    assert warp(silent, rendition, WORD_FRAMES) is None
    assert warp(rendition, silent, WORD_FRAMES) is None


@pytest.mark.parametrize(("last_costs", "column"), [((4.0, 3.0), 2), ((3.0, 3.0), 2), ((3.0, 4.0), 1)])
def test_time_warping_path_ends_at_the_cheaper_of_the_last_two_columns(last_costs: tuple[float, float], column: int):
    total = np.array([np.inf, np.inf, 5.0, *last_costs])
    steps = [np.zeros(3, dtype=np.int8), np.array([0, 1, 2], dtype=np.int8)]
    assert _trace(steps, np.array([0, 0]), total).tolist() == [0, column]


def test_word_after_the_end_of_the_rendition_begins_at_the_last_frame_with_speech():
    rendition = make_rendition()
    features = np.append(rendition.features, np.full((30, 18), 9.0), axis=0)
    recording = FrameSequence(features, np.arange(FRAME_COUNT + 30) < FRAME_COUNT)
    found = warp(recording, rendition, np.append(WORD_FRAMES, FRAME_COUNT))
    assert found is not None
    assert found.word_frames[-1] == FRAME_COUNT - 1


def test_each_silence_of_a_rendition_becomes_four_copies_of_its_first_frame():
    is_speech = np.array([0, 0, 1, 1, 1, 0, 0, 0, 0, 0, 0, 1], dtype=bool)
    frames, is_silent = _shorten_silences(is_speech)
    assert frames.tolist() == [0, 0, 0, 0, 2, 3, 4, 5, 5, 5, 5, 11]
    assert is_silent.tolist() == [True] * 4 + [False] * 3 + [True] * 4 + [False]


def test_sound_frames_are_averaged_in_groups_of_four():
    rows = np.array([[0.0, 1.0], [2.0, 1.0], [4.0, 1.0], [6.0, 1.0], [10.0, 3.0], [20.0, 5.0]])
    np.testing.assert_allclose(_average(rows), [[3.0, 1.0], [15.0, 4.0]])


def test_time_warping_window_never_moves_back_and_includes_the_first_and_last_column():
    first, last = _window(np.array([3.2, 5.0, 4.5, 9.0]), 2, 12)
    assert first.tolist() == [0, 2, 2, 7]
    assert last.tolist() == [6, 7, 7, 11]
    first, last = _window(np.array([0.0, 1.0]), 9, 3)
    assert (first.tolist(), last.tolist()) == ([0, 0], [2, 2])


def cost_of(path: tuple[int, ...], rows: tuple, columns: tuple) -> float:
    """Return a path's cost by definition, infinite for a forbidden path."""
    (features, is_silent), (others, takes_silence, is_gap) = rows, columns
    total = 0.0 if path[0] < 2 and path[-1] >= len(others) - 2 else np.inf
    for k, column in enumerate(path):
        step = column - path[k - 1] if k else 1
        total += {0: 1.7, 1: 0.0, 2: 0.0 if is_gap[column - 1] else 1.7}.get(step, np.inf)
        if is_silent[k]:
            total += 0.0 if takes_silence[column] else 10.0
        else:
            total += 7.5 if is_gap[column] else float(np.linalg.norm(others[column] - features[k]))
    return total


@pytest.mark.parametrize("seed", range(12))
def test_warping_path_equals_the_cheapest_path_of_an_exhaustive_search(seed: int):
    rng = np.random.default_rng(seed)
    count, width = 4, 6
    rows = (rng.normal(scale=4.0, size=(count, 2)), rng.random(count) < 0.3)
    is_gap = rng.random(width) < 0.3
    columns = (rng.normal(scale=4.0, size=(width, 2)), is_gap | (rng.random(width) < 0.2), is_gap)
    window = np.array([0, 0, 1, 2]), np.array([3, 4, 5, 5])
    paths = [
        path
        for path in product(range(width), repeat=count)
        if all(low <= column <= high for low, column, high in zip(window[0], path, window[1], strict=True))
    ]
    costs = [cost_of(path, rows, columns) for path in paths]
    found = tuple(_search(rows, columns, window).tolist())
    assert cost_of(found, rows, columns) == pytest.approx(min(costs))


def test_silent_frames_align_with_the_gap_column_before_the_next_word():
    """Use words of different features, so that each frame fits one column."""
    words = np.repeat(np.array([[0.0, 0.0], [40.0, 0.0], [0.0, 40.0]]), 8, axis=0)
    gaps = [0, 9, 18, 27]
    columns = np.full(28, -1)
    columns[[k for k in range(28) if k not in gaps]] = np.arange(24)
    rows = np.insert(words, [8] * 4, 99.0, axis=0)
    is_silent = np.arange(28) // 4 == 2
    path = _find_path(rows, is_silent, words, columns)
    assert path.tolist() == [*range(1, 9), *[9] * 4, *range(10, 18), *range(19, 27)]


@pytest.mark.parametrize(("recorded", "spoken"), [(1, 9), (9, 1)])
def test_recording_with_one_frame_of_speech_is_not_time_warped(recorded: int, spoken: int):
    recording, rendition = (FrameSequence(np.ones((10, 2)), np.arange(10) < count) for count in (recorded, spoken))
    assert warp(recording, rendition, np.array([0])) is None


def test_recording_with_two_frames_of_speech_is_time_warped():
    both = FrameSequence(np.array([[0.0], [5.0]]), np.ones(2, dtype=bool))
    found = warp(both, both, np.array([0, 1]))
    assert found is not None
    assert found.word_frames.tolist() == [0, 1]
    assert found.frames.tolist() == [0, 1]
    assert found.rendition_frames.tolist() == [0.0, 1.0]


def test_time_warping_skips_pauses_of_the_rendition_but_keeps_its_frame_numbers():
    features = np.repeat(np.array([[0.0, 0.0], [40.0, 0.0]]), 8, axis=0)
    rendition = FrameSequence(np.insert(features, [8] * 6, 99.0, axis=0), np.abs(np.arange(22) - 10.5) > 3)
    recording = FrameSequence(np.insert(features, [0] * 5, 99.0, axis=0), np.arange(21) >= 5)
    found = warp(recording, rendition, np.array([0, 14]))
    assert found is not None
    assert found.word_frames.tolist() == [5, 13]
    assert found.frames.tolist() == [*range(5, 21)]
    assert found.rendition_frames == pytest.approx([*range(8), *range(14, 22)])
