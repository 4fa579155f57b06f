"""Times of a script's marks, from the times of its words."""

import re
from bisect import bisect_left
from collections.abc import Mapping, Sequence
from itertools import takewhile

from kinesic.body.scripts import PHRASE_STOPS, SENTENCE_STOPS
from kinesic.body.utterance import Mark, Pause, Script
from kinesic.speech.engines.phrase import SpokenWord

# punctuation that closes a clause or sentence, with quotation marks and brackets before it
_CLOSING_PATTERN = re.compile(rf"[\s\"'\u2019\u201d\u00bb)\]]*[{SENTENCE_STOPS}{PHRASE_STOPS}]")


def place_marks(script: Script, words: Sequence[SpokenWord], duration: float) -> Mapping[str, float]:
    """Return the time [s] of the first mark of each name.

    A mark falls at the start of the next word. Before a pause or closing punctuation it stays at the end of the word
    before. A mark inside a word belongs to the next one.

    Args:
        script: text with marks and pauses.
        words: words with their characters in the script, in order.
        duration: of the whole speech [s].
    """
    begins = [word.begin for word in words]
    stops = script.stops()
    marks: dict[str, float] = {}
    latest, pauses_since_word, last_index = 0.0, 0.0, 0
    for number, stop in enumerate(stops):
        index = bisect_left(begins, stop.position)
        if index != last_index:
            pauses_since_word, last_index = 0.0, index
        if isinstance(stop, Pause):
            pauses_since_word += stop.duration
            continue
        before = words[index - 1].stop if index else 0.0
        following = words[index].start if index < len(words) else duration
        if index < len(words) and not _stays_behind(script.text, stops[number:], words[index].begin):
            time = following
        else:
            time = before + pauses_since_word
        latest = max(latest, min(time, following))
        marks.setdefault(stop.name, latest)
    return marks


def _stays_behind(text: str, stops: Sequence[Mark | Pause], next_word: int) -> bool:
    """Return whether the first mark stays at the previous word's end."""
    if _CLOSING_PATTERN.match(text[stops[0].position : next_word]):
        return True
    later = takewhile(lambda stop: stop.position <= next_word, stops[1:])
    return any(isinstance(stop, Pause) for stop in later)
