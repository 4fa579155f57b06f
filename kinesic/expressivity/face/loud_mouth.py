"""Mouth motion from the loudness of a speech sound."""

from math import inf

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.expressivity.face.opening import limit_lip_opening

SOFTEST_LEVEL = 0.005  # smallest highest level of a speech, for samples in -1..1
OPEN_RANGE = 26.0  # [dB] range of levels below the highest in which the mouth opens
MOUTH_SMOOTHING = 0.03  # [s] half width of the moving average of the mouth's opening
MOUTH_UNITS = {"25": 0.7, "26": 0.45}  # action units of a fully opened mouth, with intensities 0..1


def mouth_units(levels: Floats, highest: float, *, step: float) -> dict[str, Floats]:
    """Return the mouth action units (m,) for loudness levels (m,).

    Args:
        levels: levels of the sound.
        highest: level at which the mouth is fully open.
        step: time between two levels [s].
    """
    if not len(levels):
        return {}
    decibels = 20.0 * np.log10(np.maximum(levels, 1e-9) / max(SOFTEST_LEVEL, highest))
    opening = np.clip(1.0 + decibels / OPEN_RANGE, 0.0, 1.0)
    width = 2 * round(MOUTH_SMOOTHING / step) + 1
    smooth = np.convolve(opening, np.full(width, 1.0 / width), mode="same")[: len(levels)]
    units = {unit: value * smooth for unit, value in MOUTH_UNITS.items()}
    limit_lip_opening(units, np.full(len(levels), inf), step)
    return units
