"""One measured figure beside its goal."""

from dataclasses import dataclass
from typing import Literal


@dataclass(frozen=True)
class Figure:
    """A figure; `value` is None with a `why` where this machine cannot measure it."""

    name: str
    value: float | None
    unit: str
    goal: float | None
    better: Literal["lower", "higher"]
    why: str = ""

    @property
    def ok(self) -> bool | None:
        """Whether the goal is met; None without a value or a goal."""
        if self.value is None or self.goal is None:
            return None
        return self.value >= self.goal if self.better == "higher" else self.value <= self.goal
