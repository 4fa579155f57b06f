"""Reader of documents (BML, FML-APML or plain text) as planning blocks."""

from dataclasses import replace
from functools import partial

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
from kinesic.intent.manuscript.pieces import SpokenText
from kinesic.intent.pacing.memory import NO_MEMORY, ChoiceMemory, Revision
from kinesic.intent.recorded import RecordedAudio
from kinesic.intent.text_parts import MAX_TEXT_WORDS, divide_long_text
from kinesic.planning.setup import Setup
from kinesic.session.options import PlanningOptions

MAX_TEXT_DURATION = 2400.0  # [s] maximum duration of the plan of a text
# Limits of the BML written for a text: size [bytes], numbers of elements and behaviours.
TEXT_BOUNDS = DocumentBounds(size=40_000_000, elements=200_000, behaviours=50_000)
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
        remedy = "`kinesic perform FILE` divides it into parts, and `kinesic say - < FILE` streams it without a report"
        raise BmlError(f"{source}: {written.words} words; one plan holds {MAX_TEXT_WORDS}: {remedy}")
    return make_block(written, setup, source=source)


def make_block(written: AuthoredText, setup: Setup, *, source: str) -> Block:
    """Read the BML of a text, with notices of omitted parts.

    Args:
        written: BML of the text.
        setup: dialect and character.
        source: name of the text in messages and reports.
    """
    block = parse(written.bml, source=source, dialect=setup.dialect, performer=setup.character, bounds=TEXT_BOUNDS)
    notices = tuple(Notice(NoticeType.CANNOT_CREATE_BEHAVIOR, block.id, warning) for warning in written.warnings)
    return replace(block, notices=(*block.notices, *notices), max_duration=MAX_TEXT_DURATION)


def divide_long(text: str | bytes, options: PlanningOptions) -> tuple[SpokenText, ...]:
    """Divide a text that is too long for one plan.

    Args:
        text: to be spoken, or the content of its file.
        options: with language and character.

    Returns:
        Its parts; nothing if it fits into one plan.
    """
    written, warnings = (text, ()) if isinstance(text, str) else decode_text(text)
    parts = divide_long_text(written, language=options.get("language", "en"), character=options.get("character") or "")
    return (SpokenText(parts[0].text, (*warnings, *parts[0].warnings)), *parts[1:]) if len(parts) > 1 else ()


def write_fml(text: str | bytes, setup: Setup, *, source: str = "<text>") -> tuple[str, tuple[str, ...]]:
    """Convert an FML-APML document to BML.

    Returns:
        BML, and a warning for each intention that is unknown or not shown; see `author_fml`.
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
    text: str | SpokenText, setup: Setup, *, memory: ChoiceMemory = NO_MEMORY, recorded: RecordedAudio | None = None
) -> AuthoredText:
    """Write BML for a text with the options of a setup.

    Args:
        text: to be spoken, or a part of a long text.
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
