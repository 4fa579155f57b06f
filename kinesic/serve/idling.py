"""Scheduling and planning of idle motion between blocks."""

from dataclasses import replace
from math import inf

from kinesic.planning.setup import Setup
from kinesic.realizer.realizer import PreparedBlock, Scene, prepare_block
from kinesic.realizer.request import Message, read_request

REST_BEFORE_IDLING = 3.0  # [s] duration of rest between a block and idle motion
IDLE_SPELL_DURATION = 12.0  # [s] duration of one planned block of idle motion; spells follow without a gap
IDLING_TIMEOUT = 600.0  # [s] time since the last document after which no idle motion begins
# BML block that only waits; planning fills the wait with idle motion.
EMPTY_BLOCK = f'<bml id="idle"><wait id="w" duration="{IDLE_SPELL_DURATION}"/></bml>'


class IdleScheduler:
    """Scheduler of the start times of idle motion blocks (spells)."""

    def __init__(self) -> None:
        """Create a scheduler that allows no idle motion yet."""
        self._until = self._earliest = -inf
        self._spells = 0

    def allow(self, now: float) -> None:
        """Allow idle motion for `IDLING_TIMEOUT` seconds after a document."""
        self._until = now + IDLING_TIMEOUT

    def forbid(self) -> None:
        """Start no further idle motion until the next document.

        A running one continues.
        """
        self._until = -inf

    def postpone(self, now: float) -> None:
        """Delay the next spell by `IDLE_SPELL_DURATION` after a rejected proposal."""
        self._earliest = now + IDLE_SPELL_DURATION

    def next_time(self, scene: Scene) -> float:
        """Return the start time [s] of the next spell, or infinity.

        A time in the past means that the spell may start now.
        """
        if scene.blocks or scene.setup.idling.amount == 0.0:
            return inf
        pause = REST_BEFORE_IDLING if scene.idle is None else 0.0  # consecutive spells follow without a pause
        rest = scene.motion.end
        if scene.follows:  # the head keeps moving
            pause, rest = 0.0, -inf if scene.idle is None else scene.idle.end
        begin = max(rest + pause, self._earliest)
        return begin if begin < self._until else inf

    def plan_next(self, setup: Setup) -> PreparedBlock:
        """Plan the next spell of idle motion with a new random seed."""
        self._spells += 1
        return plan_idle(setup, self._spells)


def plan_idle(setup: Setup, number: int) -> PreparedBlock:
    """Plan one spell of idle motion.

    Args:
        setup: robot, and in `idling` the amplitude and seed.
        number: added to the seed, so that successive spells differ.
    """
    seeded = replace(setup, idling=replace(setup.idling, seed=setup.idling.seed + number))
    return prepare_block(read_request(Message(EMPTY_BLOCK), seeded), seeded)
