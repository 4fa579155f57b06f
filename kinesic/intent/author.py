"""Generation of BML from plain text in one step."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial

from kinesic.body.choices import GrammarName
from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.expressivity.style.style import Style
from kinesic.intent.behaviour_sets import BehaviourSets, builtin_sets
from kinesic.intent.behaviours import ChosenBehaviour, Earlier, Selection
from kinesic.intent.budget import budget_of
from kinesic.intent.choosing import choose_behaviours
from kinesic.intent.directed import DIRECTION_INTENT, find_directed
from kinesic.intent.intents import Intent
from kinesic.intent.manuscript.pieces import SpokenText
from kinesic.intent.manuscript.reading import read_manuscript
from kinesic.intent.meaning.reader import read_meanings
from kinesic.intent.pacing.accents import find_accents, follow_accents
from kinesic.intent.pacing.long_strokes import slowness_of, stroke_delay
from kinesic.intent.pacing.memory import NO_MEMORY, ChoiceMemory, Revision
from kinesic.intent.pacing.rhythm import BEAT_INTENTS
from kinesic.intent.pacing.tempo import liveliness_of
from kinesic.intent.reading.language import load_language
from kinesic.intent.reading.passage import SPEECH_ID, Passage
from kinesic.intent.reading.words import read_text
from kinesic.intent.recorded import RecordedAudio
from kinesic.intent.writing import write_block

PREPARED_STROKE_TIME = 1.3  # [s] time from the start of a gesture to its stroke, at slowness 1
GESTURE_LEAD_TIME = 0.4  # [s] from the start of an early gesture to the first word; a longer time delays the speech
MIN_STROKE_DELAY = 0.55  # [s] shortest time from the first word to a reachable stroke
REACH_TOLERANCE = 0.15  # [s] delays up to this are omitted to keep strokes on words
MIN_WAVE_DELAY = 1.4  # [s] shortest time from the first word to the stroke of a wave
GREETING_INTENT = "performative-greet"  # intent of greetings, shown by waves
PLAIN_STYLE = "neutral"  # only style in which emotions may set the style of their sentences


@dataclass(frozen=True, eq=False)
class AuthoredText:
    """BML that speaks a text, with warnings about omitted parts."""

    bml: str
    warnings: tuple[str, ...]  # one for each part of the text that is neither spoken nor performed
    memory: ChoiceMemory  # gestures to remember for the next text
    words: int = 0  # number of spoken words of the text


def author(
    text: str,
    lexicon: Lexicon,
    style: Style,
    *,
    language: str = "en",
    grammar: GrammarName = "rules",
    sets: BehaviourSets | None = None,
    seed: int = 0,
    block: str = "said",
) -> str:
    """Write BML that speaks a text with matching gestures and expressions.

    The same text, style and seed give the same BML.

    Args:
        text: as people write it: with *stress*, (directions), emoji, Markdown, or the tags of SSML.
        lexicon: gestures that may illustrate its words.
        style: of the performance: a lively one has more gestures. In the neutral style, emotions set the expressivity.
        language: its tag, with a region for the voice: `en-GB`.
        grammar: method that finds phrases and clauses.
        sets: behaviours by intent; None: those that come with kinesic.
        seed: of the random choice among alternatives.
        block: id of the block.

    Raises:
        ConfigError: the language is not a language tag, or its parser is missing.
    """
    return author_text(text, lexicon, style, language=language, grammar=grammar, sets=sets, seed=seed, block=block).bml


def author_text(
    text: str | SpokenText,
    lexicon: Lexicon,
    style: Style,
    *,
    language: str = "en",
    grammar: GrammarName = "rules",
    sets: BehaviourSets | None = None,
    seed: int = 0,
    block: str = "said",
    memory: ChoiceMemory = NO_MEMORY,
    character: str = "",
    recorded: RecordedAudio | None = None,
    revise: Revision | None = None,
) -> AuthoredText:
    """Write BML for a text, with a warning for each omitted part.

    See `author`.

    Args:
        text: as people write it, or a part of a long text.
        lexicon: gestures that may illustrate its words.
        style: of the performance.
        language: its tag.
        grammar: method that finds phrases and clauses.
        sets: behaviours by intent; None: those that come with kinesic.
        seed: of the random choice among alternatives.
        block: id of the block.
        memory: gestures of earlier texts, which are not repeated for a minute of speech.
        character: speaker of a dialogue whose lines are spoken; empty: all.
        recorded: recording of the text, whose times and accents count; None: a voice speaks.
        revise: replaces gestures of the chosen behaviours; None: they stay.
    """
    passage, selection = plan_behaviours(
        text,
        lexicon,
        style,
        language=language,
        grammar=grammar,
        sets=sets,
        seed=seed,
        memory=memory,
        character=character,
        recorded=recorded,
    )
    behaviours = selection.behaviours if revise is None else revise(selection.behaviours, memory.list_clips())
    after = memory.extend(selection.behaviours, passage.starts[-1], written=behaviours)
    bml = write_block(passage, behaviours, block=block, recorded=recorded)
    return AuthoredText(bml, selection.warnings, after, len(passage.words))


def plan_behaviours(
    text: str | SpokenText,
    lexicon: Lexicon,
    style: Style,
    *,
    language: str = "en",
    grammar: GrammarName = "rules",
    sets: BehaviourSets | None = None,
    seed: int = 0,
    memory: ChoiceMemory = NO_MEMORY,
    character: str = "",
    recorded: RecordedAudio | None = None,
) -> tuple[Passage, Selection]:
    """Return the words of a text, and the behaviours chosen for it.

    See `author`.
    """
    rules = load_language(language)
    lacking = (rules.warning,) if rules.warning else ()
    spoken = text if isinstance(text, SpokenText) else SpokenText(*read_manuscript(text, character=character))
    passage = read_text(spoken.text, rules)
    passage = passage if recorded is None else recorded.hear(passage)
    directed = find_directed(passage, lexicon)
    asked = tuple(reach_directed(behaviour, slowness=slowness_of(style)) for behaviour in directed.behaviours)
    meanings = read_meanings(passage, rules, lexicon, grammar=grammar, liveliness=liveliness_of(style))
    intents = add_accents(meanings, passage)
    if style.name != PLAIN_STYLE:
        intents = tuple(replace(intent, style="") for intent in intents)
    budget = budget_of(passage.starts[-1], style)
    selection = choose_behaviours(
        intents,
        sets or builtin_sets(),
        budget,
        seed=seed,
        earlier=Earlier(fixed=asked),
        memory=memory,
        reachable=partial(reachable, slowness=slowness_of(style)),
    )
    behaviours = merge_directed(selection.behaviours, asked, slowness=slowness_of(style))
    return passage, replace(selection, behaviours=behaviours, warnings=(*lacking, *spoken.warnings, *directed.warnings))


def add_accents(intents: Sequence[Intent], passage: Passage) -> tuple[Intent, ...]:
    """Move beats to recorded accents, and add beats on remaining accented words."""
    intents = follow_accents(intents, passage, BEAT_INTENTS)
    taken = frozenset(intent.word for intent in intents if intent.name in BEAT_INTENTS)
    ordered = sorted([*intents, *find_accents(passage, taken)], key=lambda intent: intent.stroke.seconds)
    return tuple(ordered)


def reach_directed(behaviour: ChosenBehaviour, since: float = 0.0, *, slowness: float = 1.0) -> ChosenBehaviour:
    """Delay a stage direction's gesture until the hand can reach its stroke.

    Behaviours of other channels are returned unchanged.
    """
    if behaviour.channel != "gesture":
        return behaviour
    return replace(behaviour, intent=reachable(behaviour.intent, since, slowness=slowness))


def merge_directed(
    chosen: Sequence[ChosenBehaviour],
    directed: Sequence[ChosenBehaviour],
    since: float = 0.0,
    *,
    slowness: float = 1.0,
) -> tuple[ChosenBehaviour, ...]:
    """Merge chosen behaviours and those of stage directions by stroke time.

    If the first gesture has an early stroke, it starts before the speech.

    Args:
        chosen: behaviours that show intents.
        directed: behaviours that the text asks for.
        since: time of the first word [s].
        slowness: factor on the duration of long strokes.
    """
    ordered = sorted([*chosen, *directed], key=lambda each: (each.intent.stroke.seconds, each.channel))
    first = next((behaviour for behaviour in ordered if behaviour.channel == "gesture"), None)
    is_on_word = first is not None and first.intent.word >= 0
    return tuple(
        hurry_first_gesture(behaviour, since, slowness) if is_on_word and behaviour is first else behaviour
        for behaviour in ordered
    )


def reachable(intent: Intent, since: float = 0.0, *, slowness: float = 1.0) -> Intent:
    """Delay an intent's stroke until the hand can reach it.

    A long stroke is delayed until it accompanies its word. The hand sets out just before the first word.

    Args:
        intent: that a gesture shows.
        since: time of the first word [s].
        slowness: factor on the duration of long strokes.
    """
    if intent.word < 0:
        return intent
    is_directed_wave = intent.name == DIRECTION_INTENT and any("wave" in lexeme for lexeme in intent.lexemes)
    is_wave = intent.name == GREETING_INTENT or is_directed_wave
    least = since + (MIN_WAVE_DELAY if is_wave else MIN_STROKE_DELAY)
    late = least - intent.stroke.seconds
    delay = max(late if late > REACH_TOLERANCE else 0.0, stroke_delay(intent.lexemes, slowness))
    return replace(intent, stroke=intent.stroke.later(delay))


def hurry_first_gesture(behaviour: ChosenBehaviour, since: float = 0.0, slowness: float = 1.0) -> ChosenBehaviour:
    """Start a gesture with an early stroke just before the first word.

    The gesture then does not delay the speech. Other behaviours are returned unchanged: hands that have time to prepare
    their stroke would otherwise wait motionless before it.
    """
    needed = PREPARED_STROKE_TIME * slowness - GESTURE_LEAD_TIME
    if behaviour.channel != "gesture" or behaviour.intent.stroke.seconds > since + needed:
        return behaviour
    return replace(behaviour, begin=f"{SPEECH_ID}:start-{GESTURE_LEAD_TIME:.2f}")
