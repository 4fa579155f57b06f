"""Times of a rendition's words and sounds in a recording.

Words with given times keep them. The others are placed by comparing their sound with the rendition; inside a word with
given times, sounds keep their relative durations and lie in its audible parts.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from kinesic.body.arrays import Floats, Indices, find_runs
from kinesic.body.utterance import Phoneme, Sound
from kinesic.speech.recorded.activity import find_speech
from kinesic.speech.recorded.given_times import GivenTime
from kinesic.speech.recorded.rendition import Rendition
from kinesic.speech.recorded.spectrum import FRAME_PERIOD, compute_band_powers, compute_features, compute_levels
from kinesic.speech.recorded.warping import FrameSequence, warp

RENDITION_BRIDGE = 5  # [frames] longest silence inside speech of a synthesised rendition
EDGE_OFFSET = 1e-6  # [s] gap between the end of a word and the start of the next word in a rendition
PATH_STEP = 3  # [frames] between kept points of the alignment path inside a word
LONG_SILENCE = 0.3  # [s] shortest silence in which the lips return to rest
SPEECH_MARGIN = 0.08  # [s] time before and after audible speech in which a quiet sound may lie
QUIET_END = 0.15  # [s] time after audible speech for the lips of a final p, b or m
CLOSING_LETTERS = frozenset("pbm")  # phonetic letters of sounds with closed lips
MAX_LEAD_TIME = 0.05  # [s] longest time from the onset of a mouth shape to its sound

Point = tuple[float, float]  # time in the rendition and in the recording [s]


@dataclass(frozen=True, eq=False)
class SpeechFrames:
    """Levels and features of a sound's frames."""

    levels: Floats  # (n,) [dB] level of each frame
    sequence: FrameSequence

    @property
    def spans(self) -> list[tuple[float, float]]:
        """Spans with speech [s]."""
        return [(FRAME_PERIOD * a, FRAME_PERIOD * b) for a, b in find_runs(self.sequence.is_speech)]


def analyse(sound: Sound, *, bridged: int | None = None) -> SpeechFrames:
    """Compute levels and features of a sound.

    Args:
        sound: recording or rendition.
        bridged: longest silence inside speech [frames]; None: as for recordings.
    """
    powers = compute_band_powers(sound)
    levels = compute_levels(powers)
    is_speech = find_speech(levels) if bridged is None else find_speech(levels, bridged=bridged)
    features = compute_features(powers, is_speech) if len(powers) else powers
    return SpeechFrames(levels, FrameSequence(features, is_speech))


@dataclass(frozen=True, eq=False)
class Placement:
    """Map from the times of a rendition to those of a recording."""

    points: tuple[Point, ...]  # (time in the rendition, time in the recording) [s], both not decreasing
    words: tuple[tuple[float, float], ...]  # start and end of each word in the recording [s]

    def place(self, time: float) -> float:
        """Convert a time [s] in the rendition to the recording's time."""
        times, places = zip(*self.points, strict=True)
        return float(np.interp(time, times, places))


def place_words(
    rendition: Rendition, frames: SpeechFrames, given: Sequence[GivenTime], duration: float, rendered: SpeechFrames
) -> Placement:
    """Place the words of a rendition in a recording.

    Args:
        rendition: speech of the recording's text, with sound.
        frames: of the recording.
        given: given times of each word.
        duration: of the recording [s].
        rendered: frames of the rendition.
    """
    points: list[Point] = []
    spans: list[tuple[float, float]] = []
    for first, last, begin, end in _find_runs_of_words(given, duration):
        keeps_start = given[first].start is not None
        words, span = (first, last), (begin, end)
        placed = _place_by_sound(rendition, frames, rendered, words, span, keeps_start=keeps_start)
        placed = placed or _spread(rendition, frames, words, span)
        closure = _find_final_closure(rendition, last - 1)
        if given[last - 1].end is not None and closure is not None:
            placed = _extend(placed, end, closure)
        points += placed[0]
        spans += placed[1]
    return Placement(_make_monotone([(0.0, 0.0), *points], duration), tuple(spans))


