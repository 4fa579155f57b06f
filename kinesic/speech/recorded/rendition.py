"""Synthesised speech of a recording's text, to which the recording is compared."""

import re
from bisect import bisect_left
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.utterance import Mark, Script, Utterance, Voice

MIN_WORD_TIME = 0.01  # [s] shortest time from the start of a word to the next
SAME_TIME = 1e-6  # [s] tolerance for equal times
WORD_MARK_PREFIX = "kinesic-word-"  # start of the names of marks before words
_WORD_PATTERN = re.compile(r"[^\W_]+(?:['\u2019.,:-][^\W_]+)*")


@dataclass(frozen=True, eq=False)
class Rendition:
    """Speech of a text by a voice, with word times."""

    utterance: Utterance  # synthesised speech, without the marks added before words
    words: tuple[str, ...]
    starts: Floats  # (words,) [s] start of each word, increasing
    ends: Floats  # (words,) [s] end of each word's last sound
    marked_words: Mapping[str, int]  # index of the word that begins at each mark; other marks are left out


def render(script: Script, voice: Voice) -> Rendition:
    """Speak the text of a recording at the normal rate.

    Pauses of the script are left out, as the recording has its own.
    """
    places = list(_WORD_PATTERN.finditer(script.text))
    marks = tuple(Mark(f"{WORD_MARK_PREFIX}{k}", place.start()) for k, place in enumerate(places))
    plain = replace(script, marks=(*script.marks, *marks), pauses=(), recording=None)
    utterance = voice.say(plain)
    times = [utterance.marks[mark.name] for mark in marks]
    starts = _separate(times)
    own = {name: time for name, time in utterance.marks.items() if not name.startswith(WORD_MARK_PREFIX)}
    remarks = tuple(remark for remark in utterance.remarks if WORD_MARK_PREFIX not in remark)
    return Rendition(
        replace(utterance, marks=own, remarks=remarks),
        tuple(place[0] for place in places),
        starts,
        _find_ends(utterance, starts),
        _find_marked_words(script, utterance, [place.start() for place in places], times),
    )


def _separate(times: Sequence[float]) -> Floats:
    """Return times [s] moved to be at least `MIN_WORD_TIME` apart."""
    count = MIN_WORD_TIME * np.arange(len(times))
    increasing: Floats = np.maximum.accumulate(np.array(times) - count) + count if len(times) else np.zeros(0)
    return increasing


def _find_marked_words(
    script: Script, utterance: Utterance, positions: Sequence[int], times: Sequence[float]
) -> Mapping[str, int]:
    """Return {mark name: index of the word that begins at the mark}."""
    words: dict[str, int] = {}
    for mark in script.marks:
        following = bisect_left(positions, mark.position)
        if following < len(positions) and abs(utterance.marks[mark.name] - times[following]) < SAME_TIME:
            words.setdefault(mark.name, following)
    return words


def _find_ends(utterance: Utterance, starts: Floats) -> Floats:
    """Return the end [s] of the last sound of each word, (words,)."""
    ends = np.array([sound.end for sound in utterance.phonemes])
    begins = np.array([sound.start for sound in utterance.phonemes])
    following = np.append(starts[1:], np.inf)
    last = np.searchsorted(begins, following - 1e-6) - 1  # index of the last sound of each word
    if not len(ends):
        evenly: Floats = np.minimum(following, utterance.duration)
        return evenly
    limited: Floats = np.minimum(np.maximum(ends[np.maximum(last, 0)], starts), following)
    return limited
