import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from kinesic.motion.double_s import least_time

# velocity, acceleration and jerk limit
PROFILE_LIMITS = st.tuples(st.floats(0.1, 20), st.floats(0.1, 200), st.floats(0.5, 5000))


@given(PROFILE_LIMITS, st.floats(0, 10), st.floats(0, 10))
def test_minimum_duration_of_a_jerk_limited_motion_never_falls_with_the_distance(limits, one, other):
    short, long = least_time(sorted((one, other)), *limits)
    assert short <= long + 1e-12


@given(PROFILE_LIMITS, st.floats(1e-6, 10), st.integers(0, 2), st.floats(1, 10))
def test_higher_limits_never_increase_the_minimum_duration_of_a_jerk_limited_motion(limits, way, which, factor):
    more = [limit * (factor if k == which else 1) for k, limit in enumerate(limits)]
    assert least_time(way, *more) <= least_time(way, *limits) * (1 + 1e-9)


@given(PROFILE_LIMITS, st.floats(1e-6, 10), st.floats(0.1, 10))
def test_minimum_duration_of_a_jerk_limited_motion_scales_with_the_time_unit_of_its_limits(limits, way, factor):
    speed, acceleration, jerk = limits
    slower = least_time(way, speed / factor, acceleration / factor**2, jerk / factor**3)
    np.testing.assert_allclose(slower, factor * least_time(way, *limits), rtol=1e-9)
