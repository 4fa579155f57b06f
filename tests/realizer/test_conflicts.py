"""Names of behaviours that conflict with the running motion."""

import numpy as np
import pytest

from kinesic.realizer.conflicts import _nearest_behaviour
from kinesic.realizer.occupancy import Occupancy, Overlay

HINGE_COUNT = 3


def entry(id: str, hinge: int, begin: float, end: float) -> Occupancy:
    return Occupancy(id, frozenset(), np.arange(HINGE_COUNT) == hinge, begin, begin, end, end)


@pytest.fixture
def work() -> Overlay:
    motion = np.zeros((10, HINGE_COUNT))
    performed = [entry("late", 0, 9.0, 12.0), entry("soon", 0, 2.0, 4.0), entry("other", 1, 5.0, 7.0)]
    return Overlay(motion, motion, motion[0], 0, (), performed)


@pytest.mark.parametrize(
    ("hinge", "time", "name"),
    [(0, 3.0, "soon"), (0, 5.0, "soon"), (0, 8.0, "late"), (0, 10.0, "late"), (1, 3.0, "other"), (2, 6.0, "other")],
)
def test_conflict_names_the_nearest_behaviour_that_moves_the_hinge(work: Overlay, hinge: int, time: float, name: str):
    """If no behaviour moves the hinge, the conflict names the nearest behaviour."""
    assert _nearest_behaviour(work, np.arange(HINGE_COUNT) == hinge, time) == name


def test_conflict_of_a_block_without_behaviours_names_no_behaviour():
    motion = np.zeros((10, HINGE_COUNT))
    assert (
        _nearest_behaviour(Overlay(motion, motion, motion[0], 0, (), ()), np.ones(HINGE_COUNT, dtype=bool), 1.0) == ""
    )
