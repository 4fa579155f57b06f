"""Placement of beats in sentences without illustrating gestures."""

from collections.abc import Iterator, Sequence
from dataclasses import replace

from kinesic.intent.intents import Intent
from kinesic.intent.meaning.context import Context
from kinesic.intent.reading.passage import Passage

MAIN_BEAT_CERTAINTY = 0.42  # minimum certainty of a beat on the last content word of a sentence
SECOND_BEAT_CERTAINTY = 0.36  # certainty of a beat on another content word of a long sentence
LONG_SENTENCE = 6  # [words] length of a sentence from which it has a second beat
SHORT_SENTENCE = 2  # [words] length of a sentence up to which it has no beat
BEAT_DISTANCE = 3  # [words] smallest distance of a beat from an illustrating gesture or another beat
BEAT_INTENT = "accent"  # intent of beats
HAND_CHANNEL = frozenset({"gesture"})  # channel of hand gestures


def place_beats(context: Context, intents: Sequence[Intent], pictures: Sequence[int]) -> Iterator[Intent]:
    """Yield the intents with adjusted accents and added beats of long sentences.

    The accent on the last content word of a sentence becomes more certain, and a long sentence gets a further beat. The
    accents of short sentences show no gesture unless they are emphasised.

    Args:
        context: the text.
        intents: of the rules, with an accent for each phrase.
        pictures: indices of words with illustrating gestures.
    """
    main = {_last_content(indices, context) for indices in context.passage.sentences if indices}
    accented = set[int]()
    for intent in intents:
        if intent.name != BEAT_INTENT:
            yield intent
            continue
        indices = context.sentence(intent.word)
        accented.add(intent.word)
        if len(indices) <= SHORT_SENTENCE and not context.passage.words[intent.word].emphatic:
            yield replace(intent, muted=intent.muted | HAND_CHANNEL)
        else:
            yield replace(intent, certainty=max(intent.certainty, MAIN_BEAT_CERTAINTY * (intent.word in main)))
    shown = accented.union(pictures)
    for indices in context.passage.sentences:
        if len(indices) < LONG_SENTENCE:
            continue
        used = [k for k in indices if k in shown]
        free = [
            k
            for k in indices
            if context.passage.words[k].is_content and all(abs(k - other) >= BEAT_DISTANCE for other in used)
        ]
        if free:
            yield _beat(context, max(free, key=lambda k: min((abs(k - other) for other in used), default=0)))


def _last_content(indices: Sequence[int], context: Context) -> int:
    return next((k for k in reversed(indices) if context.passage.words[k].is_content), indices[-1])


def _beat(context: Context, k: int) -> Intent:
    passage = context.passage
    return Intent(
        name=BEAT_INTENT,
        start=passage.onset(k),
        stroke=passage.stress(k),
        end=passage.close(k),
        certainty=SECOND_BEAT_CERTAINTY,
        reason=f"'{passage.words[k].text}' carries a second accent",
        word=k,
        phrase=passage.words[k].phrase,
        muted=frozenset({"head", "face"}),
    )


def place_stroke(passage: Passage, k: int) -> int:
    """Return the index of the content word at or near word `k`.

    Only the next and the previous word of the same phrase count as near. The result is `k` for an emphasised word, and
    if no content word is near.
    """
    words = passage.words
    if words[k].is_content or words[k].emphatic:
        return k
    for j in (k + 1, k - 1):
        if 0 <= j < len(words) and words[j].is_content and words[j].phrase == words[k].phrase:
            return j
    return k
