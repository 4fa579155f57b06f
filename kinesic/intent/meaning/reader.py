"""Intents of a text, with the gestures that show them."""

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import replace
from functools import lru_cache

from kinesic.body.choices import GrammarName
from kinesic.expressivity.lexicon.entries import builtin_gestures
from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.intent.intents import Intent
from kinesic.intent.meaning.context import Context
from kinesic.intent.meaning.cue_table import load_cues, load_senses
from kinesic.intent.meaning.feelings import EMOTION_PREFIX, temper
from kinesic.intent.meaning.lexicon_names import find_names
from kinesic.intent.meaning.matching import Candidate, match_cues
from kinesic.intent.meaning.rhythm import place_beats, place_stroke
from kinesic.intent.meaning.scoring import Picture, choose_pictures, score
from kinesic.intent.meaning.structure import find_denials, find_persons, find_structures, find_topics
from kinesic.intent.reading.language import Language
from kinesic.intent.reading.passage import Passage
from kinesic.intent.reading.text import EMOTION_STYLES, find_intents

HAND_CHANNEL = frozenset({"gesture"})  # channel of hand gestures
MIN_TOPIC_LIVELINESS = 0.5  # liveliness from which open hands present a sentence without another gesture
MIN_TOPIC_DURATION = 8.0  # [s] shortest text with topic gestures
HAND_INTENTS = frozenset(
    {"emphasis-strong", "listing-left", "listing-right"}
)  # intents whose hand gestures are kept in addition to those of cues
FEELING_STYLES = {
    **EMOTION_STYLES,
    "emotion-pride": "proud",
    "emotion-relief": "calm",
    "emotion-embarrassment": "shy",
}  # intent of a feeling -> style in which its sentence is performed
NEGATION_INTENTS = frozenset({"negation", "performative-disagree"})  # intents of idioms that really negate
ILLUSTRATION_INTENTS = frozenset({"iconic", "metaphoric"})  # intents of gestures that illustrate a single word


def read_meanings(
    passage: Passage,
    language: Language,
    lexicon: Lexicon,
    *,
    grammar: GrammarName = "rules",
    begins: bool = True,
    ends: bool = True,
    liveliness: float = 0.0,
) -> tuple[Intent, ...]:
    """Return all intents of a text, with illustrating gestures chosen by score.

    A language without cues has the gestures of its rules.

    Args:
        passage: the text.
        language: its rules.
        lexicon: gestures.
        grammar: method that finds the phrase structure.
        begins: whether a turn begins with it.
        ends: whether a turn ends with it.
        liveliness: 0..1 of the style; a lively speaker also illustrates words of plain reports.
    """
    intents = find_intents(passage, language, lexicon, grammar=grammar, begins=begins, ends=ends)
    table = load_cues(language.tag)
    if not intents or not table.cues:
        return intents
    context = Context(passage, language)
    cues = match_cues(context, table)
    idioms, harmless = _find_idioms(cues)
    pictures = _find_pictures(context, cues, idioms, harmless, lexicon, liveliness)
    idioms, harmless = _find_idioms([*cues, *(each.candidate for each in pictures if each.candidate.cue.patterns)])
    tempered = (temper(context, intent, idioms, harmless) for intent in intents)
    kept = [_mute(intent, lexicon) for intent in tempered if intent is not None]
    silent = [each for each in cues if not each.cue.shows and each.cue.intent != "picture"]
    same = {**load_senses(language.tag).gestures, **table.gestures}
    shown = [
        *(_picture_intent(passage, picture.candidate, picture.score, same) for picture in pictures),
        *(_picture_intent(passage, each, each.cue.certainty, same) for each in silent),
        *place_beats(context, kept, [picture.candidate.stroke for picture in pictures]),
    ]
    return tuple(sorted(shown, key=lambda intent: (intent.stroke.seconds, -intent.certainty, intent.name)))


def list_pictures(passage: Passage, language: Language, lexicon: Lexicon) -> tuple[Picture, ...]:
    """Return all candidate gestures of a text, ordered by decreasing score.

    Candidates below their threshold are included; `read_meanings` omits them.
    """
    table = load_cues(language.tag)
    if not passage.words or not table.cues:
        return ()
    context = Context(passage, language)
    cues = match_cues(context, table)
    idioms, harmless = _find_idioms(cues)
    candidates = [*cues, *find_names(context, lexicon), *find_structures(context, ()), *find_persons(context, idioms)]
    categories = _categories(lexicon)
    pictures = [Picture(each, score(context, each, harmless, categories)) for each in candidates if each.cue.shows]
    return tuple(sorted(pictures, key=lambda each: -each.score))


