"""kinesic as a realizer in virtual time: documents go in, feedback comes out, no clock is waited for.

Time stands still while a block is planned. The feedback of a performance can be asked what was heard in it.
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass

from kinesic.bml.block import BmlError
from kinesic.bml.reading.tree import read_tree
from kinesic.planning.setup import Setup
from kinesic.realizer.contention import with_engaged_hands
from kinesic.realizer.realizer import Scene, advance, begin, prepare_block
from kinesic.realizer.request import Message, read_request, refusal_feedback


@dataclass(frozen=True)
class ReceivedMessage:
    """One message."""

    kind: str  # blockProgress, syncPointProgress, warningFeedback or predictionFeedback
    id: str  # "block:start", "block:behaviour:sync", or who is warned of
    global_time: float = 0.0  # [s]
    time: float = 0.0  # [s] since the block's start, of a sync point
    text: str = ""


def read_message(xml: str) -> ReceivedMessage:
    """Reads one message.

    Raises:
        BmlError: it is no XML.
    """
    root = read_tree(xml, source="<feedback>")
    attributes = root.attributes
    return ReceivedMessage(
        root.local,
        attributes.get("id", ""),
        float(attributes.get("globalTime", "0")),
        float(attributes.get("time", "0")),
        root.text.strip(),
    )


class Feedback:
    """All messages so far, in order."""

    def __init__(self, messages: Iterable[ReceivedMessage] = ()) -> None:
        self.messages = list(messages)

    def of(self, kind: str) -> list[ReceivedMessage]:
        """Messages of a kind."""
        return [message for message in self.messages if message.kind == kind]

    def blocks(self, point: str) -> list[str]:
        """Ids of the blocks of which this point was reported, in order."""
        reported = (message.id.rpartition(":") for message in self.of("blockProgress"))
        return [block for block, _, name in reported if name == point]

    def block_time(self, block: str, point: str) -> float | None:
        """Global time of a point of a block [s]."""
        wanted = f"{block}:{point}"
        return next((message.global_time for message in self.of("blockProgress") if message.id == wanted), None)

    def sync_time(self, sync: str) -> float | None:
        """Time of `block:behaviour:sync` since the start of its block [s]."""
        return next((message.time for message in self.of("syncPointProgress") if message.id == sync), None)

    def syncs(self, behaviour: str) -> list[str]:
        """Sync points of `block:behaviour`, in the order in which they were reported."""
        reported = (message.id for message in self.of("syncPointProgress"))
        return [id.removeprefix(f"{behaviour}:") for id in reported if id.startswith(f"{behaviour}:")]

    def repeated(self) -> list[str]:
        """Names what was reported more than once."""
        ids = [message.id for kind in ("blockProgress", "syncPointProgress") for message in self.of(kind)]
        return sorted({id for id in ids if ids.count(id) > 1})


class Realizer:
    """Performs documents in virtual time, from rest at time 0."""

    def __init__(self, setup: Setup) -> None:
        self.feedback = Feedback()
        self.now = 0.0  # [s]
        self._setup, self._scene = setup, Scene.of(setup)

    def send(self, text: bytes | str, *, source: str = "<text>") -> None:
        """Sends a document now; one that is refused is answered by a warning."""
        message = Message(text, source=source)
        try:
            known = read_request(message, self._setup, context=self._scene.context(self.now))
            coming = prepare_block(with_engaged_hands(self._scene, known), self._setup)
        except BmlError as error:
            self.feedback.messages.append(read_message(refusal_feedback(message, error)))
            return
        self._hear(begin(self._scene, coming, self.now))

    def wait(self, seconds: float) -> None:
        """Lets time pass [s]."""
        self._pass(self.now + seconds)

    def wait_until(self, done: Callable[[Feedback], bool], *, timeout: float) -> bool:
        """Lets time pass from message to message until something was heard; False: it was not, in so many seconds."""
        end = self.now + timeout
        while not done(self.feedback):
            coming = self._scene.agenda[0].time if self._scene.agenda else end
            if coming >= end:
                self._pass(end)
                return done(self.feedback)
            self._pass(max(coming, self.now))
        return True

    def _pass(self, time: float) -> None:
        self.now = time
        self._hear(advance(self._scene, time))

    def _hear(self, scene: Scene) -> None:
        self._scene = scene
        self.feedback.messages += [read_message(each.xml) for each in scene.said]
