from dataclasses import replace

import numpy as np
import pytest

from kinesic.body.arrays import sealed
from kinesic.body.limits import Limits
from kinesic.motion.condition import condition
from kinesic.motion.keys import KeyPosture, Keys
from kinesic.motion.least import full_speed, rest_to_rest

LIMITS = Limits(*(sealed([value]) for value in (-2, 2, 4, 40, 1e3, 0.01, 0.15, 0.7)))


def keys_of(*rows: tuple[float, float, str]) -> tuple[KeyPosture, ...]:
    return tuple(KeyPosture(time, sealed([angle]), (True,), (("b", sync),)) for time, angle, sync in rows)


@pytest.mark.parametrize("distance", [0.0, 0.002, 0.05, 0.4, 1.9, 3.9])
def test_from_rest_to_rest_is_enough_and_full_speed_is_not(distance):
    def ends(duration: float) -> tuple[KeyPosture, ...]:
        return keys_of((0, -1.95, "start"), (duration, -1.95 + distance, "stroke"))

    keys = Keys.of(ends(1.0), LIMITS)
    enough, least = rest_to_rest(keys, LIMITS)[0, (0, 1)], full_speed(keys, LIMITS)[0, (0, 1)]
    np.testing.assert_array_equal(condition(ends(enough), LIMITS).planned, [0.0, enough])
    assert least <= enough
    if distance > 0.01:
        short = condition(ends(0.7 * enough - 0.04), LIMITS, lead_in=0.0)
        assert least < short.planned[1] < 1.1 * enough


def test_all_ways_of_a_hinge_are_known():
    keys = Keys.of(keys_of((0, 0, "start"), (1, 1, "stroke"), (2, 1, "end")), LIMITS)
    assert set(rest_to_rest(keys, LIMITS)) == {(0, (0, 1)), (0, (1, 2))}
    assert full_speed(keys, LIMITS) == {(0, (0, 1)): pytest.approx(0.25), (0, (1, 2)): 0.0}


def test_a_tighter_duty_takes_longer():
    keys = Keys.of(keys_of((0, 0, "start"), (1, 1, "stroke")), LIMITS)
    tight = replace(LIMITS, duty=sealed([0.35]))
    for times in (rest_to_rest, full_speed):
        assert times(keys, tight)[0, (0, 1)] > 1.2 * times(keys, LIMITS)[0, (0, 1)] or times is full_speed
    assert full_speed(keys, tight)[0, (0, 1)] == pytest.approx(0.15 / 0.35)
