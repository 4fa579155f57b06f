"""Blinks: random, with wide gaze shifts, and at breakpoints of speech.

Random blinks are 4 s apart on average (A. R. Bentivoglio et al., Analysis of blink rate patterns in normal subjects,
Movement Disorders 1997, has 17 in a minute at rest). Others occur with wide gaze shifts, at the beginning of speech
(W. S. Condon and W. D. Ogston, A segmentation of behavior, J. Psychiatric Research 1967) and at the ends of its
phrases. Their lengths vary (K. A. VanderWerf et al., Eyelid movements, J. Neurophysiology 2003).
"""

from collections.abc import Mapping, Sequence
from math import radians

import numpy as np

from kinesic.body.action_units import unit_channels
from kinesic.body.arrays import Floats
from kinesic.expressivity.face.eyes import GazeDirection
from kinesic.motion.easing import ease

CLOSING_TIMES = 0.06, 0.09  # [s] range of the random closing time of the lids in a blink
CLOSED_TIMES = 0.01, 0.06  # [s] range of the random time that the lids stay closed in a blink
OPENING_TIMES = 0.10, 0.22  # [s] range of the random opening time of the lids in a blink
MIN_BLINK_INTERVAL = 1.2  # [s] shortest time between two blinks
MEAN_BLINK_INTERVAL = 4.0  # [s] mean time between two random blinks, before the longest ones are shortened
MAX_BLINK_INTERVAL = 6.0  # [s] longest time between two random blinks
RANDOM_BLINK_DISTANCE = 2.2  # [s] shortest time between a random blink and one caused by gaze or speech
BLINK_WINDOW = 9.0  # [s] time that contains at most `MAX_WINDOW_BLINKS`
MAX_WINDOW_BLINKS = 3  # largest number of blinks in `BLINK_WINDOW`, 20 in a minute
BLINK_ANGLE = radians(20)  # [rad] gazes farther than this from straight ahead begin and end with a blink


def blink_times(
    span: tuple[float, float], looks: Sequence[GazeDirection], seed: int, *, also: Sequence[float] = ()
) -> tuple[float, ...]:
    """Choose the start times of blinks [s], in order.

    They are at least `MIN_BLINK_INTERVAL` apart, and at most 20 in a minute; those with a cause have precedence.

    Args:
        span: begin and end [s]; a longer one has the same blinks and more.
        looks: gaze directions.
        seed: of the random generator.
        also: other times that cause a blink [s].
    """
    generator = np.random.default_rng((seed, 1))
    wide_shifts = [time for look in looks if look.angle > BLINK_ANGLE for time in (look.start, look.end)] + [*also]
    caused = _keep_rate_limits([time for time in sorted(wide_shifts) if span[0] <= time < span[1]])
    required, candidates = np.array(caused), list(caused)
    time = span[0] + _draw_blink_interval(generator) - MIN_BLINK_INTERVAL
    while time < span[1]:
        if not np.any(np.abs(required - time) < RANDOM_BLINK_DISTANCE):
            candidates.append(time)
        time += _draw_blink_interval(generator)
    return tuple(_keep_rate_limits(sorted(candidates)))


def blink_units(begins: Sequence[float], times: Floats, seed: int = 0) -> Mapping[str, Floats]:
    """Convert blink start times to action units at (m,) times [s].

    Args:
        begins: start times of blinks in order [s].
        times: (m,) [s].
        seed: of the random durations; those of the first blinks do not depend on later ones.

    Returns:
        Key of Command.face -> (m,) 0..1.
    """
    generator = np.random.default_rng((seed, 4))
    closed = np.zeros(len(times))
    for begin in begins:
        closing, pause, opening = (
            float(generator.uniform(*limits)) for limits in (CLOSING_TIMES, CLOSED_TIMES, OPENING_TIMES)
        )
        elapsed = times - begin
        shut = ease("minimum_jerk", elapsed / closing)
        open_again = ease("minimum_jerk", (elapsed - closing - pause) / opening)
        np.maximum(closed, shut - open_again, out=closed)
    return dict.fromkeys(unit_channels(45), closed)


def _draw_blink_interval(generator: np.random.Generator) -> float:
    """Return a random interval [s] from one blink to the next."""
    interval = MIN_BLINK_INTERVAL + float(generator.exponential(MEAN_BLINK_INTERVAL - MIN_BLINK_INTERVAL))
    return min(interval, MAX_BLINK_INTERVAL)


def _keep_rate_limits(ordered: Sequence[float]) -> list[float]:
    """Omit blinks that exceed the rate limits."""
    kept: list[float] = []
    for time in ordered:
        recent = kept[-MAX_WINDOW_BLINKS:]
        is_frequent = len(recent) == MAX_WINDOW_BLINKS and time - recent[0] < BLINK_WINDOW
        if not is_frequent and (not kept or time - kept[-1] >= MIN_BLINK_INTERVAL):
            kept.append(time)
    return kept
