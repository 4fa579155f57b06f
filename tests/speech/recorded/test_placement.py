"""Words spread over the audible parts of a recording, by hand-made times."""

from types import SimpleNamespace

import numpy as np
import pytest

from kinesic.speech.recorded.given_times import GivenTime
from kinesic.speech.recorded.placement import EDGE_OFFSET, _find_runs_of_words, _spread

RENDITION = SimpleNamespace(starts=np.array([0.0, 1.0]), ends=np.array([0.5, 2.0]))  # words of 0.5 and 1 s
SPAN = (10.0, 20.0)


def spread(*audible: tuple[float, float], span: tuple[float, float] = SPAN):
    return _spread(RENDITION, SimpleNamespace(spans=list(audible)), (0, 2), span)


def test_words_share_the_audible_parts_by_their_durations():
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


def test_audible_parts_are_cut_to_the_span_and_begin_with_it():
    _, spans = spread((5.0, 9.0), (12.0, 13.0), (18.0, 25.0))
    np.testing.assert_allclose([spans[0][0], spans[1][1]], [10.0, 20.0])
    np.testing.assert_allclose(spans[0][1], 10.0 + 5.0 / 3.0)


def test_words_of_a_silent_span_fill_it_evenly():
    _, spans = spread((1.0, 2.0))
    np.testing.assert_allclose(spans, [(10.0, 10.0 + 10.0 / 3.0), (10.0 + 10.0 / 3.0, 20.0)])


def test_span_without_duration_holds_all_words_at_its_start():
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
def test_runs_of_words_lie_between_given_times(given, runs):
    times = [GivenTime(start, end) for start, end in given]
    assert list(_find_runs_of_words(times, 9.0)) == runs
