"""Properties of all kinds of hand paths."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from kinesic.body.arrays import sealed
from kinesic.expressivity.lexicon.paths import HandPath

places = st.tuples(*[st.floats(-0.5, 0.8)] * 3).map(sealed)
sizes = st.tuples(*[st.floats(-0.5, 0.5)] * 3).map(sealed)
turns = st.tuples(*[st.floats(0, 5)] * 3).map(sealed)
variations = st.sampled_from(["none", "grows", "shrinks"])
points = st.lists(st.tuples(*[st.floats(-0.5, 0.8)] * 3), max_size=4).map(lambda p: sealed(np.array(p).reshape(-1, 3)))
paths = st.builds(HandPath, st.just("points"), sizes, turns, sizes, variations, variations, points)
MIRROR_SIGNS = np.array([1.0, -1.0, 1.0])


@given(paths, places, places)
def test_hand_path_of_every_kind_starts_and_ends_exactly_at_its_keys(
    path: HandPath, start: np.ndarray, end: np.ndarray
) -> None:
    np.testing.assert_allclose(path.at(start, end, np.array([0.0, 1.0])), [start, end], atol=1e-9)


@given(paths, places, places)
def test_mirror_image_of_a_hand_path_is_the_path_of_mirrored_keys(
    path: HandPath, start: np.ndarray, end: np.ndarray
) -> None:
    other = path.mapped(MIRROR_SIGNS * path.amplitude, lambda point: sealed(MIRROR_SIGNS * point))
    shares = np.linspace(0, 1, 50)
    mirrored = other.at(sealed(MIRROR_SIGNS * start), sealed(MIRROR_SIGNS * end), shares)
    np.testing.assert_allclose(mirrored, MIRROR_SIGNS * path.at(start, end, shares), atol=1e-9)
    np.testing.assert_allclose(
        other.samples(MIRROR_SIGNS * start, MIRROR_SIGNS * end, 0.01), path.samples(start, end, 0.01), atol=1e-12
    )


@given(paths, places, places)
def test_samples_of_a_hand_path_are_ordered_and_between_its_end_keys(
    path: HandPath, start: np.ndarray, end: np.ndarray
) -> None:
    shares = path.samples(start, end, 0.02, 0.3)
    assert np.all(np.diff([0.0, *shares, 1.0]) > 0)


@given(paths, places, places)
def test_no_hand_path_is_shorter_than_a_straight_line(path: HandPath, start: np.ndarray, end: np.ndarray) -> None:
    assert path.length(start, end) >= np.linalg.norm(end - start) - 1e-9
    assert path.swings(start, end) >= 1
