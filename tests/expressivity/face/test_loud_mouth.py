"""Mouth of a robot that speaks with a sound of known loudness."""

import numpy as np
import pytest

from kinesic.expressivity.face.loud_mouth import MOUTH_UNITS, mouth_units
from kinesic.expressivity.face.opening import MAX_LIP_VELOCITY, lip_opening


def bumps(*centres: float) -> np.ndarray:
    times = np.arange(400) / 100
    return sum(0.1 * np.exp(-(((times - centre) / 0.05) ** 2)) for centre in centres)


def test_mouth_is_closed_in_silence_and_opens_with_the_level_no_faster_than_lips_move():
    units = mouth_units(bumps(1.0, 2.0), 0.1, step=0.01)
    assert set(units) == set(MOUTH_UNITS)
    assert units["26"][100] == pytest.approx(MOUTH_UNITS["26"], rel=0.2)
    assert all(values[150] < 0.01 for values in units.values())
    openings = [lip_opening({unit: values[k] for unit, values in units.items()}) for k in range(400)]
    assert np.abs(np.diff(openings)).max() <= 1.01 * MAX_LIP_VELOCITY * 0.01


def test_mouth_opens_less_for_a_sound_below_the_highest_level():
    soft, loud = (mouth_units(bumps(1.0), highest, step=0.01)["26"].max() for highest in (0.5, 0.1))
    assert 0.3 * loud < soft < 0.7 * loud


def test_mouth_of_no_levels_has_no_units():
    assert mouth_units(np.zeros(0), 0.1, step=0.01) == {}
