"""Sync write packet of goal positions in a reusable buffer.

Each cycle changes two bytes per servo and the CRC.
"""

from collections.abc import Sequence

import numpy as np

from kinesic.body.servo import TICKS_PER_TURN
from kinesic.hardware.protocol.crc import Crcs, byte_contributions
from kinesic.hardware.protocol.packet import sync_write
from kinesic.hardware.protocol.registers import Register
from kinesic.hardware.protocol.ticks import Ticks

_GOAL_FIELD = Register.GOAL_POSITION.field  # register that the packet writes
_HEADER_SIZE = 12  # [bytes] size of the sync write packet before the first servo's row
_ROW_SIZE = 1 + _GOAL_FIELD.size  # [bytes] size of a servo's row: id and goal position


class GoalFrame:
    """Reusable sync write packet of goal positions.

    Goals within one turn need no byte stuffing, because their upper bytes are 0 and no id is 0xFF.
    """

    def __init__(self, servos: Sequence[int]) -> None:
        """Create the packet for servo ids in the given order."""
        zeros = dict.fromkeys(servos, bytes(_GOAL_FIELD.size))
        self._frame = bytearray(sync_write(_GOAL_FIELD.address, _GOAL_FIELD.size, zeros))
        self._zero_crc = int.from_bytes(self._frame[-2:], "little")  # CRC of the packet with all goals 0
        count = len(servos)
        self._goals = np.ndarray((count,), "<u2", self._frame, _HEADER_SIZE + 1, (_ROW_SIZE,))
        self._contributed = _contributions(count, len(self._frame) - 2).ravel()
        self._rows = TICKS_PER_TURN * np.arange(count)

    def fill(self, goals: Ticks) -> bytearray:
        """Write goals into the packet and return it.

        It is valid until the next call.

        Args:
            goals: (n,) [ticks], clipped to 0..4095.
        """
        clipped = np.maximum(np.minimum(goals, TICKS_PER_TURN - 1), 0)
        self._goals[:] = clipped
        clipped += self._rows
        crc = int(np.bitwise_xor.reduce(self._contributed.take(clipped))) ^ self._zero_crc
        self._frame[-2], self._frame[-1] = crc & 0xFF, crc >> 8
        return self._frame


def _contributions(count: int, covered: int) -> Crcs:
    """Tabulate the CRC contributions (count, 4096) of all goal positions per servo.

    Args:
        count: number of servos.
        covered: [bytes] covered by the CRC.
    """
    table, goals = byte_contributions(covered), np.arange(TICKS_PER_TURN)
    low = _HEADER_SIZE + 1 + _ROW_SIZE * np.arange(count)[:, None]
    contributions: Crcs = table[low, goals & 0xFF] ^ table[low + 1, goals >> 8]
    return contributions
