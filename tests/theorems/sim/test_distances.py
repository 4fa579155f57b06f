"""Distances between segments equal those of an exhaustive search."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from kinesic._kernel import sim as kernel

from ...examples import examples

SEGMENT_ENDS = arrays(np.float64, (4, 3), elements=st.floats(-1.0, 1.0, width=32))  # [m] ends of two line segments
SEGMENT_FRACTIONS = np.linspace(0.0, 1.0, 41)  # positions along a line segment, from 0 to 1


def distance(a0, a1, b0, b1):
    """Return the distance of two segments of zero thickness in one frame."""
    none, second, owners = np.zeros(1), np.ones(1, dtype=np.intp), np.zeros(2, dtype=np.int64)
    halves = np.array([(np.linalg.norm(a1 - a0) + np.linalg.norm(b1 - b0)) / 2])
    unhulled = np.zeros(1, dtype=np.bool_)
    ends = np.stack([a0, b0]), np.stack([a1, b1])
    pairs = kernel.make_pairs(owners, *ends, second - 1, second, none, halves, unhulled)
    gaps = np.empty((1, 1))
    pairs.gaps(np.eye(3)[None, :, :, None].copy(), np.zeros((1, 3, 1)), gaps)
    return float(gaps[0, 0])


@given(SEGMENT_ENDS)
@examples(300)
def test_line_segment_distance_equals_an_exhaustive_search(ends):
    a0, a1, b0, b1 = ends
    first = a0 + SEGMENT_FRACTIONS[:, None] * (a1 - a0)
    second = b0 + SEGMENT_FRACTIONS[:, None] * (b1 - b0)
    searched = np.linalg.norm(first[:, None] - second[None], axis=-1).min()
    spacing = (np.linalg.norm(a1 - a0) + np.linalg.norm(b1 - b0)) / 80
    result = distance(a0, a1, b0, b1)
    assert result <= searched + 1e-7
    assert result >= searched - spacing - 1e-7


@given(SEGMENT_ENDS)
@examples(200)
def test_line_segment_distance_is_independent_of_segment_order_and_direction(ends):
    a0, a1, b0, b1 = ends
    result = distance(a0, a1, b0, b1)
    assert distance(b0, b1, a0, a1) == pytest.approx(result, abs=1e-7)
    assert distance(a1, a0, b0, b1) == pytest.approx(result, abs=1e-7)
    assert distance(a0, a1, b1, b0) == pytest.approx(result, abs=1e-7)
