from math import pi

import numpy as np
import pytest

from kinesic.hardware.protocol.ticks import Scale

ALL_TICKS = np.arange(4096)[:, None]


def scale(zero: int = 2048, turns: float = 1.0) -> Scale:
    return Scale(np.array([float(zero)]), np.array([turns]))


@pytest.mark.parametrize("turns", [1.0, -1.0, 2.0, 2.5, -2.5, 0.5])
@pytest.mark.parametrize("zero", [0, 1000, 2048, 4095])
def test_encoder_ticks_converted_to_joint_angles_and_back_are_unchanged(zero: int, turns: float):
    line = scale(zero, turns)
    assert (line.ticks(line.angles(ALL_TICKS)) == ALL_TICKS).all()


def test_quarter_turn_of_a_servo_is_1024_ticks():
    assert scale().ticks(np.array([pi / 2])) == [3072]
    assert scale(turns=-1.0).ticks(np.array([pi / 2])) == [1024]


def test_belt_reduction_scales_ticks_per_joint_angle():
    assert scale(turns=2.5).ticks(np.array([np.deg2rad(20.0)])) == [2048 + round(20 * 2.5 / 360 * 4096)]


def test_joint_angles_are_converted_to_the_nearest_encoder_tick():
    tick = 2 * pi / 4096
    assert scale().ticks(np.array([[0.4 * tick], [0.6 * tick], [-0.6 * tick]])).ravel().tolist() == [2048, 2049, 2047]


@pytest.mark.parametrize("angle", [np.nan, np.inf])
def test_conversion_of_a_non_finite_angle_to_ticks_is_refused(angle: float):
    with pytest.raises(ValueError, match="must be finite"):
        scale().ticks(np.array([angle]))
