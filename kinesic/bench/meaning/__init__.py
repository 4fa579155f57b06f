"""Measures what texts become: how many gestures, on which syllables, and how long it takes to write them."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from time import process_time

import numpy as np

from kinesic.bench.figure import Figure
from kinesic.bench.meaning import streaming
from kinesic.bench.meaning.sentences import deictic_sentences, prose
from kinesic.bml.parse import parse
from kinesic.body.choices import GrammarName
from kinesic.controller.perform import set_up
from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.expressivity.style.style import Style
from kinesic.intent.author import author, plan_behaviours
from kinesic.intent.choosing import DENIALS, NODS, ChosenBehaviour
from kinesic.intent.reading.language import load_language
from kinesic.intent.reading.passage import Passage
from kinesic.intent.reading.spacy_parser import parser_fault
from kinesic.intent.reading.text import find_intents
from kinesic.intent.reading.words import read_text
from kinesic.planning.plan import plan_block

SENTENCES = 1000
TOGETHER = 5  # sentences of a text
PLANNED = 10  # texts that are planned, too
WITHIN = 3  # gestures within which none comes again
POINTS = ("deictic-me", "deictic-you", "world-place-there", "world-place-here")


@dataclass(frozen=True)
class Written:
    """A text and what was chosen for it."""

    passage: Passage
    behaviours: Sequence[ChosenBehaviour]
    seconds: float  # of CPU that writing its BML took

    @property
    def gestures(self) -> Sequence[ChosenBehaviour]:
        """What its hands do."""
        return [each for each in self.behaviours if each.channel == "gesture"]


def bench() -> Iterable[Figure]:
    """Measures texts of a thousand sentences, and two hundred sentences that point or do not."""
    lexicon, style = Lexicon.load(), Style.load("neutral")
    sentences = prose(SENTENCES)
    texts = [" ".join(sentences[k : k + TOGETHER]) for k in range(0, SENTENCES, TOGETHER)]
    author(texts[0], lexicon, style)  # what is read once is read before
    written = [_write(text, lexicon, style) for text in texts]
    words = sum(len(each.passage.words) for each in written)
    gestures = sum(len(each.gestures) for each in written)
    yield Figure("meaning.gestures_least", 100 * gestures / words, "per 100 words", 5.0, "higher")
    yield Figure("meaning.gestures_most", 100 * gestures / words, "per 100 words", 10.0, "lower")
    yield Figure("meaning.strokes_on_stress", 100 * _stressed(written), "%", 90.0, "higher")
    yield Figure("meaning.nods_on_negations", sum(map(_nods, written)), "nods", 0.0, "lower")
    yield Figure("meaning.repeats", sum(map(_repeats, written)), "gestures", 0.0, "lower")
    yield Figure("meaning.deixis", 100 * _deixis(lexicon), "%", 98.0, "higher")
    slow = float(np.percentile([each.seconds for each in written], 95))
    yield Figure("meaning.write_p95", 1000 * slow, "ms", 20.0, "lower")
    yield _parsed(texts, lexicon, style)
    yield Figure("meaning.dropped", sum(_dropped(texts[:PLANNED])), "behaviours", 0.0, "lower")
    yield from streaming.bench()


def _parsed(texts: Iterable[str], lexicon: Lexicon, style: Style) -> Figure:
    """How long texts take that spaCy parses."""
    why, slow = parser_fault(), None
    if not why:
        author("Hello", lexicon, style, grammar="spacy")  # the model is loaded
        slow = 1000 * float(np.percentile([_seconds(text, lexicon, style, "spacy") for text in texts], 95))
    return Figure("meaning.write_spacy_p95", slow, "ms", 150.0, "lower", why=why)


def _seconds(text: str, lexicon: Lexicon, style: Style, grammar: GrammarName) -> float:
    """CPU time that writing the BML of a text takes [s]."""
    began = process_time()
    author(text, lexicon, style, grammar=grammar)
    return process_time() - began


def _write(text: str, lexicon: Lexicon, style: Style) -> Written:
    seconds = _seconds(text, lexicon, style, "rules")
    passage, selection = plan_behaviours(text, lexicon, style)
    return Written(passage, selection.behaviours, seconds)


def _stressed(written: Iterable[Written]) -> float:
    """The share of strokes that are on the stressed syllable of a content word, or of one that the writer stresses."""
    hits = []
    for each in written:
        words = each.passage.words
        heavy = {each.passage.stress(k).reference for k, word in enumerate(words) if word.is_content or word.emphatic}
        hits += [gesture.intent.stroke.reference in heavy for gesture in each.gestures]
    return float(np.mean(hits))


def _nods(written: Written) -> int:
    """How many nods are within what is denied."""
    denied = [each.intent for each in written.behaviours if each.intent.name in DENIALS]
    nods = [each.intent.stroke.seconds for each in written.behaviours if each.lexeme == NODS]
    return sum(any(no.start.seconds <= at <= no.end.seconds for no in denied) for at in nods)


def _repeats(written: Written) -> int:
    """How many gestures are like one of the two before them."""
    names = [each.lexeme for each in written.gestures]
    return sum(name in names[max(0, k - WITHIN + 1) : k] for k, name in enumerate(names))


def _deixis(lexicon: Lexicon) -> float:
    """The share of sentences in which what points is found, and nothing where nothing does."""
    language = load_language()
    right = []
    for text, expected in deictic_sentences():
        found = {each.name for each in find_intents(read_text(text, language), language, lexicon)} & set(POINTS)
        right.append(expected in found if expected else not found)
    return float(np.mean(right))


def _dropped(texts: Iterable[str]) -> Iterator[int]:
    """How many behaviours of each text are dropped when it is planned."""
    known = set_up()
    for text in texts:
        yield len(plan_block(parse(author(text, known.lexicon, known.style)), known).timeline.dropped)
