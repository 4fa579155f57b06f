"""Measures of hand motion in one gesture.

Speeds by phase, flow, units and smoothness.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from kinesic.body.arrays import Flags, Floats
from kinesic.metrics.smoothness import spectral_arc_length
from kinesic.studies.sweep.geometry import length

PROFILE_RATE = 30.0  # [Hz] rate to which captured and planned motion is resampled
PROFILE_PERIOD = 1.0 / PROFILE_RATE  # [s] interval between samples of a speed profile
MIN_PEAK_RATIO = 0.1  # smallest peak speed of a movement unit / largest speed
MAX_DIP_RATIO = 0.5  # largest ratio of the minimum speed between two movement units to the lower peak
ONSET_RATIO = 0.05  # speed at which a preparation starts / largest speed before strokeStart
MIN_PREPARATION_TIME = 0.2  # [s] shortest preparation whose smoothness is measured
STILL_SPEED = 1e-3  # [arm lengths/s] speed below which a hand counts as still
TIME_ROUNDING = 1e-3  # [s] rounding error of times in files


@dataclass(frozen=True)
class GestureMeasures:
    """Motion of the hand with the longer path in one gesture.

    Values are None if phases are unknown or too short.
    """

    duration: float  # [s] time from start to end
    stroke_time: float | None  # [s] time from strokeStart to strokeEnd
    hold_time: float | None  # [s] time from strokeEnd to relax
    return_time: float | None  # [s] time from relax to end
    largest_speed: float  # [arm lengths/s] largest speed
    preparation_speed: float | None  # [arm lengths/s] largest speed before strokeStart
    stroke_speed: float | None  # [arm lengths/s] largest speed during the stroke
    return_speed: float | None  # [arm lengths/s] largest speed during the return
    flow: float | None  # speed at strokeStart / largest speed before strokeEnd
    lead: float | None  # [s] time from the largest speed between ready and strokeEnd to the stroke
    units: int  # number of movement units
    sparc: float | None  # spectral arc length of the speed, more negative if rougher
    preparation_sparc: float | None  # spectral arc length of the preparation's speed
    path: float  # [m] path length of the wrist relative to the chest
    arm_lengths: float  # [arm lengths] path length of the wrist relative to the chest
    stroke_path: float | None  # [arm lengths] path during the stroke

    @property
    def units_per_second(self) -> float:
        """Movement units per second [1/s]."""
        return self.units / self.duration

    @property
    def stroke_to_preparation(self) -> float | None:
        """Largest speed of the stroke / largest speed of the preparation."""
        return ratio(self.stroke_speed, self.preparation_speed)

    @property
    def return_to_preparation(self) -> float | None:
        """Largest speed of the return / largest speed of the preparation."""
        return ratio(self.return_speed, self.preparation_speed)


def ratio(value: float | None, other: float | None) -> float | None:
    """Return value / other, None if missing or divided by zero."""
    return value / other if value is not None and other else None


def measure_hand(times: Floats, path: Floats, syncs: Mapping[str, float], arm: float) -> GestureMeasures:
    """Measure the motion of one hand in one gesture.

    Args:
        times: times of the samples (m,) [s].
        path: positions of the wrist relative to the chest (m, 3) [m].
        syncs: times of sync points [s]; `start` and `end` are required, others optional.
        arm: arm length from shoulder to wrist [m].
    """
    speeds = np.linalg.norm(np.gradient(path, times, axis=0), axis=1) / arm
    profile = _Profile(times, np.where(speeds < STILL_SPEED, 0.0, speeds), syncs)
    whole, stroke = profile.samples("start", "end"), profile.samples("strokeStart", "strokeEnd")
    resampled = profile.resampled("start", "end")
    return GestureMeasures(
        duration=syncs["end"] - syncs["start"],
        stroke_time=profile.time("strokeStart", "strokeEnd"),
        hold_time=profile.time("strokeEnd", "relax"),
        return_time=profile.time("relax", "end"),
        largest_speed=float(profile.speeds[whole].max()),
        preparation_speed=profile.largest("start", "strokeStart"),
        stroke_speed=profile.largest("strokeStart", "strokeEnd"),
        return_speed=profile.largest("relax", "end"),
        flow=_flow(profile),
        lead=_lead(profile),
        units=count_units(resampled),
        sparc=spectral_arc_length(resampled, period=PROFILE_PERIOD),
        preparation_sparc=_measure_preparation_smoothness(profile.resampled("start", "strokeStart")),
        path=length(path[whole]),
        arm_lengths=length(path[whole]) / arm,
        stroke_path=length(path[stroke]) / arm if stroke.any() else None,
    )


def count_units(speeds: Floats) -> int:
    """Count the movement units of a hand's speed profile.

    A unit is a speed peak; between two units the speed falls below half of the lower peak.

    Args:
        speeds: speeds (m,) in any unit; peaks below a tenth of the largest speed do not count.
    """
    rising = np.concatenate([[True], speeds[1:] > speeds[:-1]])
    falling = np.concatenate([speeds[:-1] >= speeds[1:], [True]])
    peaks = np.flatnonzero(rising & falling & (speeds > MIN_PEAK_RATIO * speeds.max(initial=0.0)))
    kept: list[int] = []
    for peak in peaks.tolist():
        if not kept or speeds[kept[-1] : peak].min() < MAX_DIP_RATIO * min(speeds[kept[-1]], speeds[peak]):
            kept.append(peak)
        elif speeds[peak] > speeds[kept[-1]]:
            kept[-1] = peak
    return len(kept)


@dataclass(frozen=True, eq=False)
class _Profile:
    """Speed profile of one hand with the gesture's sync points."""

    times: Floats  # (m,) [s]
    speeds: Floats  # (m,) [arm lengths/s]
    syncs: Mapping[str, float]  # sync point -> time [s]

    def time(self, begin: str, end: str) -> float | None:
        """Return the time [s] between two of a gesture's sync points.

        The result is None if one is missing.
        """
        is_complete = begin in self.syncs and end in self.syncs
        return self.syncs[end] - self.syncs[begin] if is_complete else None

    def samples(self, begin: str, end: str) -> Flags:
        """Return the mask (m,) of samples between two sync points.

        All samples are False if one of the points is missing.
        """
        first, last = self.syncs.get(begin, np.inf), self.syncs.get(end, -np.inf)
        within: Flags = (self.times >= first - TIME_ROUNDING) & (self.times <= last + TIME_ROUNDING)
        return within

    def largest(self, begin: str, end: str) -> float | None:
        """Return the hand's largest speed between two sync points [arm lengths/s].

        The result is None if one is missing.
        """
        within = self.speeds[self.samples(begin, end)]
        return float(within.max()) if within.size else None

    def resampled(self, begin: str, end: str) -> Floats:
        """Return hand speeds (k,) between two sync points, resampled at `PROFILE_RATE`."""
        if self.time(begin, end) is None:
            return np.empty(0)
        times = np.arange(self.syncs[begin], self.syncs[end] + TIME_ROUNDING, 1.0 / PROFILE_RATE)
        speeds: Floats = np.interp(times, self.times, self.speeds)
        return speeds


def _measure_preparation_smoothness(speeds: Floats) -> float | None:
    """Return the spectral arc length of a preparation from motion onset.

    The result is None if it is shorter than `MIN_PREPARATION_TIME`.
    """
    moving = speeds[int((speeds > ONSET_RATIO * speeds.max(initial=0.0)).argmax()) :] if speeds.size else speeds
    return (
        spectral_arc_length(moving, period=PROFILE_PERIOD)
        if len(moving) > MIN_PREPARATION_TIME * PROFILE_RATE
        else None
    )


def _flow(profile: _Profile) -> float | None:
    largest = profile.largest("start", "strokeEnd")
    if not largest or "strokeStart" not in profile.syncs:
        return None
    return float(np.interp(profile.syncs["strokeStart"], profile.times, profile.speeds)) / largest


def _lead(profile: _Profile) -> float | None:
    within = np.flatnonzero(profile.samples("ready", "strokeEnd"))
    if not within.size or "stroke" not in profile.syncs:
        return None
    return profile.syncs["stroke"] - float(profile.times[within[profile.speeds[within].argmax()]])
