"""Writes BML from what somebody means: plain text, in one step."""

from dataclasses import replace

from kinesic.body.choices import GrammarName
from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.expressivity.style.style import Style
from kinesic.intent.behaviour_sets import BehaviourSets, own_sets
from kinesic.intent.budget import budget_of
from kinesic.intent.choosing import Selection, choose_behaviours
from kinesic.intent.reading.language import load_language
from kinesic.intent.reading.passage import Passage
from kinesic.intent.reading.text import find_intents
from kinesic.intent.reading.words import read_text
from kinesic.intent.writing import write_text

PLAIN = "neutral"  # the one style in which feelings may choose the manner of their sentences


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
    return write_text(passage, selection.behaviours, block=block)


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
    if style.name != PLAIN:
        intents = tuple(replace(each, style="") for each in intents)
    budget = budget_of(len(passage.words), style)
    return passage, choose_behaviours(intents, sets or own_sets(), budget, seed=seed)
