"""Transcript of a performance: spoken words with simultaneous behaviours."""

from bisect import bisect_right
from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import pairwise
from math import inf

from kinesic.bml.block import Speech
from kinesic.planning.captions import Caption, make_captions
from kinesic.planning.plan import Plan
from kinesic.report.labels import label

PEAK_SYNCS = (  # sync points that count as a behaviour's peak, the preferred first
    "stroke",
    "strokeStart",
    "attackPeak",
    "ready",
    "start",
)
MAX_LISTED_WORDS = 400  # largest number of listed words; the time after them becomes one entry
MIN_SILENCE = 0.5  # [s] shortest silence listed in a transcript
TIME_TOLERANCE = 1e-6  # [s] rounding tolerance of caption times


@dataclass(frozen=True)
class PeakingBehaviour:
    """A performed behaviour with its peak time."""

    label: str
    outcome: str  # as in `Outcome.kind`
    peak: float  # [s] performance time


@dataclass(frozen=True)
class TranscriptPiece:
    """A word or silence, with the behaviours that peak in that time."""

    word: str  # empty: a time without words
    begin: float  # [s] performance time; -inf before the first word
    end: float  # [s] performance time; inf after the last word
    behaviours: tuple[PeakingBehaviour, ...] = ()


def transcribe(plan: Plan) -> tuple[TranscriptPiece, ...]:
    """Return the spoken words with the behaviours that peak during each word.

    Silences are included only if a behaviour peaks in them. Words between two marks divide the time in proportion to
    their letters.
    """
    pieces = tuple(_pieces(plan))
    begins = [piece.begin for piece in pieces]
    behaviours_by_piece: list[list[PeakingBehaviour]] = [[] for _ in pieces]
    for behaviour in sorted(_peaking_behaviours(plan), key=lambda peaking: peaking.peak):
        behaviours_by_piece[bisect_right(begins, behaviour.peak + TIME_TOLERANCE) - 1].append(behaviour)
    whole = (replace(piece, behaviours=tuple(here)) for piece, here in zip(pieces, behaviours_by_piece, strict=True))
    return tuple(piece for piece in whole if piece.word or piece.behaviours)


def _pieces(plan: Plan) -> Iterator[TranscriptPiece]:
    """Yield words and silences that cover all times from -inf to inf."""
    words = sorted((word for caption in make_captions(plan) for word in _words(caption)), key=lambda word: word.begin)
    shown = words[:MAX_LISTED_WORDS]
    if not shown:
        yield TranscriptPiece("", -inf, inf)
        return
    yield TranscriptPiece("", -inf, shown[0].begin)
    yield shown[0]
    for before, word in pairwise(shown):
        if word.begin - before.end > MIN_SILENCE:
            yield TranscriptPiece("", before.end, word.begin)
        yield word
    yield TranscriptPiece("", max(word.end for word in shown), inf)


def _words(caption: Caption) -> Iterator[TranscriptPiece]:
    """Divide a caption into words, timed in proportion to word lengths."""
    words = caption.text.split()
    letters = sum(len(word) + 1 for word in words)
    begin = caption.begin
    for word in words:
        end = begin + (caption.end - caption.begin) * (len(word) + 1) / letters
        yield TranscriptPiece(word, begin, end)
        begin = end


def _peaking_behaviours(plan: Plan) -> Iterator[PeakingBehaviour]:
    """Yield the performed behaviours except speech, with peak times."""
    syncs = {(sync.behaviour, sync.sync): sync.planned for sync in plan.syncs}
    for behaviour in plan.timeline.block.behaviours:
        peak = next((syncs[behaviour.id, name] for name in PEAK_SYNCS if (behaviour.id, name) in syncs), None)
        outcome = plan.keyframes.outcomes[behaviour.id].kind
        if peak is not None and outcome != "dropped" and not isinstance(behaviour.action, Speech):
            yield PeakingBehaviour(label(behaviour), outcome, plan.trajectory.zero + peak)
