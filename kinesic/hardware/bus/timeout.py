"""How long to wait for an answer beyond what its bytes need on the wire: learnt, because hosts and USB differ.

A tight fixed timeout fails on a loaded host, a wide one lets every lost answer cost a cycle. So the 90 % quantile of
what answers took is followed, up by 9 steps for one that took longer, but hardly beyond it, and down by 1 for one that
did not. One late answer in ten may be missed: it is accepted when it comes.
"""

LEAST, MOST = 0.002, 0.020  # [s]
STEP = 50e-6  # [s]
QUANTILE = 0.9


class TimeoutEstimate:
    """The wait of one bus."""

    def __init__(self, usual: float = 0.0015, *, fall: float = 0.0) -> None:
        """Begins with a guess.

        Args:
            usual: [s] the quantile to begin with.
            fall: share of it by which it may come down at once, where the guess is far too high.
        """
        self._usual, self._fall = usual, fall

    @property
    def wait(self) -> float:
        """[s] to wait beyond the time of the bytes."""
        return min(max(2 * self._usual, LEAST), MOST)

    @property
    def usual(self) -> float:
        """[s] that nine answers in ten took beyond the time of their bytes."""
        return self._usual

    def took(self, excess: float) -> None:
        """Learns from an answer that came [s] later than its bytes needed."""
        if excess > self._usual:
            self._usual = min(self._usual + STEP * QUANTILE / (1 - QUANTILE), excess + 2 * STEP, MOST)
        else:
            self._usual = max(self._usual - max(STEP, self._fall * self._usual), 0.0)
