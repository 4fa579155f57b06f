"""Time shift from the stroke of a clip to the stroke of the planned motion."""

import numpy as np
import pytest

from kinesic.bench.capture.marker_shift import measure_stroke_shift
from kinesic.body.arrays import Floats, sealed
from kinesic.body.robot import Side
from kinesic.capture.clip import ArmPath

TIMES = np.arange(300) / 100.0  # [s]


def swing(peak: float) -> dict[Side, ArmPath]:
    """Return arm paths whose right wrist moves fastest at the given time [s]."""
    away = 0.5 / (1.0 + np.exp(-(TIMES - peak) / 0.08))
    still = np.zeros((300, 3))
    wrist = np.tile([0.5, 0.0, 0.0], (300, 1))
    return {
        "l": ArmPath(sealed(still), sealed(wrist)),
        "r": ArmPath(sealed(still), sealed(wrist + np.outer(away, [0.0, 0.0, 1.0]))),
    }


@pytest.mark.parametrize("shift", [-0.2, 0.0, 0.03, 0.25])
def test_stroke_shift_of_a_later_planned_stroke_is_positive(shift: float):
    assert measure_stroke_shift(1.5, swing(1.4), swing(1.4 + shift), TIMES) == pytest.approx(shift, abs=0.011)


def test_stretched_preparation_of_a_clip_shifts_its_stroke():
    slower: Floats = np.interp(TIMES, [0.0, 1.0, 3.0], [0.0, 1.2, 3.2])  # the first second takes 1.2 s
    assert measure_stroke_shift(1.5, swing(1.4), swing(1.4), slower + 0.5) == pytest.approx(0.2, abs=0.011)


def test_clip_without_motion_at_its_stroke_marker_has_no_stroke_shift():
    assert measure_stroke_shift(2.7, swing(0.5), swing(0.5), TIMES) is None
