"""Vectorised computation of packet CRCs.

The CRC is linear: that of a message is the exclusive or of one contribution per byte and position, and of the advanced
initial CRC. So one table per position replaces the loop over bytes.
"""

from functools import cache

import numpy as np
from numpy.typing import NDArray

from kinesic.hardware.protocol.packet import CRC_TABLE

Crcs = NDArray[np.uint16]
Bytes = NDArray[np.uint8]

_CRC_ARRAY: Crcs = np.array(CRC_TABLE, dtype=np.uint16)  # CRC of each single byte


def advance_crcs(crcs: Crcs, data: Bytes | int = 0) -> Crcs:
    """Update each CRC by one more data byte."""
    after: Crcs = (crcs << 8) ^ _CRC_ARRAY[(crcs >> 8) ^ data]
    return after


@cache
def byte_contributions(length: int) -> Crcs:
    """Tabulate the CRC contributions (length, 256) of all bytes at all positions."""
    table = np.empty((length, 256), dtype=np.uint16)
    row = _CRC_ARRAY
    for place in reversed(range(length)):
        table[place] = row
        row = advance_crcs(row)
    table.setflags(write=False)
    return table


@cache
def crc_contributions(length: int) -> Crcs:
    """Tabulate the contribution (65536,) of each CRC to the next block's CRC.

    It is the CRC register after the two bytes of the CRC itself and `length` zero bytes.
    """
    crcs = np.arange(1 << 16, dtype=np.uint16)
    after = advance_crcs(advance_crcs(crcs, (crcs & 0xFF).astype(np.uint8)), (crcs >> 8).astype(np.uint8))
    for _ in range(length):
        after = advance_crcs(after)
    after.setflags(write=False)
    return after
