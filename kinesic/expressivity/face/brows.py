"""Brows raised on accents of a speech."""

from collections.abc import Iterable, Mapping

import numpy as np

from kinesic.body.action_units import unit_channels
from kinesic.body.arrays import Floats
from kinesic.expressivity.face.expressions import Envelope
from kinesic.expressivity.prosody import Accent
from kinesic.expressivity.style.style import NEUTRAL_EXPRESSIVITY, Expressivity

RISE_TIME = 0.16  # [s] time in which the brows rise to an accent
HOLD_TIME = 0.10  # [s] time for which the brows stay raised
FALL_TIME = 0.35  # [s] time in which the brows return from the accent to rest
BROW_UNITS = {1: 0.9, 2: 1.0}  # action unit -> intensity relative to that of the accent


def brow_units(
    accents: Iterable[Accent],
    times: Floats,
    *,
    start: float,
    amount: float,
    manner: Expressivity = NEUTRAL_EXPRESSIVITY,
) -> Mapping[str, Floats]:
    """Convert accents to action units of the brows at (m,) times [s].

    Args:
        accents: of the speech.
        times: (m,) [s].
        start: of the speech, on the same clock [s].
        amount: 0 none .. 1 like a person's.
        manner: expressivity of the face.

    Returns:
        Key of Command.face -> (m,), at least 0; empty without raised brows.
    """
    raised = np.zeros(len(times))
    for accent in accents:
        if accent.brow > 0.0:
            peak = start + accent.time
            envelope = Envelope(peak - RISE_TIME, peak, peak + HOLD_TIME, peak + HOLD_TIME + FALL_TIME)
            np.maximum(raised, amount * accent.brow * envelope.at(times, manner), out=raised)
    if not raised.any():
        return {}
    return {channel: ratio * raised for unit, ratio in BROW_UNITS.items() for channel in unit_channels(unit)}
