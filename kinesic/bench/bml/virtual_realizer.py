"""BML realizer in virtual time: documents in, feedback out, no waiting.

Time stands still during planning. The feedback object answers queries about received messages.
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass

from kinesic.bml.block import BmlError
from kinesic.bml.reading.tree import read_tree
from kinesic.planning.setup import Setup
from kinesic.realizer.contention import with_busy_hands
from kinesic.realizer.realizer import Scene, advance, begin, prepare_block
from kinesic.realizer.request import Message, read_request, refusal_feedback


@dataclass(frozen=True)
class ReceivedMessage:
    """One feedback message."""

    kind: str  # blockProgress, syncPointProgress, warningFeedback or predictionFeedback
    id: str  # "block:start", "block:behaviour:sync", or the subject of a warning
    global_time: float = 0.0  # [s] global time of the message
    time: float = 0.0  # [s] time of a sync point since the block's start
    text: str = ""


def read_message(xml: str) -> ReceivedMessage:
    """Read one feedback message.

    Raises:
        BmlError: the message is not XML.
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


class FeedbackLog:
    """All feedback messages received from a realizer, in order."""

    def __init__(self, messages: Iterable[ReceivedMessage] = ()) -> None:
        self.messages = list(messages)

    def of(self, kind: str) -> list[ReceivedMessage]:
        """Return the feedback messages of one type."""
        return [message for message in self.messages if message.kind == kind]

    def blocks(self, point: str) -> list[str]:
        """Return the ids of blocks that reported a progress point, in order."""
        reported = (message.id.rpartition(":") for message in self.of("blockProgress"))
        return [block for block, _, name in reported if name == point]

    def block_time(self, block: str, point: str) -> float | None:
        """Return the global time [s] of a block's start or end feedback.

        The result is None before that feedback.
        """
        point_id = f"{block}:{point}"
        return next((message.global_time for message in self.of("blockProgress") if message.id == point_id), None)

    def sync_time(self, sync: str) -> float | None:
        """Return the time of `block:behaviour:sync` since the start of its block [s].

        The result is None before its feedback.
        """
        return next((message.time for message in self.of("syncPointProgress") if message.id == sync), None)

    def syncs(self, behaviour: str) -> list[str]:
        """Return the sync points of `block:behaviour` in the order of their reports."""
        reported = (message.id for message in self.of("syncPointProgress"))
        return [id.removeprefix(f"{behaviour}:") for id in reported if id.startswith(f"{behaviour}:")]

    def repeated(self) -> list[str]:
        """Return the ids of progress points that were reported more than once."""
        ids = [message.id for kind in ("blockProgress", "syncPointProgress") for message in self.of(kind)]
        return sorted({id for id in ids if ids.count(id) > 1})


class Realizer:
    """BML realizer in virtual time that begins at rest at time 0."""

    def __init__(self, setup: Setup) -> None:
        self.feedback = FeedbackLog()
        self.now = 0.0  # [s]
        self._setup, self._scene = setup, Scene.of(setup)

    def send(self, text: bytes | str, *, source: str = "<text>") -> None:
        """Send a BML document at the current virtual time.

        A refused document is answered by a warning.
        """
        message = Message(text, source=source)
        try:
            block = read_request(message, self._setup, context=self._scene.context(self.now))
            prepared = prepare_block(with_busy_hands(self._scene, block), self._setup)
        except BmlError as error:
            self.feedback.messages.append(read_message(refusal_feedback(message, error)))
            return
        self._receive(begin(self._scene, prepared, self.now))

    def wait(self, seconds: float) -> None:
        """Advance virtual time by a duration [s]."""
        self._advance_to(self.now + seconds)

    def wait_until(self, is_done: Callable[[FeedbackLog], bool], *, timeout: float) -> bool:
        """Advance virtual time until a condition on the feedback holds.

        Return False after the timeout [s].
        """
        end = self.now + timeout
        while not is_done(self.feedback):
            next_time = self._scene.agenda[0].time if self._scene.agenda else end
            if next_time >= end:
                self._advance_to(end)
                return is_done(self.feedback)
            self._advance_to(max(next_time, self.now))
        return True

    def _advance_to(self, time: float) -> None:
        self.now = time
        self._receive(advance(self._scene, time))

    def _receive(self, scene: Scene) -> None:
        self._scene = scene
        self.feedback.messages += [read_message(message.xml) for message in scene.outgoing_feedback]
