"""Alignment of estimated phonemes and marks with a recording's audible parts."""

from bisect import bisect_right
from collections.abc import Callable, Iterator, Sequence
from itertools import pairwise

import numpy as np

from kinesic.body.utterance import Phoneme, Sound

WINDOW_DURATION = 0.01  # [s] duration of the windows in which a recording's amplitude is measured
AUDIBLE_RATIO = 0.03  # audibility threshold (-30 dB): amplitude of a window / loud amplitude of the recording
LOUD_PERCENTILE = 99  # percentile of the windows' amplitudes that counts as loud
MAX_BRIDGED_GAP = 0.12  # [s] longest silence within a word, such as before a plosive
MIN_AUDIBLE_TIME = 0.05  # [s] with less audible time between two anchors, sounds fill the whole time between them

Span = tuple[float, float]  # begin and end [s]


def find_audible_spans(sound: Sound) -> tuple[Span, ...]:
    """Return the audible spans [s] of a recording, bridging short gaps."""
    size = max(round(WINDOW_DURATION * sound.rate), 1)
    count = len(sound.samples) // size
    if not count:
        return ()
    windows = sound.samples[: count * size].reshape(count, size)
    amplitudes = np.maximum(windows.max(axis=1), -windows.min(axis=1))
    loud = float(np.percentile(amplitudes, LOUD_PERCENTILE)) or float(amplitudes.max())
    is_audible = np.concatenate([[False], amplitudes > AUDIBLE_RATIO * loud, [False]])
    edges = np.flatnonzero(np.diff(is_audible.astype(np.int8))) * size / sound.rate
    spans: list[Span] = []
    for begin, end in edges.reshape(-1, 2).tolist():
        if spans and begin - spans[-1][1] <= MAX_BRIDGED_GAP:
            spans[-1] = (spans[-1][0], end)
        else:
            spans.append((begin, end))
    return tuple(spans)


def align_phonemes(
    phonemes: Sequence[Phoneme], anchors: Sequence[Span], audible: Sequence[Span]
) -> tuple[tuple[Phoneme, ...], Callable[[float], float]]:
    """Place estimated phonemes in a recording's audible spans, between anchor times.

    Args:
        phonemes: estimated sounds, in order.
        anchors: (estimated, actual) times [s] of marks, of the start and of the end, in order.
        audible: spans of the recording [s].

    Returns:
        Phonemes at their times in the recording, and a function from estimated to actual times [s].
    """
    placed: list[Phoneme] = []
    points: list[Span] = list(anchors)
    for (begin, actual_begin), (end, actual_end) in pairwise(anchors):
        inside = [sound for sound in phonemes if begin <= sound.start + sound.duration / 2 < end]
        spans = _clip(audible, actual_begin, actual_end)
        total = sum(sound.duration for sound in inside)
        if not inside or not total:
            continue
        if sum(last - first for first, last in spans) < MIN_AUDIBLE_TIME:
            spans = [(actual_begin, actual_end)]
        for sound, start, duration in _distribute(inside, spans, total):
            placed.append(Phoneme(sound.symbol, start, duration))
            points.append((sound.start, start))
    ordered = sorted(points)
    estimated = [time for time, _ in ordered]
    actual = np.maximum.accumulate([time for _, time in ordered])
    return tuple(placed), lambda time: float(np.interp(time, estimated, actual))


def order_anchors(times: Sequence[Span], estimated_end: float, actual_end: float) -> tuple[Span, ...]:
    """Sort (estimated, actual) times [s] and add those of start and end.

    Times that contradict the order, or lie after the end, are dropped.
    """
    anchors: list[Span] = [(0.0, 0.0)]
    for estimated, actual in sorted(times):
        if estimated > anchors[-1][0] and actual_end >= actual >= anchors[-1][1]:
            anchors.append((estimated, actual))
        elif estimated == anchors[-1][0] and len(anchors) == 1:
            anchors[0] = (estimated, actual)
    return (*anchors, (max(estimated_end, anchors[-1][0]) + 1e-9, actual_end))


def _clip(spans: Sequence[Span], begin: float, end: float) -> list[Span]:
    first = max(bisect_right(spans, (begin, begin)) - 1, 0)
    clipped: list[Span] = []
    for start, stop in spans[first:]:
        if start >= end:
            break
        if min(stop, end) > max(start, begin):
            clipped.append((max(start, begin), min(stop, end)))
    return clipped


def _distribute(
    phonemes: Sequence[Phoneme], spans: Sequence[Span], total: float
) -> Iterator[tuple[Phoneme, float, float]]:
    """Yield sounds with start and duration [s], spread over audible spans."""
    ends = np.cumsum([stop - start for start, stop in spans])
    scale, spoken = float(ends[-1]) / total, 0.0
    for sound in phonemes:
        at = min(int(np.searchsorted(ends, scale * spoken + 1e-9, side="right")), len(spans) - 1)
        start = spans[at][1] - (float(ends[at]) - scale * spoken)
        yield sound, start, max(min(scale * sound.duration, spans[at][1] - start), 0.0)
        spoken += sound.duration
