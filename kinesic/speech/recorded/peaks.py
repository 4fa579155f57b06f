"""Peaks and moving means of sequences of frames."""

import numpy as np

from kinesic.body.arrays import Floats, Indices


def average_frames(values: Floats, count: int) -> Floats:
    """Return moving means over an odd count of frames.

    Sequences are mirrored at their ends.

    Args:
        values: (n, ...) frames.
        count: number of frames in one mean.
    """
    mirrored = np.pad(values, [(count // 2, count // 2), *((0, 0),) * (values.ndim - 1)], mode="symmetric")
    means: Floats = np.lib.stride_tricks.sliding_window_view(mirrored, count, axis=0).mean(axis=-1)
    return means


def find_peaks(levels: Floats, *, prominence: float, distance: int = 1) -> Indices:
    """Return the frames of peaks in increasing order.

    A plateau counts as one peak in its middle. Of two close peaks the higher one is kept.

    Args:
        levels: (n,) of frames.
        prominence: least height above the higher one of the two valleys that separate a peak from higher levels, or
            from the ends.
        distance: least number of frames between two peaks.
    """
    kept: list[int] = []
    candidates, is_near = _find_maxima(levels), np.zeros(len(levels), dtype=np.bool_)
    for peak in candidates[np.argsort(-levels[candidates], kind="stable")].tolist():
        if not is_near[peak]:
            kept.append(peak)
            is_near[max(peak - distance + 1, 0) : peak + distance] = True
    return np.array([peak for peak in sorted(kept) if _measure_prominence(levels, peak) >= prominence], dtype=np.intp)


def _find_maxima(levels: Floats) -> Indices:
    """Return the middle frames of runs that are higher than both neighbours."""
    starts = np.concatenate([[0], np.flatnonzero(np.diff(levels)) + 1])
    ends = np.concatenate([starts[1:], [len(levels)]])
    runs = levels[starts]
    is_peak = np.zeros(len(runs), dtype=np.bool_)
    is_peak[1:-1] = (runs[1:-1] > runs[:-2]) & (runs[1:-1] > runs[2:])
    return np.asarray((starts + ends - 1) // 2)[is_peak]


def _measure_prominence(levels: Floats, peak: int) -> float:
    """Return a peak's height above the higher of its neighbouring valleys."""
    higher = np.flatnonzero(levels > levels[peak])
    place = int(np.searchsorted(higher, peak))
    begin = int(higher[place - 1]) if place else 0
    end = int(higher[place]) + 1 if place < len(higher) else len(levels)
    return float(levels[peak] - max(levels[begin : peak + 1].min(), levels[peak:end].min()))
