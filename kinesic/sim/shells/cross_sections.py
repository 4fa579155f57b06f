"""Monotone cubic interpolation of the cross-sections along a shell part."""

from dataclasses import dataclass

import numpy as np

from kinesic.body.arrays import Floats


@dataclass(frozen=True, eq=False)
class MonotoneCurve:
    """Piecewise cubic curve without overshoot (Fritsch and Butland, 1984)."""

    positions: Floats  # (k,) [m] increasing
    values: Floats  # (k, n) at these positions
    slopes: Floats  # (k, n) derivatives at these positions

    @classmethod
    def through(cls, positions: Floats, values: Floats) -> "MonotoneCurve":
        """Return the curve through at least two points.

        Inner slopes are weighted harmonic means of the chords' slopes, and zero at extrema. Two values are joined by a
        straight line.

        Args:
            positions: (k,) [m] increasing.
            values: (k, n).
        """
        lengths = np.diff(positions)[:, None]
        chords = np.diff(values, axis=0) / lengths
        if len(chords) == 1:
            return cls(positions, values, np.concatenate([chords, chords]))
        before, after = chords[:-1], chords[1:]
        weights = 2.0 * lengths[1:] + lengths[:-1], lengths[1:] + 2.0 * lengths[:-1]
        is_monotone = before * after > 0.0
        reciprocals = weights[0] / np.where(is_monotone, before, 1.0) + weights[1] / np.where(is_monotone, after, 1.0)
        slopes = np.empty_like(values)
        slopes[1:-1] = np.where(is_monotone, (weights[0] + weights[1]) / np.where(is_monotone, reciprocals, 1.0), 0.0)
        slopes[0] = _find_end_slope(lengths[0], lengths[1], chords[0], chords[1])
        slopes[-1] = _find_end_slope(lengths[-1], lengths[-2], chords[-1], chords[-2])
        return cls(positions, values, slopes)

    def at(self, positions: Floats) -> Floats:
        """Return the values (m, n) at positions (m,) [m] within the curve."""
        interval = np.searchsorted(self.positions[1:-1], positions, side="right")
        length = (self.positions[interval + 1] - self.positions[interval])[:, None]
        t = (positions - self.positions[interval])[:, None] / length
        start, end = self.values[interval], self.values[interval + 1]
        start_slope, end_slope = length * self.slopes[interval], length * self.slopes[interval + 1]
        square = 3.0 * (end - start) - 2.0 * start_slope - end_slope
        cube = 2.0 * (start - end) + start_slope + end_slope
        values: Floats = start + t * (start_slope + t * (square + t * cube))
        return values


def _find_end_slope(length: Floats, next_length: Floats, chord: Floats, next_chord: Floats) -> Floats:
    """Return the end slope (n,) of a parabola, limited against overshoot."""
    slope = ((2.0 * length + next_length) * chord - length * next_chord) / (length + next_length)
    limited = np.where((chord * next_chord < 0.0) & (np.abs(slope) > 3.0 * np.abs(chord)), 3.0 * chord, slope)
    return np.where(slope * chord > 0.0, limited, 0.0)
