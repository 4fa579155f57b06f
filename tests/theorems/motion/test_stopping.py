"""A motion can be left at any moment, without a step and within every limit."""

from functools import lru_cache

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from kinesic.controller.perform import plan, set_up
from kinesic.motion.limit_check import check_limits
from kinesic.motion.stopping import cut_knot, stop
from kinesic.motion.trajectory import STEP
from kinesic.planning.plan import Plan

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
    for name, peak in check_limits(after, known().limits).shares.items():
        assert peak.ratios.max() <= 1.001, name


@settings(max_examples=12, deadline=None)
@given(st.floats(0.0, 1.0), st.floats(0.0, 1.0))
def test_stops_at_random_and_stops_while_stopping(first, second):
    motion = planned(0).trajectory
    time = first * motion.duration
    halted = stop(motion, time, known().limits)
    check(motion, halted, cut_knot(motion, time))
    begin = cut_knot(motion, time) * STEP
    again = begin + second * (halted.duration - begin)
    check(halted, stop(halted, again, known().limits), cut_knot(halted, again))
