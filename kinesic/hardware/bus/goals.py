"""Writes the frame of goal positions: one buffer, in which each cycle changes two bytes per servo and the CRC."""

from collections.abc import Sequence

import numpy as np

from kinesic.body.servo import TICKS_PER_TURN
from kinesic.hardware.protocol.crc import Crcs, byte_contributions
from kinesic.hardware.protocol.packet import sync_write
from kinesic.hardware.protocol.registers import Register
from kinesic.hardware.protocol.ticks import Ticks

_GOAL = Register.GOAL_POSITION.field
_FIRST = 12  # [bytes] before the first row
_ROW = 1 + _GOAL.size


class GoalFrame:
    """A sync write of goals: those of one turn need no stuffing, as their upper bytes are 0 and no id is 0xFF."""

    def __init__(self, servos: Sequence[int]) -> None:
        """Makes a frame for these ids, in this order."""
        zeros = dict.fromkeys(servos, bytes(_GOAL.size))
        self._frame = bytearray(sync_write(_GOAL.address, _GOAL.size, zeros))
        self._still = int.from_bytes(self._frame[-2:], "little")  # the CRC of goals that are all 0
        count = len(servos)
        self._goals = np.ndarray((count,), "<u2", self._frame, _FIRST + 1, (_ROW,))
        self._contributed = _contributions(count, len(self._frame) - 2).ravel()
        self._rows = TICKS_PER_TURN * np.arange(count)

    def filled(self, goals: Ticks) -> bytearray:
        """Returns the frame for these goals, valid until the next call.

        Args:
            goals: (n,) ticks, 0..4095; what lies outside is clipped.
        """
        clipped = np.maximum(np.minimum(goals, TICKS_PER_TURN - 1), 0)
        self._goals[:] = clipped
        clipped += self._rows
        crc = int(np.bitwise_xor.reduce(self._contributed.take(clipped))) ^ self._still
        self._frame[-2], self._frame[-1] = crc & 0xFF, crc >> 8
        return self._frame


def _contributions(count: int, covered: int) -> Crcs:
    """(count, 4096) what each goal contributes to the CRC over `covered` bytes."""
    table, goals = byte_contributions(covered), np.arange(TICKS_PER_TURN)
    low = _FIRST + 1 + _ROW * np.arange(count)[:, None]
    contributions: Crcs = table[low, goals & 0xFF] ^ table[low + 1, goals >> 8]
    return contributions
