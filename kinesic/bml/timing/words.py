"""Links between sync points and words of a speech."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from kinesic.bml.block import Block, Speech, Timeline
from kinesic.bml.timing.constraints import Point, find_equalities, get_point

BLOCK_BEHAVIOUR = "bml"  # behaviour id of the block itself in references
SILENT_SYNC = "end"  # sync point of a speech at which no word begins


@dataclass(frozen=True)
class TiedWord:
    """Word of a speech to which a sync point is tied."""

    behaviour: str  # id of the speech
    sync: str  # start of the word: a mark, or `start`
    time: float  # [s] block time of the word plus the offset in the document

    @property
    def name(self) -> str:
        """Name of the word as speech and sync point, such as `s:mark`."""
        return f"{self.behaviour}:{self.sync}"


def find_tied_words(timeline: Timeline) -> Mapping[tuple[str, str], TiedWord]:
    """Return the word to which each sync point is tied.

    A sync point may be tied through other sync points.

    Args:
        timeline: timeline of one block; only points with a time in it count.

    Returns:
        (behaviour, sync point) -> word; a speech's own points are omitted.
    """
    block = timeline.block.id
    times = {
        Point(block, timed.behaviour.id, sync): time for timed in timeline.timed for sync, time in timed.times.items()
    }
    return {
        (point.behaviour, point.sync): TiedWord(word.behaviour, word.sync, times[word] + offset)
        for point, (word, offset) in find_word_offsets(timeline.block, times).items()
    }


def find_word_offsets(
    block: Block, known_times: Mapping[Point, float] | None = None
) -> Mapping[Point, tuple[Point, float]]:
    """Return the word and offset [s] of each tied sync point.

    Args:
        block: block with its speeches.
        known_times: points that count, with their times [s]; None: the points of all behaviours.
    """
    neighbours: dict[Point, list[tuple[Point, float]]] = {}
    for equality in find_equalities(block):
        left, right = get_point(equality.left), get_point(equality.right)
        is_counted = (
            {left, right} <= known_times.keys()
            if known_times is not None
            else BLOCK_BEHAVIOUR not in (left.behaviour, right.behaviour)
        )
        if left.behaviour != right.behaviour and is_counted:
            delay = equality.left.offset - equality.right.offset
            neighbours.setdefault(left, []).append((right, delay))
            neighbours.setdefault(right, []).append((left, -delay))
    speeches = {behaviour.id for behaviour in block.behaviours if isinstance(behaviour.action, Speech)}
    return {
        point: (word, offset)
        for word in neighbours
        if word.behaviour in speeches and word.sync != SILENT_SYNC
        for point, offset in _find_coinciding(word, neighbours)
        if point.behaviour not in speeches
    }


def _find_coinciding(
    word: Point, neighbours: Mapping[Point, list[tuple[Point, float]]]
) -> Iterator[tuple[Point, float]]:
    """Yield all sync points tied to a word, with offsets [s]."""
    offsets, queue = {word: 0.0}, [word]
    while queue:
        current = queue.pop()
        for other, offset in neighbours.get(current, ()):
            if other not in offsets:
                offsets[other] = offsets[current] + offset
                queue.append(other)
    yield from offsets.items()
