"""Accented words of a text, on which beats may fall."""

from collections.abc import Collection, Iterator

from kinesic.intent.intents import Intent
from kinesic.intent.reading.passage import Passage

GROUP_CERTAINTY = 0.2  # certainty of an accent on the last of successive content words
WORD_CERTAINTY = 0.1  # certainty of an accent on a content word that another one follows
RHYTHM_INTENT = "rhythm"  # intent of a beat on an accent


def find_accents(passage: Passage, taken: Collection[int] = ()) -> Iterator[Intent]:
    """Yield an intent for each accented content word, in order.

    Args:
        passage: the text.
        taken: words with an accent already.
    """
    for k, word in enumerate(passage.words):
        if not word.is_content or k in taken:
            continue
        is_last = k + 1 == len(passage.words) or not passage.words[k + 1].is_content
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
