"""Fixture: gestures that need one hand at the same time."""

import pytest

from kinesic.expressivity.hands.strokes import Stroke

from .reached_hands import A, B, C, right


@pytest.fixture
def overlapping(phases):
    """Return two gestures of one hand with overlapping strokes."""
    first = Stroke("g1", phases(0, 0.6, 0.6, 1.0, 1.9, 2.0, 2.6), (right(A, B, C),))
    second = Stroke("g2", phases(1.0, 1.6, 1.6, 2.6, 2.6, 2.8, 3.4), (right(C, A),))
    return [first, second]
