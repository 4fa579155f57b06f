"""Reader of documents (BML, FML-APML or plain text) as planning blocks."""

import re
from bisect import bisect_left
from dataclasses import replace
from functools import partial
from itertools import accumulate

from kinesic.bml.block import Block, BmlError, DocumentBounds, Notice, NoticeType
from kinesic.bml.parse import parse
from kinesic.bml.reading.prologue import find_first_tag
from kinesic.bml.reading.wrapping import open_document
from kinesic.intent.author import AuthoredText, author_text
from kinesic.intent.behaviour_sets import BehaviourSets, builtin_sets
from kinesic.intent.fml.author import author_fml, is_fml, parse_fml
from kinesic.intent.greta.agent import Agent, read_agent
from kinesic.intent.greta.lexicon import read_lexicon
from kinesic.intent.manuscript.decoding import decode_text
from kinesic.intent.pacing.memory import NO_MEMORY, ChoiceMemory, Revision
from kinesic.intent.recorded import RecordedAudio
from kinesic.planning.setup import Setup

MAX_TEXT_WORDS = 4000  # largest number of spoken words of one plan, about 27 minutes
MAX_TEXT_DURATION = 2400.0  # [s] maximum duration of the plan of a text
# Limits of the BML written for a text: size [bytes], numbers of elements and behaviours.
TEXT_BOUNDS = DocumentBounds(size=40_000_000, elements=200_000, behaviours=50_000)
_WORD_PATTERN = re.compile(r"\w+(?:['\u2019.,-]\w+)*")  # spoken word, with inner apostrophes and hyphens
TEXT_SUFFIXES = (".txt", ".md", ".markdown", ".srt", ".vtt", ".ssml")  # suffixes of files with text to be spoken


def is_spoken_file(name: str, content: str | bytes) -> bool:
    """Return whether a file holds spoken text, by suffix or SSML root."""
    return name.lower().endswith(TEXT_SUFFIXES) or is_ssml(content)


def is_ssml(text: str | bytes) -> bool:
    """Return whether a document is SSML, with the root element `speak`."""
    start = text if isinstance(text, str) else decode_text(text)[0]
    return find_first_tag(start.lstrip("\ufeff")) == "speak"


def read_block(text: str | bytes, setup: Setup, *, source: str = "<text>") -> Block:
    """Read the block of a BML, FML or SSML document.

    The setup's lexicon and agent turn intentions of FML into behaviours.

    Args:
        text: of the document.
        setup: dialect, character and intention files.
        source: name of the document in messages and reports.

    Raises:
        BmlError: the document is refused.
        ConfigError: an intention file is invalid.
    """
    if setup.dialect in ("auto", "fml-apml") and is_fml(text):
        sets, agent = _read_intention_files(setup)
        seed = setup.idling.seed
        return parse_fml(
            text,
            source=source,
            performer=setup.character,
            sets=sets,
            agent=agent,
            seed=seed,
            revise=find_revision(setup),
        )
    opened = open_document(text)
    if is_ssml(opened.text):
        block = read_plain_text(opened.text, setup, source=source)
        around = (Notice(NoticeType.PARSING_FAILURE, block.id, part) for part in opened.surroundings)
        return replace(block, notices=(*around, *block.notices))
    return parse(text, source=source, dialect=setup.dialect, performer=setup.character, recordings=setup.recordings)


def read_plain_text(text: str | bytes, setup: Setup, *, source: str) -> Block:
    """Turn a text into a block of speech and gestures.

    Its notices list the parts of the text that are neither spoken nor performed.

    Args:
        text: to be spoken, or the content of its file.
        setup: style, seed and language.
        source: name of the text in messages and reports.

    Raises:
        BmlError: the text has too many words for one plan.
    """
    written = write_text(text, setup)
    if written.words > MAX_TEXT_WORDS:
        raise BmlError(_describe_length(text if isinstance(text, str) else decode_text(text)[0], written.words, source))
    block = parse(written.bml, source=source, dialect=setup.dialect, performer=setup.character, bounds=TEXT_BOUNDS)
    notices = tuple(Notice(NoticeType.CANNOT_CREATE_BEHAVIOR, block.id, warning) for warning in written.warnings)
    return replace(block, notices=(*block.notices, *notices), max_duration=MAX_TEXT_DURATION)


