"""Properties of the conversion of angles to ticks."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from kinesic.body.servo import TICKS_PER_RADIAN
from kinesic.hardware.protocol.ticks import Scale

# servo revolutions per hinge revolution, negative if reversed
TURN_SCALES = st.floats(0.5, 10.0) | st.floats(-10.0, -0.5)
ZERO_TICKS = st.integers(0, 4095)  # [ticks] servo position at hinge angle 0


@given(ZERO_TICKS, TURN_SCALES, st.floats(-np.pi, np.pi))
def test_angle_converted_to_servo_ticks_and_back_differs_by_at_most_half_a_tick(zero: int, turns: float, angle: float):
    line = Scale(np.array([float(zero)]), np.array([turns]))
    back = line.angles(line.ticks(np.array([angle])))
    assert abs(back[0] - angle) <= 0.5 / (abs(turns) * TICKS_PER_RADIAN) + 1e-12


@given(ZERO_TICKS, TURN_SCALES)
def test_servo_ticks_converted_to_angles_and_back_are_unchanged(zero: int, turns: float):
    line = Scale(np.array([float(zero)]), np.array([turns]))
    every = np.arange(4096)[:, None]
    assert (line.ticks(line.angles(every)) == every).all()


@given(ZERO_TICKS, TURN_SCALES, st.floats(-np.pi, np.pi), st.floats(0.0, np.pi))
def test_tick_direction_follows_the_sign_of_the_servo_scale(zero: int, turns: float, angle: float, step: float):
    line = Scale(np.array([float(zero)]), np.array([turns]))
    change = line.ticks(np.array([angle + step])) - line.ticks(np.array([angle]))
    assert change[0] * np.sign(turns) >= 0
