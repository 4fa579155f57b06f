import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from kinesic.motion.double_s import least_time

LIMITS = st.tuples(st.floats(0.1, 20), st.floats(0.1, 200), st.floats(0.5, 5000))


@given(LIMITS, st.floats(0, 10), st.floats(0, 10))
def test_a_longer_way_never_takes_less(limits, one, other):
    short, long = least_time(sorted((one, other)), *limits)
    assert short <= long + 1e-12


@given(LIMITS, st.floats(1e-6, 10), st.integers(0, 2), st.floats(1, 10))
def test_more_of_any_limit_never_takes_longer(limits, way, which, factor):
    more = [limit * (factor if k == which else 1) for k, limit in enumerate(limits)]
    assert least_time(way, *more) <= least_time(way, *limits) * (1 + 1e-9)


@given(LIMITS, st.floats(1e-6, 10), st.floats(0.1, 10))
def test_a_slower_clock_stretches_it(limits, way, factor):
    speed, acceleration, jerk = limits
    slower = least_time(way, speed / factor, acceleration / factor**2, jerk / factor**3)
    np.testing.assert_allclose(slower, factor * least_time(way, *limits), rtol=1e-9)
