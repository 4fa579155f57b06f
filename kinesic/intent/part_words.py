"""Selection of the next words to speak, with intents clipped to them."""

from dataclasses import replace

from kinesic.intent.intents import Intent
from kinesic.intent.reading.passage import Passage

MAX_PART_WORDS = 24  # [words] largest number of words spoken together


def select_words(passage: Passage, words: range) -> range:
    """Return the range of words to speak in the next part.

    They are whole sentences, otherwise whole phrases, as many as the limit allows.
    """
    limit = min(words.stop, words.start + MAX_PART_WORDS)
    sentences = [sentence[-1] + 1 for sentence in passage.sentences if words.start < sentence[-1] + 1 <= limit]
    phrases = [phrase[-1] + 1 for phrase in passage.phrases if words.start < phrase[-1] + 1 <= limit]
    return range(words.start, max(sentences or phrases, default=limit))


def clip_intent(intent: Intent, passage: Passage, words: range) -> Intent:
    """Clip an intent to the time span of given words."""
    first, last = passage.onset(words.start), passage.close(words.stop - 1)
    start = first if words.start and intent.start.seconds < first.seconds else intent.start
    return replace(intent, start=start, end=last if intent.end.seconds > last.seconds else intent.end)
