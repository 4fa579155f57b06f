"""Ranked gestures that could be shown at one word of a text."""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import islice

from kinesic.body.robot import Robot
from kinesic.expressivity.lexicon.entries import builtin_gestures
from kinesic.expressivity.lexicon.form import GestureForm
from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.expressivity.lexicon.query_words import is_function_word
from kinesic.expressivity.lexicon.search import find_gestures
from kinesic.expressivity.missing_fingers import describe_missing_fingers
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
class QueriedWord:
    """Word of a text, for which gestures are wanted."""

    text: str  # spoken text, without markup
    at: int  # position [characters] of the word in the text
    intent: str = ""  # intent of the gesture that the word has now; empty: unknown
    language: str = "en"  # tag of the language of the text


@dataclass(frozen=True)
class Alternative:
    """Gesture that could be shown at a word."""

    id: str  # lexeme in BML
    category: str
    says: str  # movement and meaning in one line
    why: str  # reason why the gesture fits the word
    intent: str  # intent that the gesture shows; empty: found by a search for the word
    lacks: str = ""  # what the robot lacks for it; empty: the robot can show all of it


def rank_alternatives(
    word: QueriedWord, lexicon: Lexicon, sets: BehaviourSets, robot: Robot
) -> tuple[str, tuple[Alternative, ...]]:
    """Rank the possible gestures at a word, the most suitable first.

    First come the candidates of the text at this word, by their scores. Then follow the other gestures of the intent,
    the results of `find_gestures` for the word, gestures of the user, and beats. Of gestures with the same reason,
    those that need fingers which the robot lacks come last. A gesture with a fallback is replaced by it.

    Args:
        word: word for which gestures are wanted.
        lexicon: gestures.
        sets: behaviours of each intent.
        robot: robot that shows the gestures.

    Returns:
        The word, and its alternatives; an empty word and none for a text without words.

    Raises:
        ConfigError: the language is not a language tag.
    """
    passage = read_text(word.text, load_language(word.language))
    if not passage.words:
        return "", ()
    number = next((k for k, each in enumerate(passage.words) if each.end > word.at), len(passage.words) - 1)
    listed: dict[str, Alternative] = {}
    for lexeme, why, shown in _propose(passage, number, lexicon, sets, word.intent):
        form = _find_form(lexicon, lexeme, robot)
        if form is None or form.id in listed:
            continue
        lacks = describe_missing_fingers(form, robot)
        listed[form.id] = Alternative(form.id, form.category, lexicon.sense(form).says, why, shown, lacks)
    reasons = list(dict.fromkeys(each.why for each in listed.values()))
    ranked = sorted(listed.values(), key=lambda each: (reasons.index(each.why), bool(each.lacks)))
    return passage.words[number].text, tuple(ranked)[:MAX_ALTERNATIVES]


def _find_form(lexicon: Lexicon, lexeme: str, robot: Robot) -> GestureForm | None:
    """Return the form of a gesture, or of its fallback without fingers."""
    match = lexicon.find(lexeme)
    if match is not None and match.form.fallback and describe_missing_fingers(match.form, robot):
        match = lexicon.find(match.form.fallback)
    return None if match is None else match.form


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