def _describe_length(text: str, words: int, source: str) -> str:
    """Return the error message for a text too long for one plan.

    It names the line up to which the text would fit.
    """
    counts = list(accumulate(len(_WORD_PATTERN.findall(line)) for line in text.splitlines()))
    line = bisect_left(counts, counts[-1] * MAX_TEXT_WORDS / words) + 1
    place = "" if len(counts) == 1 else f", up to about line {line}"
    remedy = "divide the text, or stream it with `kinesic say - < FILE`, without a report"
    return f"{source}: {words} words; a plan holds {MAX_TEXT_WORDS}{place}: {remedy}"


def write_fml(text: str | bytes, setup: Setup, *, source: str = "<text>") -> tuple[str, tuple[str, ...]]:
    """Convert an FML-APML document to BML.

    Returns:
        BML, and a line for each intention that no behaviour shows; see `author_fml`.
    """
    sets, agent = _read_intention_files(setup)
    return author_fml(text, source=source, sets=sets, agent=agent, seed=setup.idling.seed, revise=find_revision(setup))


def write_bml(text: str, setup: Setup) -> str:
    """Convert a text to BML with speech and matching gestures.

    Style, seed and language are those of the setup.
    """
    return write_text(text, setup).bml


def write_text(text: str | bytes, setup: Setup, memory: ChoiceMemory = NO_MEMORY) -> AuthoredText:
    """Convert a text, or a text file's content, to BML with warnings.

    Style, seed and language are those of the setup.

    Args:
        text: to be spoken, or the content of its file.
        setup: style, seed and language.
        memory: gestures of earlier texts, which are not repeated for a minute of speech.
    """
    spoken, warnings = (text, ()) if isinstance(text, str) else decode_text(text)
    written = author_with_setup(spoken, setup, memory=memory)
    return replace(written, warnings=(*warnings, *written.warnings))


def author_with_setup(
    text: str, setup: Setup, *, memory: ChoiceMemory = NO_MEMORY, recorded: RecordedAudio | None = None
) -> AuthoredText:
    """Write BML for a text with the options of a setup.

    Args:
        text: to be spoken.
        setup: lexicon, style, language, grammar, intentions, seed and character.
        memory: gestures of earlier texts, which are not repeated for a minute of speech.
        recorded: recording that speaks the text; None: the voice of the setup.
    """
    return author_text(
        text,
        setup.lexicon,
        setup.style,
        language=setup.language,
        grammar=setup.grammar,
        sets=intention_sets(setup),
        seed=setup.idling.seed,
        memory=memory,
        character=setup.character or "",
        recorded=recorded,
        revise=find_revision(setup),
    )


def find_revision(setup: Setup) -> Revision | None:
    """Return the function that replaces lexicon gestures by captured ones, if preferred."""
    if setup.preference == "lexicon" or not setup.lexicon.captured:
        return None
    from kinesic.capture.clip_substitution import prefer_captured  # noqa: PLC0415 - needs SciPy

    return partial(prefer_captured, setup=setup)


def prepare_revision(setup: Setup) -> None:
    """Build the motion graph of a setup's captured gestures, if preferred."""
    if find_revision(setup) is not None:
        from kinesic.capture.clip_substitution import graph_of  # noqa: PLC0415 - needs SciPy

        graph_of(setup.lexicon.captured)


def intention_sets(setup: Setup) -> BehaviourSets:
    """Return the behaviour sets that express intentions of a document.

    They come from the setup's lexicon of intentions, or from kinesic's own without one.

    Raises:
        ConfigError: the lexicon is invalid.
    """
    lexicon = setup.intentions.lexicon
    return builtin_sets() if lexicon is None else read_lexicon(lexicon)


def _read_intention_files(setup: Setup) -> tuple[BehaviourSets, Agent]:
    """Read the intention files of a setup: behaviour sets and agent."""
    return intention_sets(setup), read_agent(setup.intentions.baseline, setup.intentions.qualifiers)