def _find_runs_of_words(given: Sequence[GivenTime], duration: float) -> Iterator[tuple[int, int, float, float]]:
    """Yield index range, begin and end [s] of words between given times."""
    first, begin = 0, 0.0
    for k, time in enumerate(given):
        if time.start is not None and k > first:
            yield first, k, begin, max(begin, min(time.start, duration))
            first = k
        if time.start is not None:
            begin = min(max(begin, time.start), duration)
        if time.end is not None:
            end = max(begin, min(time.end, duration))
            yield first, k + 1, begin, end
            first, begin = k + 1, end
    if first < len(given):
        yield first, len(given), begin, duration


Placed = tuple[list[Point], list[tuple[float, float]]]


def _spread(rendition: Rendition, frames: SpeechFrames, words: tuple[int, int], span: tuple[float, float]) -> Placed:
    """Spread words over the audible parts of a span, proportional to duration."""
    begin, end = span
    audible = [(max(a, begin), min(b, end)) for a, b in frames.spans if min(b, end) > max(a, begin)] or [span]
    audible[0] = (begin, max(begin, audible[0][1]))  # a given start is kept
    starts, ends = rendition.starts[slice(*words)], rendition.ends[slice(*words)]
    spoken = np.maximum(ends - starts, 1e-3)
    before = np.concatenate([[0.0], np.cumsum(spoken)])
    lengths = np.concatenate([[0.0], np.cumsum([b - a for a, b in audible])])

    def place(part: float, *, is_end: bool) -> float:
        length = part / before[-1] * lengths[-1]
        k = int(np.searchsorted(lengths, length - 1e-9 if is_end else length + 1e-9, side="right")) - 1
        k = min(max(k, 0), len(audible) - 1)
        return audible[k][0] + float(length - lengths[k])

    points: list[Point] = []
    spans: list[tuple[float, float]] = []
    edges = [float(length / lengths[-1] * before[-1]) if lengths[-1] else 0.0 for length in lengths[1:-1]]
    for k, (start, stop) in enumerate(zip(starts, ends, strict=True)):
        inner = [edge for edge in edges if before[k] < edge < before[k + 1]]
        places = place(before[k], is_end=False), place(before[k + 1], is_end=True)
        points.append((float(start), places[0]))
        for edge in inner:
            at = float(start + edge - before[k])
            points += [(at - EDGE_OFFSET, place(edge, is_end=True)), (at, place(edge, is_end=False))]
        points.append((float(stop) - EDGE_OFFSET, places[1]))
        spans.append(places)
    return points, spans


def _place_by_sound(
    rendition: Rendition,
    frames: SpeechFrames,
    rendered: SpeechFrames,
    words: tuple[int, int],
    span: tuple[float, float],
    *,
    keeps_start: bool,
) -> Placed | None:
    """Place words in a span by sound, or return None without speech."""
    first, last = words
    offset = round(rendition.starts[first] / FRAME_PERIOD)
    end = round(rendition.ends[last - 1] / FRAME_PERIOD) + 1
    word_frames = np.round(rendition.starts[first:last] / FRAME_PERIOD).astype(int) - offset
    begin = round(span[0] / FRAME_PERIOD)
    part = _cut(frames.sequence, begin, round(span[1] / FRAME_PERIOD))
    found = warp(part, _cut(rendered.sequence, offset, end), word_frames)
    if found is None:
        return None
    times: Floats = FRAME_PERIOD * (found.frames + begin).astype(np.float64)
    spoken: Floats = FRAME_PERIOD * (found.rendition_frames + offset)
    points: list[Point] = []
    spans: list[tuple[float, float]] = []
    for k in range(first, last):
        start = FRAME_PERIOD * (int(found.word_frames[k - first]) + begin)
        if k == first and keeps_start:
            start = span[0]
        limit = rendition.starts[k + 1] if k + 1 < last else np.inf
        inside = np.flatnonzero((spoken >= rendition.starts[k] - 1e-6) & (spoken < limit - 1e-6) & (times >= start))
        stop = float(times[inside[-1]]) + FRAME_PERIOD if len(inside) else start + FRAME_PERIOD
        points.append((float(rendition.starts[k]), start))
        points += _list_path(spoken, times, inside)
        points.append((float(rendition.ends[k]) - EDGE_OFFSET, stop))
        spans.append((start, stop))
    return points, spans


