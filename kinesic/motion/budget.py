"""Counts the work of planning, so that every host gives up at the same place."""

from math import inf


class Budget:
    """Work that may still be done, in pieces of splines whose shortage is measured; it travels through all rounds."""

    def __init__(self, work: float = inf) -> None:
        """Nothing is spent yet.

        Args:
            work: pieces that may be measured, and what takes as long as so many.
        """
        self._work = self._left = work

    def spend(self, work: float) -> None:
        """Counts work that is done."""
        self._left -= work

    @property
    def left(self) -> float:
        """Work that may still be done."""
        return max(self._left, 0.0)

    @property
    def overdraft(self) -> float:
        """Work beyond the budget, as a multiple of the budget."""
        return max(-self._left, 0.0) / max(self._work, 1.0)

    @property
    def spent(self) -> bool:
        """Whether more was done than there is a budget for: what follows is planned in simpler ways."""
        return self._left < 0.0


ENDLESS = Budget()  # for work that is bounded by other means
