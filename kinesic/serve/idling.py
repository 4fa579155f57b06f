"""Decides when a robot idles between blocks, and plans what it does then."""

from dataclasses import replace
from math import inf

from kinesic.planning.setup import Setup
from kinesic.realizer.realizer import PreparedBlock, Scene, prepare_block
from kinesic.realizer.request import Message, read_request

PAUSE = 3.0  # [s] at rest before the first spell of idle motion
SPELL = 12.0  # [s] that one spell lasts; one follows the other
ATTENDED = 600.0  # [s] after a document in which a spell may begin, so that a robot that is left alone comes to rest
EMPTY_BLOCK = f'<bml id="idle"><wait id="w" duration="{SPELL}"/></bml>'  # planning fills the wait with idle motion


class IdleScheduler:
    """Says when the next spell of idle motion begins, and plans it; all times are the planner's [s]."""

    def __init__(self) -> None:
        """No document has come yet, and nothing begins."""
        self._until = self._earliest = -inf
        self._spells = 0

    def allow(self, now: float) -> None:
        """Allows spells for `ATTENDED` seconds, because a document has come."""
        self._until = now + ATTENDED

    def forbid(self) -> None:
        """Allows no further spell until a document comes; the one that plays is not ended by it."""
        self._until = -inf

    def postpone(self, now: float) -> None:
        """Puts the next spell off by the length of one, because this one found no place."""
        self._earliest = now + SPELL

    def next_time(self, scene: Scene) -> float:
        """Finds the time at which the next spell is to begin, at once where it is past; infinite where none is."""
        if scene.blocks or scene.setup.idling.amount == 0.0:
            return inf
        pause = PAUSE if scene.idle is None else 0.0  # it has idled already, and goes on
        begin = max(scene.motion.end + pause, self._earliest)
        return begin if begin < self._until else inf

    def plan_next(self, setup: Setup) -> PreparedBlock:
        """Plans another spell than the last one."""
        self._spells += 1
        return plan_idle(setup, self._spells)


def plan_idle(setup: Setup, number: int) -> PreparedBlock:
    """Plans a spell of idle motion.

    Args:
        setup: robot, and in `idling` how lively it is, and the seed.
        number: added to that seed, so that spells with other numbers move in another way.
    """
    seeded = replace(setup, idling=replace(setup.idling, seed=setup.idling.seed + number))
    return prepare_block(read_request(Message(EMPTY_BLOCK), seeded), seeded)
