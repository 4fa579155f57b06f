"""Dynamic time warping between the frames of recording and rendition.

A silence of the recording can only lie between two words: a rendition has an optional gap before each word, which
only silence may fill. A coarse path over averaged frames is found first, and limits the search of the fine path.
"""

from dataclasses import dataclass

import numpy as np

from kinesic.body.arrays import Flags, Floats, Indices, find_runs

COARSE_FRAMES = 4  # number of frames averaged into one frame of the coarse alignment
COARSE_RADIUS = 600  # [coarse frames] largest distance of the coarse path from a path of constant rate
FINE_RADIUS = 100  # [frames] largest distance of the fine path from the coarse path
SILENCE_FRAMES = 4  # [frames] length to which each silence is set before the alignment
GAP_COST = 7.5  # cost of speech in a gap between words; two unrelated frames cost about 6
SILENCE_COST = 10.0  # cost of silence that falls into a word
RATE_COST = 1.7  # cost of a frame at which the recording is not as fast as the rendition
MIN_FRAMES = 2  # fewest speech frames of a recording or rendition that is warped


@dataclass(frozen=True, eq=False)
class FrameSequence:
    """Features of successive frames, with a mask of speech frames."""

    features: Floats  # (n, k) features of each frame
    is_speech: Flags  # (n,) whether each frame has speech


@dataclass(frozen=True, eq=False)
class Warp:
    """Time alignment of a recording with a synthesised rendition, by frame."""

    word_frames: Indices  # (words,) first frame of each word in the recording
    frames: Indices  # (m,) frames of the recording with speech, increasing
    rendition_frames: Floats  # (m,) frame of the rendition for each of `frames`, not decreasing


def warp(recording: FrameSequence, rendition: FrameSequence, word_frames: Indices) -> Warp | None:
    """Align the frames of a recording with those of a synthesised rendition.

    Args:
        recording: frames of the recording.
        rendition: frames of the same words as spoken by a voice.
        word_frames: first frame of each word in the rendition, increasing.

    Returns:
        None if the recording or the rendition has fewer than `MIN_FRAMES` frames with speech.
    """
    spoken = np.flatnonzero(rendition.is_speech)
    speech_count = int(np.count_nonzero(recording.is_speech))
    if min(speech_count, len(spoken)) < MIN_FRAMES:
        return None
    frames, is_silent = _shorten_silences(recording.is_speech)
    positions = np.linspace(0.0, len(spoken) - 1.0, speech_count)  # of the rendition at the rate of the recording
    around = rendition.features[spoken]
    stretched = np.stack([np.interp(positions, np.arange(len(spoken)), column) for column in around.T], axis=1)
    times = np.interp(positions, np.arange(len(spoken)), spoken.astype(float))
    begins = np.searchsorted(times, word_frames.astype(float) - 1e-9)
    columns = np.insert(np.arange(len(times)), np.append(begins, len(times)), -1)  # -1: the gap before a word
    path = _find_path(recording.features[frames], is_silent, stretched, columns)
    starts = np.flatnonzero(columns < 0)[:-1] + 1
    first = np.minimum(np.searchsorted(path, starts), len(path) - 1)
    following = np.append(np.flatnonzero(~is_silent), np.flatnonzero(~is_silent)[-1])
    first = following[np.minimum(np.searchsorted(following[:-1], first), len(following) - 1)]
    heard = ~is_silent & (columns[path] >= 0)
    return Warp(frames[first], frames[heard], np.maximum.accumulate(times[columns[path[heard]]]))


def _shorten_silences(is_speech: Flags) -> tuple[Indices, Flags]:
    """Return frame indices with shortened silences, and their silence mask."""
    pieces: list[Indices] = []
    silent: list[Flags] = []
    for values, is_silence in ((is_speech, False), (~is_speech, True)):
        for begin, end in find_runs(values):
            frames = np.full(SILENCE_FRAMES, begin) if is_silence else np.arange(begin, end)
            pieces.append(frames)
            silent.append(np.full(len(frames), is_silence))
    order = np.argsort([piece[0] for piece in pieces])
    return np.concatenate([pieces[k] for k in order]), np.concatenate([silent[k] for k in order])


