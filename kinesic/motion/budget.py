"""Deterministic work budget of planning, the same on every host."""

from math import inf


class Budget:
    """Remaining planning work, counted in evaluated knot intervals."""

    def __init__(self, work: float = inf) -> None:
        """Create a budget with all its work remaining.

        Args:
            work: evaluations of knot intervals that are allowed, or work of equal duration.
        """
        self._work = self._left = work

    def spend(self, work: float) -> None:
        """Subtract finished work from the budget."""
        self._left -= work

    @property
    def left(self) -> float:
        """Remaining work [knot intervals], never negative."""
        return max(self._left, 0.0)

    @property
    def overdraft(self) -> float:
        """Work done beyond the budget, as a multiple of the budget."""
        return max(-self._left, 0.0) / max(self._work, 1.0)

    @property
    def spent(self) -> bool:
        """Whether the budget is exceeded, so that simpler methods apply."""
        return self._left < 0.0


UNLIMITED_BUDGET = Budget()  # infinite budget, for work that is bounded elsewhere
