"""Benchmark of gestures for texts: gesture rate, stressed syllables, computing time."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from time import process_time

import numpy as np

from kinesic.bench.blocks import find_corpus
from kinesic.bench.meaning import judged, rhythm, streaming
from kinesic.bench.meaning.sentences import deictic_sentences, prose
from kinesic.bench.metric import Metric
from kinesic.bml.parse import parse
from kinesic.body.choices import GrammarName
from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.expressivity.style.style import Style
from kinesic.intent.author import author, plan_behaviours
from kinesic.intent.behaviours import ChosenBehaviour
from kinesic.intent.choosing import NEGATION_INTENTS
from kinesic.intent.pacing.long_strokes import LONG_STROKES
from kinesic.intent.pacing.spacing import NOD_LEXEME
from kinesic.intent.reading.language import load_language
from kinesic.intent.reading.passage import Passage
from kinesic.intent.reading.spacy_parser import parser_fault
from kinesic.intent.reading.text import find_intents
from kinesic.intent.reading.words import read_text
from kinesic.planning.plan import plan_block
from kinesic.session.setup import set_up

SENTENCE_COUNT = 1000  # generated sentences in all texts together
SENTENCES_PER_TEXT = 5  # sentences per text
PLANNED_TEXTS = 10  # number of texts that are also planned
REPEAT_WINDOW = 3  # successive gestures that must all differ
# Intents that the deictic sentences must give.
DEICTIC_INTENTS = ("deictic-me", "deictic-you", "world-place-there", "world-place-here")


@dataclass(frozen=True)
class GesturedText:
    """A text and the behaviours chosen for it."""

    passage: Passage
    behaviours: Sequence[ChosenBehaviour]
    seconds: float  # [s] CPU time to write its BML

    @property
    def gestures(self) -> Sequence[ChosenBehaviour]:
        """Hand gestures among the chosen behaviours."""
        return [behaviour for behaviour in self.behaviours if behaviour.channel == "gesture"]


def bench() -> Iterable[Metric]:
    """Measure gesture choice, timing and computing time for several kinds of texts."""
    lexicon, style = Lexicon.load(), Style.load("neutral")
    sentences = prose(SENTENCE_COUNT)
    texts = [" ".join(sentences[k : k + SENTENCES_PER_TEXT]) for k in range(0, SENTENCE_COUNT, SENTENCES_PER_TEXT)]
    author(texts[0], lexicon, style)  # caches one-time data
    written = [_author_text(text, lexicon, style) for text in texts]
    words = sum(len(text.passage.words) for text in written)
    gestures = sum(len(text.gestures) for text in written)
    yield Metric("meaning.gestures_least", 100 * gestures / words, "per 100 words", 5.0, "higher")
    yield Metric("meaning.gestures_most", 100 * gestures / words, "per 100 words", 13.0, "lower")
    yield Metric("meaning.strokes_on_stress", 100 * _stressed_fraction(written), "%", 90.0, "higher")
    yield Metric("meaning.nods_on_negations", sum(map(_count_negated_nods, written)), "nods", 0.0, "lower")
    yield Metric("meaning.repeats", sum(map(_count_repeats, written)), "gestures", 0.0, "lower")
    yield Metric("meaning.deixis", 100 * _deixis_accuracy(lexicon), "%", 98.0, "higher")
    slow = float(np.percentile([text.seconds for text in written], 95))
    yield Metric("meaning.write_p95", 1000 * slow, "ms", 20.0, "lower")
    yield _measure_spacy(texts, lexicon, style)
    yield Metric("meaning.dropped", sum(_count_dropped(texts[:PLANNED_TEXTS])), "behaviours", 0.0, "lower")
    yield from judged.bench(find_corpus())
    yield from rhythm.bench()
    yield from streaming.bench()


def _measure_spacy(texts: Iterable[str], lexicon: Lexicon, style: Style) -> Metric:
    """Measure the CPU time to write BML for texts parsed by spaCy."""
    why, slow = parser_fault(), None
    if not why:
        author("Hello", lexicon, style, grammar="spacy")  # loads the model
        slow = 1000 * float(np.percentile([_time_authoring(text, lexicon, style, "spacy") for text in texts], 95))
    return Metric("meaning.write_spacy_p95", slow, "ms", 150.0, "lower", why=why)


def _time_authoring(text: str, lexicon: Lexicon, style: Style, grammar: GrammarName) -> float:
    """Return the CPU time [s] to write the BML of a text."""
    began = process_time()
    author(text, lexicon, style, grammar=grammar)
    return process_time() - began


def _author_text(text: str, lexicon: Lexicon, style: Style) -> GesturedText:
    seconds = _time_authoring(text, lexicon, style, "rules")
    passage, selection = plan_behaviours(text, lexicon, style)
    return GesturedText(passage, selection.behaviours, seconds)


def _stressed_fraction(written: Iterable[GesturedText]) -> float:
    """Return the fraction of strokes on stressed syllables.

    Strokes of `LONG_STROKES`, which accompany their word instead of ending at it, are left out.
    """
    hits = []
    for text in written:
        words = text.passage.words
        heavy = {text.passage.stress(k).reference for k, word in enumerate(words) if word.is_content or word.emphatic}
        short = [gesture for gesture in text.gestures if gesture.lexeme not in LONG_STROKES]
        hits += [gesture.intent.stroke.reference in heavy for gesture in short]
    return float(np.mean(hits))


def _count_negated_nods(written: GesturedText) -> int:
    """Count the nods of a text that fall into negated phrases."""
    denied = [behaviour.intent for behaviour in written.behaviours if behaviour.intent.name in NEGATION_INTENTS]
    nods = [behaviour.intent.stroke.seconds for behaviour in written.behaviours if behaviour.lexeme == NOD_LEXEME]
    return sum(any(span.start.seconds <= time <= span.end.seconds for span in denied) for time in nods)


def _count_repeats(written: GesturedText) -> int:
    """Count gestures with the lexeme of one of the two preceding gestures."""
    names = [gesture.lexeme for gesture in written.gestures]
    return sum(name in names[max(0, k - REPEAT_WINDOW + 1) : k] for k, name in enumerate(names))


def _deixis_accuracy(lexicon: Lexicon) -> float:
    """Return the fraction of sentences whose deictic intent is detected correctly.

    Sentences without a deictic word must give none.
    """
    language = load_language()
    right = []
    for text, expected in deictic_sentences():
        intents = find_intents(read_text(text, language), language, lexicon)
        names = {intent.name for intent in intents} & set(DEICTIC_INTENTS)
        right.append(expected in names if expected else not names)
    return float(np.mean(right))


def _count_dropped(texts: Iterable[str]) -> Iterator[int]:
    """Yield the number of dropped behaviours for each planned text."""
    setup = set_up()
    for text in texts:
        yield len(plan_block(parse(author(text, setup.lexicon, setup.style)), setup).timeline.dropped)
