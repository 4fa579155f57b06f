"""A text that comes word by word: which of its phrases are whole, and what is said and shown with the next ones."""

import re
from collections.abc import Collection
from dataclasses import dataclass, replace
from functools import partial

from kinesic.body.choices import GrammarName
from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.expressivity.style.style import Style
from kinesic.intent.author import PLAIN_STYLE, hurry_first_gesture, reachable
from kinesic.intent.behaviour_sets import BehaviourSets
from kinesic.intent.budget import budget_of
from kinesic.intent.choosing import ChosenBehaviour, Earlier, choose_behaviours
from kinesic.intent.intents import Intent, Moment
from kinesic.intent.reading.language import Language
from kinesic.intent.reading.passage import Passage, word_duration
from kinesic.intent.reading.text import find_intents
from kinesic.intent.reading.words import read_text
from kinesic.intent.writing import name_behaviours, write_block

SETTLED = 0.12  # [s] without further words after which the last one is whole, and punctuation ends a phrase
SILENT = 2.0  # [s] after which what has come is said as it is
LETTERS_PER_WINDOW = 1500  # letters that are looked at
LONGEST_PHRASE = 16  # words of a phrase that waits for its end
SHORT = 3  # words below which a phrase that is no sentence waits for what follows at once
MOST_WORDS = 24  # words that are said together
CONTEXT = 60  # words of a sentence that are remembered after they were said
_STOPS = ".!?\u2026\u3002\uff01\uff1f"


@dataclass(frozen=True)
class Talk:
    """A text that comes bit by bit: as much of it as has come, and how much is said."""

    text: str = ""  # from the sentence on in which the next word stands
    said: int = 0  # words of it that are said
    words: int = 0  # that were said in all
    gestures: int = 0  # that were shown in all
    parts: int = 0  # in which they were said
    shown: tuple[tuple[str, ChosenBehaviour], ...] = ()  # what shows the last part, by its id; seconds are of `text`
    is_over: bool = False  # no further words come


@dataclass(frozen=True)
class Part:
    """The next phrases of a talk, and what is shown with them."""

    talk: Talk  # with them said
    passage: Passage
    words: range  # of the passage
    behaviours: tuple[ChosenBehaviour, ...]
    replaced: frozenset[str]  # ids of what shows the part before, and gives way
    gap: float  # [s] of silence before it

    @property
    def text(self) -> str:
        """What it says."""
        return " ".join(self.passage.words[k].text for k in self.words)

    def write(self, block: str, start: str = "") -> str:
        """Writes its BML; see `write_block`."""
        return write_block(self.passage, self.behaviours, block=block, words=self.words, start=start)


def hear(talk: Talk, text: str, *, ends: bool = False, instead: bool = False) -> Talk:
    """Adds words to a talk.

    Args:
        talk: so far.
        text: that has come; words may come in pieces.
        ends: whether no further words come.
        instead: whether they take the place of all that is not said yet.
    """
    if instead:
        talk = replace(talk, text="", said=0, shown=_earlier(talk.shown, 0.0))
    before = talk.text
    if talk.is_over and before.strip():
        before = before.rstrip() + (" " if before.rstrip()[-1] in _STOPS else ". ")
    return replace(talk, text=before + text, is_over=ends)


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
) -> Part | None:
    """Chooses what is said and shown next; None where no phrase is whole.

    Args:
        talk: so far.
        lexicon: gestures that may picture its words.
        style: in which it is performed.
        language: its rules.
        sets: behaviours by intent.
        grammar: who finds its phrases and clauses.
        quiet: [s] since words came last.
        free: ids of what shows the last part and has not begun: it may give way to what is more certain.
        seed: of what is drawn among alternatives.
    """
    talk, passage, gap = _forget_sentences(talk, language, quiet)
    words = range(talk.said, _whole(passage, talk, quiet))
    if not words:
        return None
    words = _together(passage, words)
    begins, ends = (
        talk.parts == 0,
        talk.is_over and words.stop == len(passage.words) and len(talk.text) < LETTERS_PER_WINDOW,
    )
    intents = [
        _within(each, passage, words)
        for each in find_intents(passage, language, lexicon, grammar=grammar, begins=begins, ends=ends)
        if each.stroke.seconds < passage.starts[words.stop]
    ]
    if style.name != PLAIN_STYLE:
        intents = [replace(each, style="") for each in intents]
    earlier = Earlier(
        tuple(each for id, each in talk.shown if id not in free), tuple(each for id, each in talk.shown if id in free)
    )
    spent = talk.gestures - sum(each.channel == "gesture" for each in earlier.free)
    budget = budget_of(talk.words + len(words), style)
    budget = replace(budget, gestures=max(budget.gestures - spent, 0))
    since = passage.starts[words.start]
    seed, soonest = seed + talk.parts, partial(reachable, since=since)
    found = choose_behaviours(intents, sets, budget, seed=seed, since=since, earlier=earlier, reachable=soonest)
    behaviours = tuple(hurry_first_gesture(each, since) for each in found.behaviours)
    replaced = frozenset(id for id, each in talk.shown if each in found.replaced)
    gestures = sum(each.channel == "gesture" for each in found.behaviours)
    gestures -= sum(each.channel == "gesture" for each in found.replaced)
    after = replace(
        talk,
        said=words.stop,
        words=talk.words + len(words),
        gestures=talk.gestures + gestures,
        parts=talk.parts + 1,
        shown=tuple(name_behaviours(behaviours)),
    )
    return Part(after, passage, words, behaviours, replaced, gap)


