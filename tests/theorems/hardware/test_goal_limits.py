"""Limited goals keep range, speed and acceleration for any input."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from kinesic.hardware.supervisor.goal_limits import GoalBounds, GoalCourse, limit_goals

from ...examples import examples

TIME_STEP = 0.01  # [s] period of the goals
wishes = st.lists(st.floats(-1e5, 1e5), min_size=1, max_size=60)


@given(
    wishes, st.floats(0, 4095), st.floats(100, 1e4), st.floats(20, 600), st.lists(st.floats(-5000, 9000), max_size=5)
)
@examples(200)
def test_limited_servo_goals_form_a_continuous_motion_within_limits(
    wanted: list[float], start: float, speed: float, lead: float, present: list[float]
):
    bounds = GoalBounds(np.array([0.0]), np.array([4095.0]), np.array([speed]), np.array([lead]))
    course = GoalCourse.still(np.array([start]))
    for k, wish in enumerate(wanted):
        here = np.array([present[k % len(present)] if present else np.nan])
        after, _ = limit_goals(course, np.array([wish]), here, TIME_STEP, bounds)
        assert -1e-6 <= after.goals[0] <= 4095.0 + 1e-6
        assert abs(after.goals[0] - course.goals[0]) <= speed * TIME_STEP * (1 + 1e-5)
        assert abs(after.velocities[0] - course.velocities[0]) <= bounds.acceleration[0] * TIME_STEP * (1 + 1e-5)
        course = after
