"""Keys of two hinges with too little time, and their key-time search."""

from collections.abc import Callable

import numpy as np

from kinesic.body.arrays import sealed
from kinesic.body.limits import Limits
from kinesic.motion import key_times
from kinesic.motion.infeasibility import Infeasibility
from kinesic.motion.key_times import KeyTimeSearch
from kinesic.motion.keys import KeyPosture, Keys
from kinesic.motion.segments import SplineSegment

# limits of two hinges, in the order of the fields of `Limits`
JOINT_LIMITS = Limits(*(sealed([value] * 2) for value in (-2, 2, 4, 40, 1e3, 0.01, 0.15, 0.7)))
# key time [s], angles of both hinges [rad] and sync point
HURRIED_ROWS = (
    (0, 0, 0, "start"),
    (0.4, 0.6, 0, "ready"),
    (0.6, -0.6, 1, "stroke"),
    (0.8, 0.6, 1, "relax"),
    (2, 0, 0, "end"),
)


def keys_of(rows=HURRIED_ROWS) -> Keys:
    postures = (KeyPosture(t, sealed(turns), (True, True), (("b", sync),)) for t, *turns, sync in rows)
    return Keys.of(tuple(postures), JOINT_LIMITS)


def search_of(rows=HURRIED_ROWS, **options) -> KeyTimeSearch:
    return KeyTimeSearch(keys_of(rows), JOINT_LIMITS, 0.6, **options)


def first_segment(search: KeyTimeSearch) -> SplineSegment:
    return next(item for item in search._find_segments(search.times) if item.hinge == 0)


def deficit_of(segment: SplineSegment, amount: float = 0.1, programs: int = 1, binds=lambda k: True) -> Infeasibility:
    slopes = np.zeros(len(segment.marks))
    slopes[:2] = -2.0, 2.0
    binding = tuple("speed" if binds(k) else None for k in range(len(segment.marks) - 1))
    return Infeasibility(amount, slopes, binding, np.zeros(segment.grid.size), programs)


def fake_measure(monkeypatch, answer: Callable[..., Infeasibility | None]) -> list[dict]:
    """Replace the measurement of time deficits, and record its options."""
    asked: list[dict] = []

    def measure(segment, limits, **options):
        asked.append(options)
        return answer(segment)

    monkeypatch.setattr(key_times, "measure_time_deficit", measure)
    return asked
