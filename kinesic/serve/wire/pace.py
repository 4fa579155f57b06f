"""Shares out the server's time: a connection that sends little is read at once, those that send much take turns.

Whoever waits for a turn is not read meanwhile, so that the system holds up the sender, and no flood costs more than a
small share of a processor.
"""

from asyncio import sleep

from kinesic.serve.wire.quotas import TokenBucket

TURN = 0.005  # [s] of waiting for each that waits: all of them together are read 200 times a second at most


class Pace:
    """Says when each connection of a server is read; they share one."""

    def __init__(self) -> None:
        """Begins with nobody waiting."""
        self._waiting = 0

    async def await_turn(self, bucket: TokenBucket) -> None:
        """Waits until a connection may be read, the longer the more of them wait.

        Args:
            bucket: of the connection; with a token in it, it does not wait.
        """
        if bucket.take():
            return
        self._waiting += 1
        try:
            await sleep(max(bucket.period, TURN * self._waiting))
            bucket.empty()  # the tokens of the time that it waited would let a burst through after each turn
        finally:
            self._waiting -= 1
