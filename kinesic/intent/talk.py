"""Streamed text: complete phrases, and their speech and behaviours."""

import re
from collections.abc import Collection
from dataclasses import dataclass, field, replace
from functools import partial

from kinesic.body.choices import GrammarName
from kinesic.body.scripts import SENTENCE_STOPS, UNSPACED_STOPS
from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.expressivity.style.style import Style
from kinesic.intent.author import PLAIN_STYLE, add_accents, merge_directed, reach_directed, reachable
from kinesic.intent.behaviour_sets import BehaviourSets
from kinesic.intent.behaviours import ChosenBehaviour, Earlier
from kinesic.intent.choosing import choose_behaviours
from kinesic.intent.directed import find_directed
from kinesic.intent.manuscript.pieces import Manuscript
from kinesic.intent.manuscript.reading import read_more
from kinesic.intent.manuscript.subtitles import read_more_subtitles
from kinesic.intent.meaning.reader import read_meanings
from kinesic.intent.pacing.long_strokes import slowness_of
from kinesic.intent.pacing.memory import NO_MEMORY, TURN_PAUSE, ChoiceMemory, Revision
from kinesic.intent.pacing.progress import NO_PROGRESS, Progress
from kinesic.intent.pacing.tempo import liveliness_of
from kinesic.intent.part_words import clip_intent, select_words
from kinesic.intent.reading.language import Language
from kinesic.intent.reading.passage import Passage, word_duration
from kinesic.intent.reading.prosody import reopen
from kinesic.intent.reading.words import read_text
from kinesic.intent.writing import name_behaviours, write_block

SETTLING_TIME = 0.12  # [s] silence of the sender that completes the last word and short punctuated phrases
MAX_SILENCE = 2.0  # [s] silence of the sender after which an incomplete phrase is spoken
LETTERS_PER_WINDOW = 800  # number of letters of streamed text that are read at once
LONGEST_PHRASE = 16  # [words] longest incomplete phrase that waits for its end
SHORT_PHRASE = 3  # [words] complete phrases below this length wait briefly for more input
PART_PAUSE = 0.3  # [s] silence assumed between two parts of a text
CONTEXT_WORDS = 60  # [words] a shorter spoken part of a sentence is kept as context
_WORD_END = re.compile(rf"<[^<>]*>|\s|[{UNSPACED_STOPS}]")  # pattern of a tag or character that ends a word
_OPEN_TAG = re.compile(r"<[^<>]*$")
_DIRECTION_PATTERN = re.compile(r"<kinesic:act[^<>]*>")


@dataclass(frozen=True)
class Talk:
    """State of a streamed text: received, spoken and shown parts."""

    text: str = ""  # received text from the sentence of the next word on, with markup as XML tags
    said: int = 0  # number of spoken words of `text`
    progress: Progress = NO_PROGRESS  # spoken words and shown gestures in total
    parts: int = 0  # number of spoken parts
    shown: tuple[tuple[str, ChosenBehaviour], ...] = ()  # (id, behaviour) of the last part, with times in `text`
    is_over: bool = False  # whether the text is complete
    manuscript: Manuscript = field(default_factory=Manuscript)  # state of the reader, with incomplete text
    warnings: tuple[str, ...] = ()  # parts of the text since the last part that are neither spoken nor performed
    memory: ChoiceMemory = NO_MEMORY  # gestures of earlier texts and parts

    @property
    def length(self) -> int:
        """Number of stored characters of the streamed text, parsed or not."""
        return len(self.text) + len(self.manuscript.waiting)


@dataclass(frozen=True)
class Part:
    """Next phrases of a streamed text, with their behaviours."""

    talk: Talk  # state after this part
    passage: Passage
    words: range  # indices of the spoken words in the passage
    behaviours: tuple[ChosenBehaviour, ...]
    replaced: frozenset[str]  # ids of replaced behaviours of the preceding part
    gap: float  # [s] silence before this part
    warnings: tuple[str, ...] = ()  # parts of the text that are neither spoken nor performed

    @property
    def text(self) -> str:
        """Spoken words of the phrases."""
        return " ".join(self.passage.words[k].text for k in self.words)

    @property
    def written(self) -> str:
        """Text of the phrases with punctuation."""
        words, stop = self.passage.words, self.words.stop
        spoken = "".join(f"{words[k].before}{words[k].text}" for k in self.words)
        opening = len(words[self.words.start].before.rpartition(" ")[0])  # ends the phrase before
        after = words[stop].before if stop < len(words) else self.passage.tail
        return " ".join(f"{spoken[opening:]}{after.partition(' ')[0]}".split())

    def write(self, block: str, start: str = "") -> str:
        """Write the phrases and their behaviours as BML.

        See `write_block`.
        """
        return write_block(self.passage, self.behaviours, block=block, words=self.words, start=start)


