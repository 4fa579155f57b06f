"""When a robot idles between blocks, and by which plan."""

from dataclasses import replace
from math import inf

from kinesic.planning.setup import Setup
from kinesic.realizer.realizer import PreparedBlock, Scene, prepare_block
from kinesic.realizer.request import Message, read_request

PAUSE = 3.0  # [s] at rest before it idles
SPELL = 12.0  # [s] that one plan of it lasts
LONGEST = 600.0  # [s] since the last document: nobody leaves a robot that goes on moving behind
NOTHING = f'<bml id="idle"><wait id="w" duration="{SPELL}"/></bml>'


class IdleTimes:
    """Tells when idle motion is to begin: in pauses of a conversation, until nobody has asked anything for long."""

    def __init__(self) -> None:
        """Nobody has asked anything yet, and it holds still."""
        self._until = self._earliest = -inf  # [s] of the clock
        self._spells = 0

    def allow(self, now: float) -> None:
        """Lets it idle for some minutes, because a client has asked something."""
        self._until = now + LONGEST

    def forbid(self) -> None:
        """Has it hold still until a client asks something."""
        self._until = -inf

    def next_time(self, scene: Scene) -> float:
        """Time at which idle motion is to begin [s]; infinite where it is not."""
        if scene.blocks or scene.setup.idling.amount == 0.0:
            return inf
        begin = max(scene.motion.end + (PAUSE if scene.idle is None else 0.0), self._earliest)
        return begin if begin < self._until else inf

    def prepare(self, setup: Setup, now: float) -> PreparedBlock:
        """Plans the next spell of idle motion; where that finds no place, the one after it comes a spell later."""
        self._spells, self._earliest = self._spells + 1, now + SPELL
        return prepare_idle(setup, self._spells)


def prepare_idle(setup: Setup, number: int = 0) -> PreparedBlock:
    """Plans a block in which nothing is asked, so that idle motion fills it.

    Args:
        setup: says how lively.
        number: of the spell; each is another one.
    """
    own = replace(setup, idling=replace(setup.idling, seed=setup.idling.seed + number))
    return prepare_block(read_request(Message(NOTHING), own), own)
