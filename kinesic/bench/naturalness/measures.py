"""Measures how a hand moves in one gesture: speeds by phase, flow, movement units and spectral arc length. Pure."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from kinesic.body.arrays import Flags, Floats
from kinesic.studies.sweep.geometry import length

RATE = 30.0  # [Hz] of captured clips; units and spectra are taken at this rate
CUT = 10.0  # [Hz] up to which a spectrum is looked at
FAINT = 0.05  # of its largest amplitude, below which the end of a spectrum is left out
PADDING = 4  # times that the length of a profile is doubled, so that its spectrum is smooth
LEAST_PEAK = 0.1  # of the largest speed, that a movement unit has
DIP = 0.5  # of the lower of two peaks, below which the speed falls between two units
ONSET = 0.05  # of the largest speed before strokeStart, with which a preparation begins
LEAST_PREPARATION = 0.2  # [s] below which nothing is said of its smoothness
STILL = 1e-3  # [arm lengths/s] below which a hand stands still
ROUNDING = 1e-3  # [s] by which times of files are rounded


@dataclass(frozen=True)
class GestureMeasures:
    """How the hand that goes farther moves in one gesture; None where phases are unknown or too short."""

    duration: float  # [s]
    stroke_time: float | None  # [s] from strokeStart to strokeEnd
    hold_time: float | None  # [s] from strokeEnd to relax
    return_time: float | None  # [s] from relax to end
    largest_speed: float  # [arm lengths/s]
    preparation_speed: float | None  # [arm lengths/s] the largest before strokeStart
    stroke_speed: float | None  # [arm lengths/s] the largest of the stroke
    return_speed: float | None  # [arm lengths/s] the largest of the way back
    flow: float | None  # speed at strokeStart, as a share of the largest before strokeEnd
    lead: float | None  # [s] from the largest speed between ready and strokeEnd to the stroke
    units: int
    sparc: float | None
    preparation_sparc: float | None
    path: float  # [m]
    arm_lengths: float  # [arm lengths] the path
    stroke_path: float | None  # [arm lengths] of the stroke

    @property
    def units_per_second(self) -> float:
        """Movement units, by duration [1/s]."""
        return self.units / self.duration

    @property
    def stroke_to_preparation(self) -> float | None:
        """Largest speed of the stroke, by that of the preparation."""
        return ratio(self.stroke_speed, self.preparation_speed)

    @property
    def return_to_preparation(self) -> float | None:
        """Largest speed of the way back, by that of the preparation."""
        return ratio(self.return_speed, self.preparation_speed)


def ratio(value: float | None, other: float | None) -> float | None:
    """Divides what is known by what is known and not zero."""
    return value / other if value is not None and other else None


def measure_hand(times: Floats, path: Floats, syncs: Mapping[str, float], arm: float) -> GestureMeasures:
    """Measures one hand in one gesture.

    Args:
        times: (m,) [s] of the samples.
        path: (m, 3) [m] of the wrist, as the chest carries it.
        syncs: sync points [s], `start` and `end` among them; any other may be missing.
        arm: [m] its length from shoulder to wrist.
    """
    speeds = np.linalg.norm(np.gradient(path, times, axis=0), axis=1) / arm
    profile = _Profile(times, np.where(speeds < STILL, 0.0, speeds), syncs)
    whole, stroke = profile.samples("start", "end"), profile.samples("strokeStart", "strokeEnd")
    evenly = profile.evenly("start", "end")
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
        units=count_units(evenly),
        sparc=spectral_arc_length(evenly),
        preparation_sparc=_preparation_sparc(profile.evenly("start", "strokeStart")),
        path=length(path[whole]),
        arm_lengths=length(path[whole]) / arm,
        stroke_path=length(path[stroke]) / arm if stroke.any() else None,
    )


def count_units(speeds: Floats) -> int:
    """Counts movement units: peaks of speed, between which it falls below half of the lower one.

    Args:
        speeds: (m,) in any unit; peaks below a tenth of the largest do not count.
    """
    rising = np.concatenate([[True], speeds[1:] > speeds[:-1]])
    falling = np.concatenate([speeds[:-1] >= speeds[1:], [True]])
    peaks = np.flatnonzero(rising & falling & (speeds > LEAST_PEAK * speeds.max(initial=0.0)))
    kept: list[int] = []
    for peak in peaks.tolist():
        if not kept or speeds[kept[-1] : peak].min() < DIP * min(speeds[kept[-1]], speeds[peak]):
            kept.append(peak)
        elif speeds[peak] > speeds[kept[-1]]:
            kept[-1] = peak
    return len(kept)


def spectral_arc_length(speeds: Floats) -> float | None:
    """Measures smoothness: minus the length of the spectrum of a speed profile (SPARC, Balasubramanian 2015).

    Frequencies and amplitudes are both normalised; the spectrum ends where it stays below a twentieth of its largest
    amplitude, at most at 10 Hz. A single smooth reach has about -1.4; each stop and each tremor makes it longer.

    Args:
        speeds: (m,) at `RATE`, in any unit.

    Returns:
        The figure, None for a profile without motion or of fewer than three samples.
    """
    if len(speeds) < 3 or not speeds.any():
        return None
    count = 2 ** (int(np.ceil(np.log2(len(speeds)))) + PADDING)
    frequencies = np.fft.rfftfreq(count, 1.0 / RATE)
    amplitudes = np.abs(np.fft.rfft(speeds, count))
    amplitudes /= amplitudes.max()
    end = np.flatnonzero((frequencies <= CUT) & (amplitudes >= FAINT))[-1]
    steps = np.diff(frequencies[: end + 1]) / frequencies[end]
    return -float(np.hypot(steps, np.diff(amplitudes[: end + 1])).sum())


@dataclass(frozen=True, eq=False)
class _Profile:
    """A speed profile and its sync points."""

    times: Floats  # (m,) [s]
    speeds: Floats  # (m,) [arm lengths/s]
    syncs: Mapping[str, float]  # [s]

    def time(self, begin: str, end: str) -> float | None:
        """From one sync point to another [s]."""
        known = begin in self.syncs and end in self.syncs
        return self.syncs[end] - self.syncs[begin] if known else None

    def samples(self, begin: str, end: str) -> Flags:
        """(m,) whether a sample lies between two sync points; none does where one is missing."""
        first, last = self.syncs.get(begin, np.inf), self.syncs.get(end, -np.inf)
        within: Flags = (self.times >= first - ROUNDING) & (self.times <= last + ROUNDING)
        return within

    def largest(self, begin: str, end: str) -> float | None:
        """Largest speed between two sync points [arm lengths/s]."""
        within = self.speeds[self.samples(begin, end)]
        return float(within.max()) if within.size else None

    def evenly(self, begin: str, end: str) -> Floats:
        """(k,) speeds between two sync points, at `RATE`."""
        if self.time(begin, end) is None:
            return np.empty(0)
        places = np.arange(self.syncs[begin], self.syncs[end] + ROUNDING, 1.0 / RATE)
        speeds: Floats = np.interp(places, self.times, self.speeds)
        return speeds


def _preparation_sparc(speeds: Floats) -> float | None:
    """Smoothness from where a hand sets out, as it may have waited before."""
    moving = speeds[int((speeds > ONSET * speeds.max(initial=0.0)).argmax()) :] if speeds.size else speeds
    return spectral_arc_length(moving) if len(moving) > LEAST_PREPARATION * RATE else None


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