def _find_path(rows: Floats, is_silent: Flags, stretched: Floats, columns: Indices) -> Indices:
    """Return each row's column in the stretched rendition, at least cost.

    Args:
        rows: features of the recording.
        is_silent: rows without speech.
        stretched: features of the rendition.
        columns: index into `stretched` of each column, -1 for gaps.
    """
    coarse_rows, coarse_columns = _average(rows), _average(stretched)
    straight = np.linspace(0, len(coarse_columns) - 1, len(coarse_rows))
    places = np.flatnonzero(columns >= 0)  # column of each frame of the rendition
    has_gap = np.zeros(len(coarse_columns), dtype=bool)
    has_gap[
        np.clip(
            (np.flatnonzero(columns < 0) - np.arange(len(columns) - len(places))) // COARSE_FRAMES, 0, len(has_gap) - 1
        )
    ] = True
    coarse = _search(
        (coarse_rows, np.logical_and.reduceat(is_silent, np.arange(0, len(rows), COARSE_FRAMES))),
        (coarse_columns, has_gap, np.zeros(len(has_gap), dtype=bool)),
        _window(straight, COARSE_RADIUS, len(coarse_columns)),
    )
    middles = COARSE_FRAMES * (np.arange(len(coarse)) + 0.5)
    centre = np.interp(np.arange(len(rows)), middles, COARSE_FRAMES * (coarse + 0.5))
    others = stretched[np.maximum(columns, 0)]
    centre_columns = np.interp(centre, np.arange(len(places)), places)
    return _search(
        (rows, is_silent), (others, columns < 0, columns < 0), _window(centre_columns, FINE_RADIUS, len(columns))
    )


def _average(rows: Floats) -> Floats:
    """Average rows in groups of `COARSE_FRAMES` successive frames."""
    begins = np.arange(0, len(rows), COARSE_FRAMES)
    counts = np.diff(np.append(begins, len(rows)))
    averaged: Floats = np.add.reduceat(rows, begins, axis=0) / counts[:, None]
    return averaged


def _window(centre: Floats, radius: int, count: int) -> tuple[Indices, Indices]:
    """Return the first and last column that each row may use."""
    first = np.clip(np.floor(centre).astype(int) - radius, 0, count - 1)
    last = np.clip(np.ceil(centre).astype(int) + radius, 0, count - 1)
    first[0], last[-1] = 0, count - 1
    return np.minimum.accumulate(first[::-1])[::-1], np.maximum.accumulate(last)


def _search(
    rows: tuple[Floats, Flags], columns: tuple[Floats, Flags, Flags], window: tuple[Indices, Indices]
) -> Indices:
    """Return each row's column on the cheapest path in a window.

    From one row to the next, the path moves by 0, 1 or 2 columns.

    Args:
        rows: features, and whether the row is silent.
        columns: features, whether the column takes silence, and whether it takes nothing else.
        window: first and last column of each row.
    """
    features, is_silent = rows
    others, takes_silence, is_gap = columns
    first, last = window
    squares = (others**2).sum(axis=1)
    skip_costs = np.where(np.roll(is_gap, 1), 0.0, RATE_COST)  # a gap may be skipped
    count = len(others)
    total = np.full(count + 2, np.inf)  # of the preceding row; two columns before the first
    steps: list[Indices] = []
    for k, row in enumerate(features):
        begin, end = int(first[k]), int(last[k]) + 1
        if is_silent[k]:
            cost = np.where(takes_silence[begin:end], 0.0, SILENCE_COST)
        else:
            squared = squares[begin:end] - 2.0 * (others[begin:end] @ row) + row @ row
            cost = np.where(is_gap[begin:end], GAP_COST, np.sqrt(np.maximum(squared, 0.0)))
        following = np.full(count + 2, np.inf)
        if k == 0:
            following[2:4] = cost[:2]
            steps.append(np.zeros(end - begin, dtype=np.int8))
        else:
            stay = total[begin + 2 : end + 2] + RATE_COST
            skip = total[begin:end] + skip_costs[begin:end]
            best = np.minimum(stay, skip)
            move = total[begin + 1 : end + 1]
            steps.append(np.where(move <= best, 1, np.where(stay <= skip, 0, 2)).astype(np.int8))
            following[begin + 2 : end + 2] = np.minimum(best, move) + cost
        total = following
    return _trace(steps, first, total)


def _trace(steps: list[Indices], first: Indices, total: Floats) -> Indices:
    """Follow the steps of the cheapest path back from its end."""
    count = len(total) - 2
    column = count - 1 if total[-1] <= total[-2] else count - 2
    path = np.zeros(len(steps), dtype=int)
    for k in range(len(steps) - 1, -1, -1):
        column = min(max(column, int(first[k])), int(first[k]) + len(steps[k]) - 1)
        path[k] = column
        column -= int(steps[k][column - first[k]])
    return path
