"""Text that a running speech has spoken by a given time."""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

from kinesic.bml.block import Speech
from kinesic.body.utterance import Script, Utterance
from kinesic.realizer.scene import Scene

WORD_PATTERN = re.compile(r"\S+")  # spoken word
MIN_WORD_FRACTION = 0.5  # fraction of a word's duration after which it counts as spoken


@dataclass(frozen=True)
class HeardText:
    """Text of a speech, divided at a time."""

    said: str  # words that were heard
    unsaid: str  # words that were not heard


def divide_text(script: Script, utterance: Utterance, elapsed: float) -> HeardText:
    """Divide a text into spoken and unspoken words.

    Word times between two marks are estimated from the letters of the words and the durations of the phonemes.

    Args:
        script: text with its marks.
        utterance: times of its marks and phonemes.
        elapsed: time [s] since the start of the utterance.
    """
    words = list(WORD_PATTERN.finditer(script.text))
    times = [_time_at(word.start() + MIN_WORD_FRACTION * len(word[0]), script, utterance) for word in words]
    said = [word[0] for word, time in zip(words, times, strict=True) if time <= elapsed]
    return HeardText(" ".join(said), " ".join(word[0] for word in words[len(said) :]))


def divide_speeches(scene: Scene, time: float, block: str | None = None) -> dict[str, HeardText]:
    """Divide each running block's text into spoken and unspoken words.

    A block without speech has empty texts.

    Args:
        scene: scene with the running blocks.
        time: global time [s].
        block: id of the only block; None for all.
    """
    return {
        running.id: _joined(
            divide_text(behaviour.action.script, speech.utterance, time - speech.begin)
            for speech in sorted(running.speeches, key=lambda speech: speech.begin)
            for behaviour in running.block.behaviours
            if behaviour.id == speech.behaviour and isinstance(behaviour.action, Speech)
        )
        for running in scene.playing
        if block in (None, running.id)
    }


def _joined(parts: Iterator[HeardText]) -> HeardText:
    texts = list(parts)
    return HeardText(" ".join(text.said for text in texts).strip(), " ".join(text.unsaid for text in texts).strip())


def _time_at(position: float, script: Script, utterance: Utterance) -> float:
    """Estimate when [s] a position in the text is spoken."""
    marks = sorted((mark.position, utterance.marks[mark.name]) for mark in script.marks if mark.name in utterance.marks)
    cuts = [(0, 0.0), *marks, (len(script.text), utterance.duration)]
    for (first, begin), (last, end) in pairwise(cuts):
        if position <= last and last > first:
            return _voiced_time(begin, end, _letter_fraction(script.text, first, position, last), utterance)
    return utterance.duration


def _letter_fraction(text: str, first: int, position: float, last: int) -> float:
    """Return the fraction of a section's letters before a position."""
    letters = [place for place in range(first, last) if text[place].isalnum()]
    return sum(place < position for place in letters) / len(letters) if letters else 0.0


def _voiced_time(begin: float, end: float, fraction: float, utterance: Utterance) -> float:
    """Return the time [s] when a fraction of a span is spoken."""
    sounds = [phoneme for phoneme in utterance.phonemes if phoneme.letters and begin <= phoneme.start < end]
    left = fraction * sum(phoneme.duration for phoneme in sounds)
    for phoneme in sounds:
        if left <= phoneme.duration:
            return phoneme.start + left
        left -= phoneme.duration
    return begin + fraction * (end - begin) if not sounds else end
