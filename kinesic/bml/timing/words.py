"""Finds which sync points a document ties to words of a speech."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from kinesic.bml.block import Block, Speech, Timeline
from kinesic.bml.timing.constraints import Point, point_of, ties

BLOCK_NAME = "bml"  # the block itself, which every time is counted from
SILENT = "end"  # the one sync point of a speech at which no word begins


@dataclass(frozen=True)
class TiedWord:
    """A word of a speech that a sync point is tied to."""

    behaviour: str  # the speech
    sync: str  # where it begins: a mark, or `start`
    time: float  # [s] when it sounds, with the offset that the document adds; block time

    @property
    def name(self) -> str:
        """Speech and sync point: `s:mark`."""
        return f"{self.behaviour}:{self.sync}"


def find_words(timeline: Timeline) -> Mapping[tuple[str, str], TiedWord]:
    """Finds the word of each sync point that a document ties to one, if need be through others.

    Args:
        timeline: of one block; only points that have a time in it count.

    Returns:
        (behaviour, sync point) -> its word; a speech's own points have none.
    """
    block = timeline.block.id
    times = {Point(block, one.behaviour.id, sync): time for one in timeline.timed for sync, time in one.times.items()}
    return {
        (point.behaviour, point.sync): TiedWord(word.behaviour, word.sync, times[word] + offset)
        for point, (word, offset) in tied_words(timeline.block, times).items()
    }


def tied_words(block: Block, known: Mapping[Point, float] | None = None) -> Mapping[Point, tuple[Point, float]]:
    """Finds the words that a block ties its sync points to, and how much later than them these are asked [s].

    Args:
        block: with its speeches.
        known: the points that count, with their times [s]; None: those of all behaviours.
    """
    beside: dict[Point, list[tuple[Point, float]]] = {}
    for tie in ties(block):
        left, right = point_of(tie.left), point_of(tie.right)
        counted = (
            {left, right} <= known.keys() if known is not None else BLOCK_NAME not in (left.behaviour, right.behaviour)
        )
        if left.behaviour != right.behaviour and counted:
            later = tie.left.offset - tie.right.offset
            beside.setdefault(left, []).append((right, later))
            beside.setdefault(right, []).append((left, -later))
    speeches = {behaviour.id for behaviour in block.behaviours if isinstance(behaviour.action, Speech)}
    return {
        point: (word, offset)
        for word in beside
        if word.behaviour in speeches and word.sync != SILENT
        for point, offset in _coinciding(word, beside)
        if point.behaviour not in speeches
    }


def _coinciding(word: Point, beside: Mapping[Point, list[tuple[Point, float]]]) -> Iterator[tuple[Point, float]]:
    """Yields all sync points that a document ties to a word, and how much later than it they are asked [s]."""
    found, waiting = {word: 0.0}, [word]
    while waiting:
        here = waiting.pop()
        for other, offset in beside.get(here, ()):
            if other not in found:
                found[other] = found[here] + offset
                waiting.append(other)
    yield from found.items()
