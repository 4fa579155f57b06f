import numpy as np
import pytest

from kinesic.speech.recorded.warping import FrameSequence, _trace, warp

WORDS = np.array([0, 40, 90, 150])  # first frame of each word
COUNT = 200


def make_rendition() -> FrameSequence:
    rng = np.random.default_rng(3)
    smooth = np.cumsum(rng.normal(size=(COUNT, 18)), axis=0)
    smooth = (smooth - smooth.mean(axis=0)) / smooth.std(axis=0)
    return FrameSequence(smooth, np.ones(COUNT, dtype=bool))


def stretch(rendition: FrameSequence, frames: np.ndarray, pauses: dict[int, int]) -> tuple[FrameSequence, np.ndarray]:
    """Return a recording that plays the given frames, with silent frames inserted before words."""
    features, is_speech = rendition.features[frames], np.ones(len(frames), dtype=bool)
    starts = np.searchsorted(frames, WORDS)
    for word, count in sorted(pauses.items(), reverse=True):
        features = np.insert(features, [starts[word]] * count, 9.0, axis=0)
        is_speech = np.insert(is_speech, [starts[word]] * count, False)
        starts[word:] += count
    return FrameSequence(features, is_speech), starts


@pytest.mark.parametrize("factor", [0.7, 1.0, 1.6])
@pytest.mark.parametrize("pauses", [{}, {0: 50, 2: 200}])
def test_words_are_found_at_other_rates_and_after_pauses(factor: float, pauses: dict[int, int]):
    rendition = make_rendition()
    frames = np.minimum((np.arange(round(COUNT * factor)) / factor).astype(int), COUNT - 1)
    recording, starts = stretch(rendition, frames, pauses)
    found = warp(recording, rendition, WORDS)
    assert found is not None
    assert found.word_frames == pytest.approx(starts, abs=2)
    assert recording.is_speech[found.frames].all()
    assert np.all(np.diff(found.rendition_frames) >= 0)


def test_rate_that_changes_within_the_recording_is_followed():
    rendition = make_rendition()
    frames = np.concatenate([np.repeat(np.arange(90), 2), np.arange(90, COUNT)])
    recording, starts = stretch(rendition, frames, {})
    found = warp(recording, rendition, WORDS)
    assert found is not None
    assert found.word_frames == pytest.approx(starts, abs=3)


def test_silence_has_no_warp():
    rendition = make_rendition()
    silent = FrameSequence(np.zeros((50, 18)), np.zeros(50, dtype=bool))
    assert warp(silent, rendition, WORDS) is None
    assert warp(rendition, silent, WORDS) is None


@pytest.mark.parametrize(("last_costs", "column"), [((4.0, 3.0), 2), ((3.0, 3.0), 2), ((3.0, 4.0), 1)])
def test_path_ends_at_the_cheaper_of_the_last_two_columns(last_costs: tuple[float, float], column: int):
    total = np.array([np.inf, np.inf, 5.0, *last_costs])
    steps = [np.zeros(3, dtype=np.int8), np.array([0, 1, 2], dtype=np.int8)]
    assert _trace(steps, np.array([0, 0]), total).tolist() == [0, column]


def test_word_after_the_end_of_the_rendition_begins_at_the_last_frame_with_speech():
    rendition = make_rendition()
    features = np.append(rendition.features, np.full((30, 18), 9.0), axis=0)
    recording = FrameSequence(features, np.arange(COUNT + 30) < COUNT)
    found = warp(recording, rendition, np.append(WORDS, COUNT))
    assert found is not None
    assert found.word_frames[-1] == COUNT - 1