def _find_idioms(cues: Sequence[Candidate]) -> tuple[frozenset[int], frozenset[int]]:
    """Return the word indices of idioms, and of those without negation."""
    spans = [(each.cue.intent, range(each.first, each.last + 1)) for each in cues if each.cue.kind != "word"]
    harmless = frozenset(k for intent, span in spans for k in span if intent not in NEGATION_INTENTS)
    return frozenset(k for _, span in spans for k in span), harmless


def _find_pictures(
    context: Context,
    cues: Sequence[Candidate],
    idioms: Collection[int],
    harmless: Collection[int],
    lexicon: Lexicon,
    liveliness: float,
) -> list[Picture]:
    """Choose illustrating gestures by cues, gesture names and sentence structure.

    A lively speaker also has open hands that present long statements.
    """
    categories = _categories(lexicon)
    taken = {k for each in cues for k in range(each.first, each.last + 1)}
    names = [each for each in find_names(context, lexicon) if taken.isdisjoint(range(each.first, each.last + 1))]
    candidates = [*cues, *names, *find_structures(context, taken)]
    pictures = choose_pictures(context, candidates, harmless, categories, liveliness)
    silent = [each for each in cues if not each.cue.shows]
    senses = match_cues(context, load_senses(context.language.tag))
    free = [each for each in senses if not any(_silences(cue, each) for cue in silent)]
    for others in ([*free, *find_denials(context, taken)], find_persons(context, idioms)):
        pictures += choose_pictures(context, _outside(context, others, pictures), harmless, categories, liveliness)
    if liveliness < MIN_TOPIC_LIVELINESS or context.passage.starts[-1] < MIN_TOPIC_DURATION:
        return pictures
    topics = _outside(context, find_topics(context), pictures)
    return [*pictures, *choose_pictures(context, topics, harmless, categories)]


def _silences(cue: Candidate, sense: Candidate) -> bool:
    """Return whether a cue without gesture overlaps a sense.

    An idiom that contains all words of the cue has a meaning of its own, which is shown.
    """
    is_shared = cue.first <= sense.last and sense.first <= cue.last
    is_contained = sense.first <= cue.first and cue.last <= sense.last
    return is_shared and not (is_contained and sense.cue.kind == "idiom")


def _outside(context: Context, candidates: Iterable[Candidate], pictures: Iterable[Picture]) -> list[Candidate]:
    """Return the candidates in sentences without illustrating gestures."""
    words = context.passage.words
    sentences = {words[each.candidate.stroke].sentence for each in pictures}
    return [each for each in candidates if words[each.stroke].sentence not in sentences]


@lru_cache(maxsize=4)
def _categories(lexicon: Lexicon) -> Mapping[str, str]:
    return {entry.id: entry.category for entry in reversed(lexicon.entries)}


@lru_cache(maxsize=1)
def _builtin_names() -> frozenset[str]:
    return frozenset(entry.id for entry in builtin_gestures().entries)


def _mute(intent: Intent, lexicon: Lexicon) -> Intent:
    """Mute a rule's hand gesture, since cues choose the gestures.

    Gestures of accents, emoticons and `HAND_INTENTS` remain, and illustrations by gestures that are not built in.
    """
    if intent.name in HAND_INTENTS or intent.name == "accent" or "emoticon" in intent.reason:
        return intent
    if intent.name in ILLUSTRATION_INTENTS and not set(intent.lexemes) <= _builtin_names():
        return intent
    return replace(intent, muted=intent.muted | HAND_CHANNEL)


def _picture_intent(
    passage: Passage, candidate: Candidate, certainty: float, same: Mapping[str, tuple[str, ...]]
) -> Intent:
    """Create the intent that shows a candidate gesture.

    Args:
        passage: the text.
        candidate: its words and gestures.
        certainty: 0..1 that its gesture fits.
        same: gestures by meaning, which replace recently shown ones.
    """
    cue = candidate.cue
    stroke = place_stroke(passage, candidate.stroke)
    words = " ".join(word.text for word in passage.words[candidate.first : candidate.last + 1])
    sentence, is_emotion = passage.sentences[passage.words[stroke].sentence], cue.intent.startswith(EMOTION_PREFIX)
    return Intent(
        name=cue.intent,
        start=passage.onset(candidate.first),
        stroke=passage.stress(stroke),
        end=passage.close(sentence[-1] if is_emotion else max(candidate.last, stroke)),
        certainty=certainty,
        reason=f"'{words}' {cue.says}",
        lexemes=cue.shows,
        substitutes=same.get(cue.says, ()),
        word=candidate.stroke,
        phrase=passage.words[stroke].phrase,
        style=FEELING_STYLES.get(cue.intent, ""),
        hand=cue.hand,
        muted=frozenset() if cue.shows else HAND_CHANNEL,
    )
