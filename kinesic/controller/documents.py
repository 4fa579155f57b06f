"""Reads a document as a block, whatever somebody wrote: BML, FML-APML whose intentions become behaviours, or text."""

from kinesic.bml.block import Block
from kinesic.bml.parse import parse
from kinesic.intent.author import author
from kinesic.intent.behaviour_sets import BehaviourSets, own_sets
from kinesic.intent.fml.author import author_fml, is_fml, parse_fml
from kinesic.intent.greta.agent import Agent, read_agent
from kinesic.intent.greta.lexicon import read_lexicon
from kinesic.planning.setup import Setup


def read_block(text: str | bytes, known: Setup, *, source: str = "<text>") -> Block:
    """Reads one document; intentions are shown as the setup has it.

    Raises:
        BmlError: the document is refused.
        ConfigError: a file that says how intentions are shown is wrong.
    """
    if known.dialect in ("auto", "fml-apml") and is_fml(text):
        sets, agent = _shown(known)
        seed = known.idling.seed
        return parse_fml(text, source=source, performer=known.character, sets=sets, agent=agent, seed=seed)
    return parse(text, source=source, dialect=known.dialect, performer=known.character)


def write_fml(text: str | bytes, known: Setup, *, source: str = "<text>") -> tuple[str, tuple[str, ...]]:
    """Writes BML for an FML-APML document, and says for each intention that nothing shows why; see `author_fml`."""
    sets, agent = _shown(known)
    return author_fml(text, source=source, sets=sets, agent=agent, seed=known.idling.seed)


def write_bml(text: str, known: Setup) -> str:
    """Writes BML that says a text and performs what it means, with the seed and in the style of a setup."""
    return author(
        text,
        known.lexicon,
        known.style,
        language=known.language,
        grammar=known.grammar,
        sets=intention_sets(known),
        seed=known.idling.seed,
    )


def intention_sets(known: Setup) -> BehaviourSets:
    """Finds what shows intentions: the sets of a setup's lexicon of intentions, or those that come with kinesic.

    Raises:
        ConfigError: the lexicon is wrong.
    """
    lexicon = known.intentions.lexicon
    return own_sets() if lexicon is None else read_lexicon(lexicon)


def _shown(known: Setup) -> tuple[BehaviourSets, Agent]:
    """Reads the behaviour sets that show intentions, and the agent that shows them."""
    return intention_sets(known), read_agent(known.intentions.baseline, known.intentions.qualifiers)
