"""Writes BML from what somebody means: plain text, in one step."""

from dataclasses import replace

from kinesic.body.choices import GrammarName
from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.expressivity.style.style import Style
from kinesic.intent.behaviour_sets import BehaviourSets, own_sets
from kinesic.intent.budget import budget_of
from kinesic.intent.choosing import ChosenBehaviour, Selection, choose_behaviours
from kinesic.intent.intents import Intent
from kinesic.intent.reading.language import load_language
from kinesic.intent.reading.passage import SPEECH, Passage
from kinesic.intent.reading.text import find_intents
from kinesic.intent.reading.words import read_text
from kinesic.intent.writing import write_block

EARLY = 2.5  # [s] from the first word, until which a hand may have to hurry
SET_OUT = 0.4  # [s] by which it sets out before that word at the earliest, so that the voice waits no longer
REACHED, GREETED = 0.55, 1.4  # [s] behind that word its stroke is at the earliest, and that of a wave, after its turns
GREETING = "performative-greet"  # that waves show
PLAIN_STYLE = "neutral"  # the one style in which feelings may choose the manner of their sentences


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
    """Writes BML that says a text and performs what it means; the same text, style and seed have the same BML.

    Args:
        text: plain, with *stress*, CAPITALS, emoticons, or the tags of SSML.
        lexicon: gestures that may picture its words.
        style: in which it is performed: a lively one has more gestures. Neutral leaves the manner to what is felt.
        language: its tag.
        grammar: who finds its phrases and clauses.
        sets: behaviours by intent; None: those that come with kinesic.
        seed: of what is drawn among alternatives.
        block: id of the block.

    Raises:
        ConfigError: there are no rules for the language, or what shall parse it is missing.
    """
    passage, selection = plan_behaviours(text, lexicon, style, language=language, grammar=grammar, sets=sets, seed=seed)
    return write_block(passage, selection.behaviours, block=block)


def plan_behaviours(
    text: str,
    lexicon: Lexicon,
    style: Style,
    *,
    language: str = "en",
    grammar: GrammarName = "rules",
    sets: BehaviourSets | None = None,
    seed: int = 0,
) -> tuple[Passage, Selection]:
    """Chooses the behaviours of a text; see `author`."""
    rules = load_language(language)
    passage = read_text(text, rules)
    intents = find_intents(passage, rules, lexicon, grammar=grammar)
    if style.name != PLAIN_STYLE:
        intents = tuple(replace(each, style="") for each in intents)
    budget = budget_of(len(passage.words), style)
    found = choose_behaviours(intents, sets or own_sets(), budget, seed=seed, reachable=reachable)
    return passage, replace(found, behaviours=tuple(map(hurry_first_gesture, found.behaviours)))


def reachable(intent: Intent, since: float = 0.0) -> Intent:
    """Has the stroke of a gesture come no sooner than its hand gets there, if it sets out just before the first word.

    Args:
        intent: that a gesture shows.
        since: [s] when the first word is said.
    """
    least = since + (GREETED if intent.name == GREETING else REACHED)
    return replace(intent, stroke=intent.stroke.later(max(least - intent.stroke.seconds, 0.0)))


def hurry_first_gesture(each: ChosenBehaviour, since: float = 0.0) -> ChosenBehaviour:
    """Has the first gesture not hold the voice up: its hand sets out just before the first word."""
    if each.channel != "gesture" or each.intent.stroke.seconds > since + EARLY:
        return each
    return replace(each, begin=f"{SPEECH}:start-{SET_OUT:.2f}")
