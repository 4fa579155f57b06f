"""Fair scheduling of reads between connections.

A connection with little traffic is read at once; those with much traffic take turns. A waiting connection is not read,
so that the operating system slows down its sender and a flood uses only a small fraction of the processor.
"""

from asyncio import sleep

from kinesic.serve.wire.quotas import TokenBucket

TURN_PERIOD = 0.005  # [s] delay of a read for each waiting connection; limits the sum of all reads to 200 per second


class ReadPace:
    """Scheduler that divides reading time fairly between connections."""

    def __init__(self) -> None:
        """Create a scheduler without waiting connections."""
        self._waiting = 0

    async def await_turn(self, bucket: TokenBucket) -> None:
        """Wait until a connection may be read.

        The delay grows with the number of waiting connections.

        Args:
            bucket: rate limit of the connection; there is no delay while it holds a token.
        """
        if bucket.take():
            return
        self._waiting += 1
        try:
            await sleep(max(bucket.period, TURN_PERIOD * self._waiting))
            bucket.empty()  # tokens collected while waiting would allow a burst after each turn
        finally:
            self._waiting -= 1
