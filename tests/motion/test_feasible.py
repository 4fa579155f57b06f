from dataclasses import replace

import numpy as np
import pytest

from kinesic.body.arrays import sealed
from kinesic.body.limits import Limits
from kinesic.motion import feasible
from kinesic.motion.condition import condition
from kinesic.motion.feasible import Search
from kinesic.motion.infeasibility import shortage
from kinesic.motion.keys import KeyPosture, Keys
from kinesic.motion.segments import segments
from kinesic.motion.trajectory import STEP

LIMITS = Limits(*(sealed([value] * 2) for value in (-2, 2, 4, 40, 1e3, 0.01, 0.15, 0.7)))
ROWS = ((0, 0, 0, "start"), (0.4, 0.6, 0, "ready"), (0.6, -0.6, 1, "stroke"), (0.8, 0.6, 1, "relax"), (2, 0, 0, "end"))
KEYS = tuple(KeyPosture(time, sealed(turn), (True, True), (("b", sync),)) for time, *turn, sync in ROWS)


def lacking(search: Search, keys: Keys):
    found = [segment for segment in segments(search.times, keys, STEP) if not segment.still]
    return [segment for segment in found if shortage(segment, LIMITS).amount > 0.0]


def test_it_begins_at_full_speed():
    keys = Keys.of(KEYS, LIMITS)
    search = Search(keys, LIMITS, 0.6)
    assert search.times[2] - search.times[1] == pytest.approx(0.3)
    assert search.met[1, 2].quantity == "speed"
    assert search.met[1, 2].ratio == pytest.approx(1.5)


def test_what_lacks_time_is_given_time():
    keys = Keys.of(KEYS, LIMITS)
    search = Search(keys, LIMITS, 0.6)
    lost = lacking(search, keys)
    assert lost
    search.avoid(lost[0])
    assert not lacking(search, keys)


def test_asked_times_that_suffice_are_not_touched():
    slow = tuple(replace(key, time=3 * key.time) for key in KEYS)
    keys = Keys.of(slow, LIMITS)
    np.testing.assert_array_equal(Search(keys, LIMITS, 0.6).times, keys.asked)


def test_a_segment_that_is_lost_whatever_is_known_rests_in_the_end(monkeypatch):
    """As if no program were ever solved: times grow, and in the end somebody is named."""
    monkeypatch.setattr(feasible, "LONGEST", 10.0)  # the longer a motion, the slower is each look at it
    keys = Keys.of(KEYS, LIMITS)
    search = Search(keys, LIMITS, 0.6)
    began = search.times

    def lose() -> None:
        for _ in range(100):
            search.avoid(next(segments(search.times, keys, STEP)))

    with pytest.raises(ArithmeticError, match="hinge 0 cannot move"):
        lose()
    assert search.times[-1] - search.times[0] > 2 * (began[-1] - began[0])


def test_a_hinge_that_can_hardly_move_takes_long():
    weak = replace(LIMITS, duty=sealed([0.06, 0.06]))
    motion = condition(KEYS, weak)
    assert motion.planned[-1] > 10.0
    assert {met.quantity for met in motion.bottlenecks.values()} == {"duty"}
