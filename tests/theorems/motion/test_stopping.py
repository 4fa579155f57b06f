"""A motion can be stopped smoothly at any time."""

from functools import lru_cache

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from kinesic.motion.limit_check import check_limits
from kinesic.motion.stopping import cut_knot, stop
from kinesic.motion.trajectory import KNOT_INTERVAL
from kinesic.planning.plan import Plan
from kinesic.session.plan import plan
from kinesic.session.setup import set_up

from ...passage import passage_text


@lru_cache(maxsize=2)
def planned(repetition: int) -> Plan:
    return plan(passage_text(repetition), known())


@lru_cache(maxsize=1)
def known():
    return set_up()


def check(before, after, knot: int) -> None:
    np.testing.assert_array_equal(after.controls[:knot], before.controls[:knot])
    np.testing.assert_allclose(after.controls[knot : knot + 3], before.controls[knot : knot + 3], atol=1e-9)
    for name, peak in check_limits(after, known().limits).by_quantity.items():
        assert peak.ratios.max() <= 1.001, name


@settings(max_examples=12, deadline=None)
@given(st.floats(0.0, 1.0), st.floats(0.0, 1.0))
def test_random_and_repeated_stops_keep_the_limits(first, second):
    motion = planned(0).trajectory
    time = first * motion.duration
    halted = stop(motion, time, known().limits)
    check(motion, halted, cut_knot(motion, time))
    begin = cut_knot(motion, time) * KNOT_INTERVAL
    again = begin + second * (halted.duration - begin)
    check(halted, stop(halted, again, known().limits), cut_knot(halted, again))