def is_all_said(talk: Talk, language: Language) -> bool:
    """Whether a talk that is over has no word left."""
    if not talk.is_over:
        return False
    rest, passage, _ = _forget_sentences(talk, language, SILENT)
    return len(passage.words) <= rest.said


def _read(talk: Talk, language: Language, quiet: float) -> Passage:
    """Reads what has come, without a last word that may go on."""
    text = talk.text[:LETTERS_PER_WINDOW]
    is_cut = len(text) == LETTERS_PER_WINDOW
    if is_cut or not (talk.is_over or quiet >= SETTLED):
        ends = [found.end() for found in re.finditer(r"\s|[\u3001\u3002\uff01\uff1f]", text)]
        text = text[: ends[-1] if ends else LETTERS_PER_WINDOW * is_cut]
    return read_text(text, language)


def _forget_sentences(talk: Talk, language: Language, quiet: float) -> tuple[Talk, Passage, float]:
    """Forgets sentences that are said once another one has begun; also tells the silence before the next word [s]."""
    passage = _read(talk, language, quiet)
    while len(talk.text) >= LETTERS_PER_WINDOW and talk.said == len(passage.words):  # there is more than is looked at
        end = passage.words[-1].end if passage.words else LETTERS_PER_WINDOW
        talk = replace(talk, text=talk.text[end:], said=0, shown=_earlier(talk.shown, passage.starts[-1]))
        passage = _read(talk, language, quiet)
    words, said = passage.words, talk.said
    if not 0 < said < len(words):
        return talk, passage, 0.0
    gap = passage.starts[said] - passage.starts[said - 1] - word_duration(words[said - 1])
    if words[said].sentence == words[said - 1].sentence and said < CONTEXT:
        return talk, passage, gap
    between = re.compile(rf"(?:{language.emoticon}|[^\w*_<])*")
    start = words[said - 1].end
    found = between.match(talk.text, start)
    rest = talk.text[found.end() if found else start :]
    talk = replace(talk, text=rest, said=0, shown=_earlier(talk.shown, passage.starts[said]))
    return talk, _read(talk, language, quiet), gap


def _earlier(shown: tuple[tuple[str, ChosenBehaviour], ...], seconds: float) -> tuple[tuple[str, ChosenBehaviour], ...]:
    """What was shown, so many seconds earlier [s]."""

    def shift(moment: Moment) -> Moment:
        return Moment(moment.reference, moment.seconds - seconds)

    def move(each: ChosenBehaviour) -> ChosenBehaviour:
        intent = each.intent
        start, stroke, end = map(shift, (intent.start, intent.stroke, intent.end))
        return replace(each, intent=replace(intent, start=start, stroke=stroke, end=end))

    return tuple((id, move(each)) for id, each in shown)


def _whole(passage: Passage, talk: Talk, quiet: float) -> int:
    """Counts the words of a passage that may be said: those of whole phrases."""
    words, count = passage.words, len(passage.words)
    if (talk.is_over or quiet >= SILENT) and len(talk.text) < LETTERS_PER_WINDOW:
        return count
    if not words:
        return 0
    last = passage.phrases[-1]
    whole = count if passage.is_over else last[0]
    if whole <= talk.said and (count - talk.said > LONGEST_PHRASE or len(talk.text) >= LETTERS_PER_WINDOW):
        return max(count - 1, talk.said + 1)
    is_sentence = whole and passage.is_over and passage.tail[-1:] in _STOPS
    is_short = whole - talk.said < SHORT and whole == count and not is_sentence
    return talk.said if is_short and quiet < SETTLED else max(whole, talk.said)


def _together(passage: Passage, words: range) -> range:
    """The words that are said together: whole sentences, else whole phrases, as many as may be."""
    most = min(words.stop, words.start + MOST_WORDS)
    sentences = [each[-1] + 1 for each in passage.sentences if words.start < each[-1] + 1 <= most]
    phrases = [each[-1] + 1 for each in passage.phrases if words.start < each[-1] + 1 <= most]
    return range(words.start, max(sentences or phrases, default=most))


def _within(intent: Intent, passage: Passage, words: range) -> Intent:
    """An intent that neither begins before some words nor ends behind them."""
    first, last = passage.onset(words.start), passage.close(words.stop - 1)
    start = first if words.start and intent.start.seconds < first.seconds else intent.start
    return replace(intent, start=start, end=last if intent.end.seconds > last.seconds else intent.end)
