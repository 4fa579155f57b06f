"""Documents written for a text, and alternative gestures for its words."""

from dataclasses import asdict, replace

from kinesic.bml.block import BmlError
from kinesic.expressivity.style.style import style_preset
from kinesic.intent.alternatives import QueriedWord, rank_alternatives
from kinesic.intent.text_parts import MAX_TEXT_WORDS
from kinesic.planning.setup import Setup
from kinesic.serve.desk.draft import Json
from kinesic.serve.wire.questions import AlternativesQuestion, AuthorQuestion
from kinesic.session.documents import intention_sets, write_text


def write_document(question: AuthorQuestion, setup: Setup) -> dict[str, Json]:
    """Write the BML document of a text, as `kinesic say` does.

    Raises:
        BmlError: the text has no words, or too many for one plan.
        ConfigError: the style is unknown.
    """
    styled = replace(setup, style=style_preset(question.style)) if question.style else setup
    written = write_text(question.text, styled)
    if not written.words:
        raise BmlError("the text has no words to speak")
    if written.words > MAX_TEXT_WORDS:
        raise BmlError(f"the text has {written.words} words, at most {MAX_TEXT_WORDS} are allowed; divide it")
    return {"bml": written.bml, "words": written.words, "warnings": list(written.warnings)}


def list_alternatives(question: AlternativesQuestion, setup: Setup) -> dict[str, Json]:
    """List the gestures that could be shown at a word, with reasons.

    Raises:
        ConfigError: the lexicon of intentions is invalid.
    """
    queried = QueriedWord(question.text, question.at, question.intent, setup.language)
    word, alternatives = rank_alternatives(queried, setup.lexicon, intention_sets(setup), setup.robot)
    return {"word": word, "gestures": [asdict(each) for each in alternatives]}
