"""Ranked gestures that could be shown at one word of a text."""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import islice

from kinesic.expressivity.lexicon.entries import builtin_gestures
from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.expressivity.lexicon.query_words import is_function_word
from kinesic.expressivity.lexicon.search import find_gestures
from kinesic.intent.behaviour_sets import NO_SIGNAL, BehaviourSets
from kinesic.intent.meaning.reader import list_pictures
from kinesic.intent.pacing.accents import RHYTHM_INTENT
from kinesic.intent.reading.language import load_language
from kinesic.intent.reading.passage import Passage
from kinesic.intent.reading.words import read_text

MAX_ALTERNATIVES = 24  # maximum number of ranked gestures per word
MAX_OWN = 8  # maximum number of user-defined gestures among the alternatives
OWN_REASON = "your own gesture"  # reason for a user-defined gesture
MAX_BEATS = 6  # maximum number of beat gestures among the alternatives
MAX_FOUND = 10  # maximum number of gestures from the lexicon search
BEAT_REASON = "stresses the word"  # reason for a beat, which fits every word


@dataclass(frozen=True)
class Alternative:
    """Gesture that could be shown at a word."""

    id: str  # lexeme in BML
    category: str
    says: str  # movement and meaning in one line
    why: str  # reason why the gesture fits the word
    intent: str  # intent that the gesture shows; empty: found by a search for the word


def rank_alternatives(
    text: str,
    at: int,
    lexicon: Lexicon,
    sets: BehaviourSets,
    *,
    intent: str = "",
    language: str = "en",
) -> tuple[str, tuple[Alternative, ...]]:
    """Rank the possible gestures at a word, the most suitable first.

    First come the candidates of the text at this word, by their scores. Then follow the other gestures of the intent,
    the results of `find_gestures` for the word, gestures of the user, and beats.

    Args:
        text: spoken text, without markup.
        at: position [characters] of the word in the text.
        lexicon: gestures.
        sets: behaviours of each intent.
        intent: intent of the gesture that the word has now; empty: unknown.
        language: tag of the language of the text.

    Returns:
        The word, and its alternatives; an empty word and none for a text without words.

    Raises:
        ConfigError: the language is not a language tag.
    """
    passage = read_text(text, load_language(language))
    if not passage.words:
        return "", ()
    word = next((k for k, each in enumerate(passage.words) if each.end > at), len(passage.words) - 1)
    ranked: dict[str, Alternative] = {}
    for lexeme, why, shown in _propose(passage, word, lexicon, sets, intent):
        match = lexicon.find(lexeme)
        if match is None or match.form.id in ranked:
            continue
        form = match.form
        ranked[form.id] = Alternative(form.id, form.category, lexicon.sense(form).says, why, shown)
    return passage.words[word].text, tuple(ranked.values())[:MAX_ALTERNATIVES]


def _propose(
    passage: Passage, word: int, lexicon: Lexicon, sets: BehaviourSets, intent: str
) -> Iterator[tuple[str, str, str]]:
    """Yield lexeme, reason and intent of each alternative, most suitable first."""
    for picture in list_pictures(passage, load_language(passage.language), lexicon):
        candidate = picture.candidate
        if candidate.first <= word <= candidate.last:
            words = " ".join(each.text for each in passage.words[candidate.first : candidate.last + 1])
            why = f"'{words}' {candidate.cue.says} ({picture.score:.2f})"
            yield from ((lexeme, why, candidate.cue.intent) for lexeme in candidate.cue.shows)
    if intent != RHYTHM_INTENT:
        yield from ((lexeme, f"shows the same intent: {intent}", intent) for lexeme in _gestures_of(sets, intent))
    spoken = passage.words[word]
    hits = () if is_function_word(spoken.plain) else find_gestures(lexicon, spoken.plain, count=MAX_FOUND)
    yield from ((hit.id, f"found for '{spoken.text}'", "") for hit in hits)
    yield from ((name, OWN_REASON, "") for name in islice(_own_gestures(lexicon), MAX_OWN))
    beats = islice(_gestures_of(sets, RHYTHM_INTENT), MAX_BEATS)
    yield from ((lexeme, BEAT_REASON, RHYTHM_INTENT) for lexeme in beats)


def _own_gestures(lexicon: Lexicon) -> Iterator[str]:
    """Yield the gestures of a lexicon that are not built in."""
    builtin = {entry.id for entry in builtin_gestures().entries}
    yield from (entry.id for entry in lexicon.entries if entry.id not in builtin)


def _gestures_of(sets: BehaviourSets, intent: str) -> Iterator[str]:
    """Yield the gestures of an intent, the most probable first."""
    found = sets.find(intent) if intent else None
    signals = () if found is None else (signal for signal in found.signals if signal.channel == "gesture")
    choices = [choice for signal in signals for choice in signal.choices if choice.lexeme.lower() != NO_SIGNAL]
    yield from (choice.lexeme for choice in sorted(choices, key=lambda each: -each.probability))
