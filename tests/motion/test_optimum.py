from dataclasses import replace

import pytest

from kinesic.body.arrays import sealed
from kinesic.body.limits import Limits
from kinesic.motion.condition import LEAD_IN, condition
from kinesic.motion.key_time_lp import shift_cost
from kinesic.motion.keys import KeyPosture, Keys
from kinesic.motion.optimum import LIMIT_TOLERANCE, best_times

# limits of one hinge, whose duty limit never binds
JOINT_LIMITS = Limits(*(sealed([value]) for value in (-2, 2, 4, 40, 1e3, 1e-4, 1e-4, 0.9)))


def keys_of(*rows: tuple[float, float, str]) -> tuple[KeyPosture, ...]:
    return tuple(KeyPosture(time, sealed([angle]), (True,), (("b", sync),)) for time, angle, sync in rows)


def test_rest_to_rest_optimum_is_within_2_percent_of_the_double_s_duration():
    ends = keys_of((0, 0, "start"), (0.1, 1.0, "stroke"))
    keys, motion = Keys.of(ends, JOINT_LIMITS), condition(ends, JOINT_LIMITS, lead_in=0.0)
    best = best_times(keys, motion, JOINT_LIMITS, 0.0)
    rise = 0.04
    double_s = 1 / 4 + 4 / 40 + rise
    assert best.times[1] == pytest.approx(double_s, rel=0.02)
    assert best.times[1] >= double_s - 1e-6
    assert best.excess <= 1 + LIMIT_TOLERANCE
    assert shift_cost(keys, motion.planned) <= 1.1 * best.shift_cost


def test_optimal_times_move_a_ready_key_and_keep_the_stroke_time():
    ends = keys_of((0, 0, "start"), (1.0, 1.0, "ready"), (1.1, 0.0, "stroke"), (2, 0, "end"))
    keys, motion = Keys.of(ends, JOINT_LIMITS), condition(ends, JOINT_LIMITS)
    best = best_times(keys, motion, JOINT_LIMITS, LEAD_IN)
    assert best.times[2] == pytest.approx(1.1, abs=1e-5)
    assert best.times[1] < 0.9
    assert best.shift_cost <= shift_cost(keys, motion.planned) + 1e-4


def test_tighter_limits_increase_the_optimal_shift_cost():
    ends = keys_of((0, 0, "start"), (0.3, 1.0, "ready"), (0.5, 0.0, "stroke"), (2, 0, "end"))
    slow = replace(JOINT_LIMITS, acceleration=sealed([20.0]))
    results = [
        best_times(Keys.of(ends, limits), condition(ends, limits), limits, LEAD_IN) for limits in (JOINT_LIMITS, slow)
    ]
    assert results[1].shift_cost > 1.1 * results[0].shift_cost
