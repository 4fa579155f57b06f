"""Gesture markers of captured motion, found at minima of the wrist velocity."""

from collections.abc import Mapping

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.capture.clip import BodyClip
from kinesic.capture.resampling import resample_times, smooth_paths
from kinesic.capture.robot_motion import SAMPLE_RATE
from kinesic.expressivity.lexicon.captured_form import MARKER_NAMES

MIN_VELOCITY = 0.02  # [arm lengths/s] largest wrist velocity below which a clip is motionless
PEAK_PROMINENCE = 0.15  # prominence / largest velocity, below which a velocity peak is noise
PEAK_HEIGHT = 0.3  # height / largest velocity, below which the first velocity peak belongs to the idle motion
MINIMUM_PROMINENCE = 0.05  # prominence / largest velocity, below which a velocity minimum is noise
STROKE_START_RATIO = 0.7  # velocity at strokeStart / velocity of the peak before the stroke
STROKE_RATIO = 0.3  # largest velocity of the minimum at the stroke / velocity of the peak before it
DEPARTURE_RATIO = 0.1  # velocity at which a hand leaves a hold / velocity of the following peak
ONSET_RATIO = 0.05  # velocity at which the preparation starts / velocity of its peak
NO_MINIMUM_DELAY = 0.3  # [s] time from the peak to the stroke if no velocity minimum follows the peak


def gesture_markers(clip: BodyClip) -> tuple[Mapping[str, float], bool]:
    """Return a gesture clip's markers [s], and whether its motion determines them.

    Markers of the file are used where it has a stroke; others are found in the motion. All are in order.
    """
    found = find_markers(clip)
    is_found = "stroke" not in clip.syncs
    times: Mapping[str, float] = {**found, **({} if is_found else clip.syncs)}
    if not is_found:
        times = _order_around_stroke(times, float(clip.times[-1]))
    return times, is_found


def find_markers(clip: BodyClip) -> Mapping[str, float]:
    """Find the markers [s] of a gesture clip by wrist velocity.

    The stroke is the first velocity minimum after the first large peak.
    """
    from scipy.signal import find_peaks  # noqa: PLC0415 - slow import, not needed where files have markers

    times = resample_times(clip.times)
    velocity = wrist_velocity(clip, times)
    largest = float(velocity.max())
    if largest < MIN_VELOCITY:
        middle = float(times[-1]) / 2.0
        return {**dict.fromkeys(MARKER_NAMES, middle), "start": 0.0, "end": float(times[-1])}
    peaks = find_peaks(velocity, prominence=PEAK_PROMINENCE * largest)[0]
    high = peaks[velocity[peaks] >= PEAK_HEIGHT * largest]
    peak = int(high[0]) if len(high) else int(velocity.argmax())
    minima = find_peaks(-velocity, prominence=MINIMUM_PROMINENCE * largest)[0]
    rests = [int(k) for k in minima if k > peak and velocity[k] < STROKE_RATIO * velocity[peak]]
    stroke = rests[0] if rests else min(peak + round(NO_MINIMUM_DELAY * SAMPLE_RATE), len(times) - 1)
    later = [int(k) for k in peaks if k > stroke]
    stroke_end = _departure(velocity, later[0], stroke) if later else stroke
    relax = max(stroke_end, _departure(velocity, later[-1], stroke)) if later else stroke
    stroke_start = _last_below(velocity, peak, STROKE_START_RATIO * velocity[peak], first=0)
    start = _last_below(velocity, peak, ONSET_RATIO * velocity[peak], first=0)
    order = (start, stroke_start, stroke_start, stroke, stroke_end, relax, len(times) - 1)
    return {name: float(times[k]) for name, k in zip(MARKER_NAMES, order, strict=True)}


def wrist_velocity(clip: BodyClip, times: Floats) -> Floats:
    """Return the velocity (m,) of the faster wrist [arm lengths/s]."""
    wrists = smooth_paths(clip.times, [arm.wrist for arm in clip.arms.values()], times)
    speeds = [np.linalg.norm(np.gradient(wrist, 1.0 / SAMPLE_RATE, axis=0), axis=1) for wrist in wrists]
    velocity: Floats = np.max(speeds, axis=0)
    return velocity


def _departure(velocity: Floats, peak: int, first: int) -> int:
    """Return the last sample before a peak at which the hand holds."""
    return _last_below(velocity, peak, DEPARTURE_RATIO * velocity[peak], first=first)


def _last_below(velocity: Floats, before: int, threshold: float, *, first: int) -> int:
    """Return the last sample below a velocity threshold, before a given sample."""
    below = np.flatnonzero(velocity[first:before] < threshold)
    return first + int(below[-1]) if len(below) else first


def _order_around_stroke(times: Mapping[str, float], duration: float) -> Mapping[str, float]:
    """Put the markers in order within the clip, without moving the stroke."""
    stroke = min(max(times["stroke"], 0.0), duration)
    ordered = {"stroke": stroke}
    latest = stroke
    for name in ("strokeStart", "ready", "start"):
        latest = ordered[name] = min(max(times[name], 0.0), latest)
    earliest = stroke
    for name in ("strokeEnd", "relax", "end"):
        earliest = ordered[name] = max(min(times[name], duration), earliest)
    return {name: ordered[name] for name in MARKER_NAMES}
