"""What was said and meant: the words of a plan, and under each the behaviours that peak while it sounds."""

from bisect import bisect_right
from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import pairwise
from math import inf

from kinesic.bml.block import Speech
from kinesic.planning.captions import Caption, captions
from kinesic.planning.plan import Plan
from kinesic.report.labels import label

PEAK_SYNCS = ("stroke", "strokeStart", "attackPeak", "ready", "start")  # the first that a behaviour has is its peak
MOST_WORDS = 400  # of a longer text the rest is one piece without words
PAUSE = 0.5  # [s] without a word that are a piece of their own
SAME_TIME = 1e-6  # [s]


@dataclass(frozen=True)
class PeakingBehaviour:
    """A behaviour that is performed, at the moment for which it stands in the transcript."""

    label: str
    outcome: str  # as in `Outcome.kind`
    peak: float  # [s] performance time


@dataclass(frozen=True)
class TranscriptPiece:
    """A word, or a time without words, with the behaviours that peak in it."""

    word: str  # empty: a time without words
    begin: float  # [s] performance time; -inf before the first word
    end: float  # [s] performance time; inf after the last word
    behaviours: tuple[PeakingBehaviour, ...] = ()


def transcribe(plan: Plan) -> tuple[TranscriptPiece, ...]:
    """Lists the words of a plan with the behaviours that peak in each; times without words only where one does.

    Words between two marks of a speech share the time in proportion to their letters.
    """
    pieces = tuple(_pieces(plan))
    begins = [piece.begin for piece in pieces]
    found: list[list[PeakingBehaviour]] = [[] for _ in pieces]
    for behaviour in sorted(_peaking_behaviours(plan), key=lambda each: each.peak):
        found[bisect_right(begins, behaviour.peak + SAME_TIME) - 1].append(behaviour)
    whole = (replace(piece, behaviours=tuple(here)) for piece, here in zip(pieces, found, strict=True))
    return tuple(piece for piece in whole if piece.word or piece.behaviours)


def _pieces(plan: Plan) -> Iterator[TranscriptPiece]:
    """Words and the times between them, without a gap from -inf to inf."""
    words = sorted((word for caption in captions(plan) for word in _words(caption)), key=lambda word: word.begin)
    shown = words[:MOST_WORDS]
    if not shown:
        yield TranscriptPiece("", -inf, inf)
        return
    yield TranscriptPiece("", -inf, shown[0].begin)
    yield shown[0]
    for before, word in pairwise(shown):
        if word.begin - before.end > PAUSE:
            yield TranscriptPiece("", before.end, word.begin)
        yield word
    yield TranscriptPiece("", max(word.end for word in shown), inf)


def _words(caption: Caption) -> Iterator[TranscriptPiece]:
    """The words of a caption, each as long as its share of the letters."""
    words = caption.text.split()
    letters = sum(len(word) + 1 for word in words)
    begin = caption.begin
    for word in words:
        end = begin + (caption.end - caption.begin) * (len(word) + 1) / letters
        yield TranscriptPiece(word, begin, end)
        begin = end


def _peaking_behaviours(plan: Plan) -> Iterator[PeakingBehaviour]:
    """All behaviours with sync points but speech and what is dropped."""
    syncs = {(sync.behaviour, sync.sync): sync.planned for sync in plan.syncs}
    for behaviour in plan.timeline.block.behaviours:
        peak = next((syncs[behaviour.id, name] for name in PEAK_SYNCS if (behaviour.id, name) in syncs), None)
        outcome = plan.keyframes.outcomes[behaviour.id].kind
        if peak is not None and outcome != "dropped" and not isinstance(behaviour.action, Speech):
            yield PeakingBehaviour(label(behaviour), outcome, plan.trajectory.zero + peak)
