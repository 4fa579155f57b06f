"""Feedback as it is heard: the messages of a performance, and what can be asked about them."""

from collections.abc import Iterable
from dataclasses import dataclass

from kinesic.bml.reading.tree import read_tree


@dataclass(frozen=True)
class Heard:
    """One message."""

    kind: str  # blockProgress, syncPointProgress, warningFeedback or predictionFeedback
    id: str  # "block:start", "block:behaviour:sync", or who is warned of
    global_time: float = 0.0  # [s]
    time: float = 0.0  # [s] since the block's start, of a sync point
    text: str = ""


def heard(xml: str) -> Heard:
    """Reads one message.

    Raises:
        BmlError: it is no XML.
    """
    root = read_tree(xml, source="<feedback>")
    told = root.attributes
    return Heard(
        root.local,
        told.get("id", ""),
        float(told.get("globalTime", "0")),
        float(told.get("time", "0")),
        root.text.strip(),
    )


class Feedback:
    """All messages so far, in order."""

    def __init__(self, messages: Iterable[Heard] = ()) -> None:
        self.messages = list(messages)

    def of(self, kind: str) -> list[Heard]:
        """Messages of a kind."""
        return [message for message in self.messages if message.kind == kind]

    def blocks(self, point: str) -> list[str]:
        """Ids of the blocks of which this point was reported, in order."""
        told = (message.id.rpartition(":") for message in self.of("blockProgress"))
        return [block for block, _, name in told if name == point]

    def block_time(self, block: str, point: str) -> float | None:
        """Global time of a point of a block [s]."""
        wanted = f"{block}:{point}"
        return next((message.global_time for message in self.of("blockProgress") if message.id == wanted), None)

    def sync_time(self, sync: str) -> float | None:
        """Time of `block:behaviour:sync` since the start of its block [s]."""
        return next((message.time for message in self.of("syncPointProgress") if message.id == sync), None)

    def syncs(self, behaviour: str) -> list[str]:
        """Sync points of `block:behaviour`, in the order in which they were reported."""
        told = (message.id for message in self.of("syncPointProgress"))
        return [id.removeprefix(f"{behaviour}:") for id in told if id.startswith(f"{behaviour}:")]

    def repeated(self) -> list[str]:
        """What was reported more than once."""
        ids = [message.id for kind in ("blockProgress", "syncPointProgress") for message in self.of(kind)]
        return sorted({id for id in ids if ids.count(id) > 1})
