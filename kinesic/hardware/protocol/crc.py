"""Computes the CRC of `packet`, many bytes at a time.

The CRC is linear: that of a message is the exclusive or of what each byte contributes by its place, and of what the
CRC before it has become by then. So one table per place replaces the loop over bytes.
"""

from functools import cache

import numpy as np
from numpy.typing import NDArray

from kinesic.hardware.protocol.packet import CRC_TABLE

Crcs = NDArray[np.uint16]
Bytes = NDArray[np.uint8]

_TABLE: Crcs = np.array(CRC_TABLE, dtype=np.uint16)


def advance_crcs(crcs: Crcs, data: Bytes | int = 0) -> Crcs:
    """Advances each CRC by one more byte."""
    after: Crcs = (crcs << 8) ^ _TABLE[(crcs >> 8) ^ data]
    return after


@cache
def byte_contributions(length: int) -> Crcs:
    """(length, 256) what each byte contributes to the CRC of a message of `length` bytes, by its place."""
    table = np.empty((length, 256), dtype=np.uint16)
    row = _TABLE
    for place in reversed(range(length)):
        table[place] = row
        row = advance_crcs(row)
    table.setflags(write=False)
    return table


@cache
def crc_contributions(length: int) -> Crcs:
    """(65536,) what a CRC, followed by its own two bytes, contributes `length` bytes later."""
    crcs = np.arange(1 << 16, dtype=np.uint16)
    after = advance_crcs(advance_crcs(crcs, (crcs & 0xFF).astype(np.uint8)), (crcs >> 8).astype(np.uint8))
    for _ in range(length):
        after = advance_crcs(after)
    after.setflags(write=False)
    return after