def add_words(talk: Talk, text: str, *, ends: bool = False, instead: bool = False) -> Talk:
    """Add received words to a streamed text.

    Args:
        talk: current state.
        text: received text; words may be divided.
        ends: whether the text is complete.
        instead: whether it replaces the text that is not spoken yet.
    """
    if instead:
        talk = replace(
            talk, text="", said=0, shown=_shift_earlier(talk.shown, 0.0), manuscript=talk.manuscript.restarted()
        )
    before = talk.text
    if talk.is_over and before.strip():
        before = before.rstrip() + (" " if before.rstrip()[-1] in SENTENCE_STOPS else ". ")
    manuscript, spoken, warnings = read_more(talk.manuscript, text, ends=ends)
    warnings = (*talk.warnings, *warnings)
    return replace(talk, text=before + spoken, is_over=ends, manuscript=manuscript, warnings=warnings)


def _settle(talk: Talk, quiet: float) -> Talk:
    """Read incomplete markup as plain text if the sender stays silent."""
    if not talk.manuscript.waiting.strip() or quiet < MAX_SILENCE or talk.manuscript.mode != "text":
        return talk
    settled = add_words(talk, "", ends=True)
    if talk.is_over:
        return settled
    subtitles, _ = read_more_subtitles(talk.manuscript.subtitles, "", ends=True)
    manuscript = replace(settled.manuscript, subtitles=subtitles, is_line_start=False)
    return replace(settled, is_over=False, manuscript=manuscript)


def next_part(
    talk: Talk,
    lexicon: Lexicon,
    style: Style,
    language: Language,
    sets: BehaviourSets,
    *,
    grammar: GrammarName = "rules",
    quiet: float = 0.0,
    free: Collection[str] = (),
    seed: int = 0,
    revise: Revision | None = None,
) -> Part | None:
    """Choose the next phrases to speak, with their behaviours.

    Args:
        talk: current state.
        lexicon: gestures that may illustrate its words.
        style: of the performance.
        language: its rules.
        sets: behaviours by intent.
        grammar: method that finds phrases and clauses.
        quiet: time since the last received words [s].
        free: ids of behaviours of the last part that have not begun, and may be replaced by more certain ones.
        seed: of the random choice among alternatives.
        revise: replaces gestures of the chosen behaviours; None: they stay.

    Returns:
        None without a complete phrase.
    """
    talk, passage, gap = _drop_sentences(_settle(talk, quiet), language, quiet)
    words = range(talk.said, _count_complete_words(passage, talk, quiet))
    if not words:
        return _perform_trailing(talk, passage, lexicon, quiet)
    words = select_words(passage, words)
    begins, ends = (
        talk.parts == 0,
        talk.is_over and words.stop == len(passage.words) and len(talk.text) < LETTERS_PER_WINDOW,
    )
    meanings = read_meanings(
        passage, language, lexicon, grammar=grammar, begins=begins, ends=ends, liveliness=liveliness_of(style)
    )
    accented, end = add_accents(meanings, passage), passage.starts[words.stop]
    intents = [clip_intent(intent, passage, words) for intent in accented if intent.stroke.seconds < end]
    intents = intents if style.name == PLAIN_STYLE else [replace(intent, style="") for intent in intents]
    directed = find_directed(passage, lexicon, words, is_last=ends)
    since, slowness = passage.starts[words.start], slowness_of(style)
    asked = tuple(reach_directed(behaviour, since, slowness=slowness) for behaviour in directed.behaviours)
    duration = passage.starts[words.stop - 1] + word_duration(passage.words[words.stop - 1]) - since
    free_behaviours = tuple(behaviour for id, behaviour in talk.shown if id in free)
    earlier = Earlier(
        (*(behaviour for id, behaviour in talk.shown if id not in free), *asked),
        free_behaviours,
        talk.progress.gestures,
        talk.progress.pictures,
        talk.progress.seconds,
    )
    selection = choose_behaviours(
        intents,
        sets,
        talk.progress.budget(duration, style, free_behaviours),
        seed=seed,
        since=since,
        earlier=earlier,
        memory=talk.memory,
        reachable=partial(reachable, since=since, slowness=slowness),
    )
    behaviours = merge_directed(selection.behaviours, asked, since, slowness=slowness)
    written = behaviours if revise is None else tuple(revise(behaviours, talk.memory.list_clips(since)))
    replaced = frozenset(id for id, behaviour in talk.shown if behaviour in selection.replaced)
    pause = TURN_PAUSE if ends else PART_PAUSE
    after = replace(
        _forget_directions(talk, passage) if ends else talk,
        said=words.stop,
        progress=talk.progress.extend(len(words), duration + pause, behaviours, selection.replaced),
        parts=talk.parts + 1,
        shown=tuple(name_behaviours(behaviours)),
        warnings=(),
        memory=talk.memory.extend(
            behaviours, duration, since=since, replaced=selection.replaced, pause=pause, written=written
        ),
    )
    lacking = (language.warning,) if begins and language.warning else ()
    return Part(after, passage, words, written, replaced, gap, (*lacking, *talk.warnings, *directed.warnings))


