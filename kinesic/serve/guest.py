"""One client, whatever wire it came by."""

from dataclasses import dataclass

from kinesic.serve.outbox import Outbox
from kinesic.serve.quotas import Bucket

NORMAL, POLICY, TOO_BIG, LATER = 1000, 1008, 1009, 1013  # WebSocket's close codes


@dataclass(eq=False)
class Guest:
    """What the server knows of a client."""

    number: int
    name: str  # where it is
    admitted: bool  # has shown the token, or needs none
    bucket: Bucket
    outbox: Outbox
    code: int = NORMAL  # why it was closed, as WebSocket says it
    why: str = ""
    count: int = 0  # documents so far

    @property
    def open(self) -> bool:
        """Whether it is still listened to."""
        return self.code == NORMAL

    def put(self, message: str) -> None:
        """Sends a message, when it is this message's turn."""
        self.outbox.put(message)

    def close(self, code: int, why: str) -> None:
        """Ends the connection after what is still to be read."""
        self.code, self.why = code, why
        self.outbox.end()
