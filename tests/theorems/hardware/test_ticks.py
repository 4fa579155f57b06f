"""What holds for every angle that becomes ticks."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from kinesic.body.servo import TICKS_PER_RADIAN
from kinesic.hardware.protocol.ticks import Scale

TURNS = st.floats(0.5, 10.0) | st.floats(-10.0, -0.5)
ZEROS = st.integers(0, 4095)


@given(ZEROS, TURNS, st.floats(-np.pi, np.pi))
def test_an_angle_is_off_by_half_a_tick_at_most(zero: int, turns: float, angle: float):
    line = Scale(np.array([float(zero)]), np.array([turns]))
    back = line.angles(line.ticks(np.array([angle])))
    assert abs(back[0] - angle) <= 0.5 / (abs(turns) * TICKS_PER_RADIAN) + 1e-12


@given(ZEROS, TURNS)
def test_ticks_of_the_angle_of_k_is_k(zero: int, turns: float):
    line = Scale(np.array([float(zero)]), np.array([turns]))
    every = np.arange(4096)[:, None]
    assert (line.ticks(line.angles(every)) == every).all()


@given(ZEROS, TURNS, st.floats(-np.pi, np.pi), st.floats(0.0, np.pi))
def test_direction_is_kept_or_turned_round(zero: int, turns: float, angle: float, step: float):
    line = Scale(np.array([float(zero)]), np.array([turns]))
    change = line.ticks(np.array([angle + step])) - line.ticks(np.array([angle]))
    assert change[0] * np.sign(turns) >= 0