def _perform_trailing(talk: Talk, passage: Passage, lexicon: Lexicon, quiet: float) -> Part | None:
    """Return a part that performs the trailing stage directions, or None.

    They follow the last word, and wait until the text is complete or the sender has been silent for `MAX_SILENCE`.
    """
    directions = _trailing_directions(talk, passage)
    if not directions or not (talk.is_over or quiet >= MAX_SILENCE):
        return None
    silent = Passage((), (), language=passage.language, directions=tuple((0, words) for words in directions))
    directed = find_directed(silent, lexicon)
    after = replace(_forget_directions(talk, passage), parts=talk.parts + 1, shown=(), warnings=())
    warnings = (*talk.warnings, *directed.warnings)
    return Part(after, silent, range(0), directed.behaviours, frozenset(), 0.0, warnings)


def _trailing_directions(talk: Talk, passage: Passage) -> tuple[str, ...]:
    """Return the stage directions after the last word, once it is spoken."""
    if talk.said < len(passage.words):
        return ()
    return tuple(words for index, words in passage.directions if index >= talk.said)


def _forget_directions(talk: Talk, passage: Passage) -> Talk:
    """Remove the performed stage directions after the last word."""
    end = passage.words[-1].end if passage.words else 0
    return replace(talk, text=talk.text[:end] + _DIRECTION_PATTERN.sub(" ", talk.text[end:]))


def is_all_said(talk: Talk, language: Language) -> bool:
    """Return whether a complete streamed text has no unplanned words left."""
    if not talk.is_over:
        return False
    rest, passage, _ = _drop_sentences(talk, language, MAX_SILENCE)
    return len(passage.words) <= rest.said and not _trailing_directions(rest, passage)


def _read(talk: Talk, language: Language, quiet: float) -> Passage:
    """Read the streamed text up to its last complete word."""
    text = talk.text[:LETTERS_PER_WINDOW]
    is_cut = len(text) == LETTERS_PER_WINDOW
    if is_cut or not (talk.is_over or quiet >= SETTLING_TIME):
        text = _OPEN_TAG.sub("", text) if is_cut else text
        ends = [end.end() for end in _WORD_END.finditer(text)]
        text = text[: ends[-1] if ends else LETTERS_PER_WINDOW * is_cut]
    return read_text(text, language)


def _drop_sentences(talk: Talk, language: Language, quiet: float) -> tuple[Talk, Passage, float]:
    """Drop spoken sentences once the following sentence has begun.

    Returns:
        The talk, its passage, and the silence before the next word [s].
    """
    passage = _read(talk, language, quiet)
    while len(talk.text) >= LETTERS_PER_WINDOW and talk.said == len(passage.words):  # more text follows this window
        end = passage.words[-1].end if passage.words else LETTERS_PER_WINDOW
        opening = reopen(passage.words[-1].prosody) if passage.words else ""
        talk = replace(
            talk, text=opening + talk.text[end:], said=0, shown=_shift_earlier(talk.shown, passage.starts[-1])
        )
        passage = _read(talk, language, quiet)
    words, said = passage.words, talk.said
    if not 0 < said < len(words):
        return talk, passage, 0.0
    gap = passage.starts[said] - passage.starts[said - 1] - word_duration(words[said - 1])
    if words[said].sentence == words[said - 1].sentence and said < CONTEXT_WORDS:
        return talk, passage, gap
    between = re.compile(rf"(?:{language.emoticon}|[^\w*_<])*")
    start = words[said - 1].end
    selection = between.match(talk.text, start)
    rest = reopen(words[said - 1].prosody) + talk.text[selection.end() if selection else start :]
    talk = replace(talk, text=rest, said=0, shown=_shift_earlier(talk.shown, passage.starts[said]))
    return talk, _read(talk, language, quiet), gap


def _shift_earlier(
    shown: tuple[tuple[str, ChosenBehaviour], ...], seconds: float
) -> tuple[tuple[str, ChosenBehaviour], ...]:
    """Subtract seconds from the estimated times of shown behaviours."""
    return tuple((id, replace(behaviour, intent=behaviour.intent.counted_from(seconds))) for id, behaviour in shown)


def _count_complete_words(passage: Passage, talk: Talk, quiet: float) -> int:
    """Return the number of words in complete phrases.

    An incomplete phrase also counts if it is long, or after a silence of the sender.
    """
    words, count = passage.words, len(passage.words)
    if (talk.is_over or quiet >= MAX_SILENCE) and len(talk.text) < LETTERS_PER_WINDOW:
        return count
    if not words:
        return 0
    last = passage.phrases[-1]
    complete = count if passage.is_over else last[0]
    if complete <= talk.said and (count - talk.said > LONGEST_PHRASE or len(talk.text) >= LETTERS_PER_WINDOW):
        return max(count - 1, talk.said + 1)
    is_sentence = complete and passage.is_over and passage.tail[-1:] in SENTENCE_STOPS
    is_short = complete - talk.said < SHORT_PHRASE and complete == count and not is_sentence
    return talk.said if is_short and quiet < SETTLING_TIME else max(complete, talk.said)