def _list_path(spoken: Floats, times: Floats, inside: Indices) -> list[Point]:
    """Return every `PATH_STEP`-th point of the alignment path inside a word."""
    return [(float(spoken[k]), float(times[k])) for k in inside[PATH_STEP:-PATH_STEP:PATH_STEP]]


def _cut(sequence: FrameSequence, begin: int, end: int) -> FrameSequence:
    return FrameSequence(sequence.features[begin:end], sequence.is_speech[begin:end])


def _make_monotone(points: Sequence[Point], duration: float) -> tuple[Point, ...]:
    """Return points with increasing rendition times and non-decreasing recording times."""
    result = [points[0]]
    for time, place in points[1:]:
        limited = min(max(place, result[-1][1]), duration)
        if time > result[-1][0] + 1e-9:
            result.append((time, limited))
        elif len(result) > 1 or time <= 0.0:
            result[-1] = (result[-1][0], limited)
    return tuple(result)


def _extend(placed: Placed, end: float, closure: float) -> Placed:
    """Move the end of the last word towards its given end.

    Its final closure, which may be inaudible, then lasts from its place to that end.
    """
    (*points, (time, _)), (*spans, (start, stop)) = placed
    later = min(end, stop + QUIET_END)
    if later <= stop:
        return placed
    return [*(point for point in points if point[0] <= closure), (time, later)], [*spans, (start, later)]


def _find_final_closure(rendition: Rendition, word: int) -> float | None:
    """Return the time [s] of the lips' closure at a word's end.

    The result is None if the word ends with another sound.
    """
    start, end = rendition.starts[word], rendition.ends[word]
    inside = [sound for sound in rendition.utterance.phonemes if start <= sound.start < end]
    return inside[-1].start if inside and inside[-1].letters[:1] in CLOSING_LETTERS else None


def _join_spans(spans: Sequence[tuple[float, float]]) -> list[tuple[float, float]]:
    """Join spans with speech across short silences."""
    joined: list[tuple[float, float]] = []
    for begin, end in spans:
        if joined and begin - joined[-1][1] < LONG_SILENCE:
            joined[-1] = (joined[-1][0], end)
        else:
            joined.append((begin, end))
    return joined


def stretch_phonemes(phonemes: Sequence[Phoneme], placement: Placement, frames: SpeechFrames) -> tuple[Phoneme, ...]:
    """Return the sounds of a rendition at their times in the recording.

    Sounds in long silences are moved to the speech around them, or left out.
    """
    times, places = (np.array(values) for values in zip(*placement.points, strict=True))
    spans = _join_spans(frames.spans)
    ends = np.array([end for _, end in spans])
    placed: list[Phoneme] = []
    for sound in phonemes:
        onset, release = sound.articulation
        start, end, inner_onset, opened = np.interp(
            [sound.start, sound.end - 2 * EDGE_OFFSET, onset, release - 2 * EDGE_OFFSET], times, places
        ).tolist()
        closes = sound.letters[:1] in CLOSING_LETTERS
        k = int(np.searchsorted(ends + (QUIET_END if closes else 0.0), start + 1e-9))
        if k < len(spans):
            start = max(start, spans[k][0] - SPEECH_MARGIN)
            end = min(end, spans[k][1] + (QUIET_END if closes else SPEECH_MARGIN))
        if end <= start:
            continue
        lead = min(sound.start - onset, MAX_LEAD_TIME)  # a closure before its burst keeps its duration
        begin = start - lead if lead > 0.0 else min(max(inner_onset, start), end)
        placed.append(
            replace(sound, start=start, duration=end - start, onset=begin, release=min(max(opened, start), end))
        )
    return tuple(placed)
