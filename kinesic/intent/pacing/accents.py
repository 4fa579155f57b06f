"""Accented words of a text, on which beats may fall."""

from collections.abc import Collection, Iterator, Sequence
from dataclasses import replace

from kinesic.intent.intents import Intent
from kinesic.intent.reading.passage import Passage

GROUP_CERTAINTY = 0.2  # certainty of an accent on the last of successive content words
WORD_CERTAINTY = 0.1  # certainty of an accent on a content word that another one follows
RHYTHM_INTENT = "rhythm"  # intent of a beat on an accent


def find_accents(passage: Passage, taken: Collection[int] = ()) -> Iterator[Intent]:
    """Yield an intent for each accented content word, in order.

    With a recording, its accents count in place of the content words.

    Args:
        passage: the text.
        taken: words with an accent already.
    """
    for k, word in enumerate(passage.words):
        is_accented = word.is_content if passage.accents is None else k in passage.accents
        if not is_accented or k in taken:
            continue
        is_last = passage.accents is not None or k + 1 == len(passage.words) or not passage.words[k + 1].is_content
        yield Intent(
            RHYTHM_INTENT,
            passage.onset(k),
            passage.stress(k),
            passage.close(k),
            GROUP_CERTAINTY if is_last else WORD_CERTAINTY,
            f"'{word.text}' carries an accent",
            word=k,
            phrase=word.phrase,
        )


def follow_accents(intents: Sequence[Intent], passage: Passage, beats: Collection[str]) -> tuple[Intent, ...]:
    """Move beats to accents of a recording within their phrase.

    A beat in a phrase without a free accent is dropped. Without a recording, the intents are unchanged.

    Args:
        intents: of the text.
        passage: the text.
        beats: names of the intents of beats.
    """
    if passage.accents is None:
        return tuple(intents)
    free = set(passage.accents) - {intent.word for intent in intents if intent.name in beats}
    kept: list[Intent] = []
    for intent in intents:
        if intent.name not in beats or intent.word in passage.accents or intent.word < 0:
            kept.append(intent)
            continue
        near = [word for word in free if passage.words[word].phrase == passage.words[intent.word].phrase]
        if near:
            word = min((abs(index - intent.word), index) for index in near)[1]
            free.remove(word)
            onset, stroke, close = passage.onset(word), passage.stress(word), passage.close(word)
            reason = f"'{passage.words[word].text}' carries an accent in the recording"
            kept.append(replace(intent, start=onset, stroke=stroke, end=close, word=word, reason=reason))
    return tuple(kept)
