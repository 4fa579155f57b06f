"""Numbered rows with a CRC in the rings of the shared memory."""

import zlib

import numpy as np
from numpy.typing import NDArray

Rows = NDArray[np.void]


def store_row(rows: Rows, place: int, number: int, *values: object) -> None:
    """Store a numbered row with its CRC in a ring."""
    row = np.zeros(1, dtype=rows.dtype)
    row[0] = (number, *values, 0)
    row["crc"] = zlib.crc32(row.tobytes()[:-8])
    rows[place] = row[0]


def load_row(rows: Rows, place: int, number: int) -> np.void | None:
    """Copy a ring row, or return None while it is incomplete."""
    row = rows[place].copy()
    complete = number > 0 and int(row["number"]) == number and int(row["crc"]) == zlib.crc32(row.tobytes()[:-8])
    return row if complete else None
