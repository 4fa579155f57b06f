"""Distances between segments, against a search over all their points."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from kinesic.sim.segment_distances import segment_distances

from ...examples import examples

ENDS = arrays(np.float64, (4, 3), elements=st.floats(-1.0, 1.0, width=32))
SHARES = np.linspace(0.0, 1.0, 41)


def distance(a0, a1, b0, b1):
    return float(segment_distances(a0[None], a1[None], b0[None], b1[None])[0])


@given(ENDS)
@examples(300)
def test_no_two_points_are_closer_and_some_are_as_close(ends):
    a0, a1, b0, b1 = ends
    first = a0 + SHARES[:, None] * (a1 - a0)
    second = b0 + SHARES[:, None] * (b1 - b0)
    searched = np.linalg.norm(first[:, None] - second[None], axis=-1).min()
    spacing = (np.linalg.norm(a1 - a0) + np.linalg.norm(b1 - b0)) / 80
    found = distance(a0, a1, b0, b1)
    assert found <= searched + 1e-7
    assert found >= searched - spacing - 1e-7


@given(ENDS)
@examples(200)
def test_the_distance_does_not_depend_on_order_or_direction(ends):
    a0, a1, b0, b1 = ends
    found = distance(a0, a1, b0, b1)
    assert distance(b0, b1, a0, a1) == pytest.approx(found, abs=1e-7)
    assert distance(a1, a0, b0, b1) == pytest.approx(found, abs=1e-7)
    assert distance(a0, a1, b1, b0) == pytest.approx(found, abs=1e-7)
