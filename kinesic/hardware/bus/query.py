"""Queries for the records of several servos, and parsing of their replies.

A fast read is answered by one common reply: a header, then a block per servo in the order of the query, each ending
with the CRC of everything before it (Protocol 2.0, never stuffed). A block is checked against the CRC before it, so a
damaged block does not spoil the others. Older firmware answers with one status packet per servo.
"""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import ClassVar, NamedTuple

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from kinesic.body.arrays import Flags
from kinesic.hardware.bus.cycle import BLOCK_DTYPE, RECORD_SIZE, Records
from kinesic.hardware.protocol.crc import Bytes, Crcs, byte_contributions, crc_contributions
from kinesic.hardware.protocol.packet import (
    BROADCAST_ID,
    PACKET_HEADER,
    STATUS_OVERHEAD,
    Instruction,
    Reader,
    bulk_read,
    crc16,
    read_packet,
    sync_read,
)

HEADER_SIZE = 8  # [bytes] size of a fast reply before its first block
CHECKED_SIZE = BLOCK_DTYPE.itemsize - 2  # [bytes] size of a servo's block in a fast reply, without its CRC
RESYNC_BLOCKS = 3  # Number of blocks after a damaged one that are searched for the next intact block


class ServoReplies(NamedTuple):
    """Records of the queried servos, in the order of the query."""

    blocks: Records  # (m,) of dtype BLOCK_DTYPE, valid where `received`
    received: Flags  # (m,) whether the servo's block was received intact
    whole: bool  # whether all blocks were received intact
    end: int  # [bytes] offset of the reply's end; the expected one if it is not whole


@dataclass(frozen=True)
class Query(ABC):
    """Query of several servos: its packet, and the parser of its reply."""

    servos: tuple[int, ...]  # ids, in query order
    addresses: tuple[int, ...]  # address of each servo's record
    chained: ClassVar[bool]  # whether a silent servo ends the reply

    @property
    @abstractmethod
    def data(self) -> bytes:
        """Bytes of the packet that queries the servos."""

    @property
    @abstractmethod
    def length(self) -> int:
        """Length of a complete reply [bytes]."""

    @abstractmethod
    def parse(self, raw: bytes) -> ServoReplies:
        """Parse received bytes, which may contain noise and earlier replies."""

    @abstractmethod
    def is_complete(self, raw: bytes) -> bool:
        """Return whether the last servo has sent its last byte."""

    def _request(self, *, fast: bool) -> bytes:
        """Build a sync read, or a bulk read for different addresses."""
        if len(set(self.addresses)) == 1:
            return sync_read(self.servos, self.addresses[0], RECORD_SIZE, fast=fast)
        return bulk_read(
            {servo: (a, RECORD_SIZE) for servo, a in zip(self.servos, self.addresses, strict=True)}, fast=fast
        )


@dataclass(frozen=True)
class FastQuery(Query):
    """Fast sync read, or fast bulk read for different cell addresses."""

    chained = True

    @cached_property
    def data(self) -> bytes:
        """Bytes of the fast sync read or fast bulk read packet."""
        return self._request(fast=True)

    @cached_property
    def length(self) -> int:
        """Length of a complete reply [bytes]."""
        return HEADER_SIZE + BLOCK_DTYPE.itemsize * len(self.servos)

    @cached_property
    def _head(self) -> bytes:
        inside = self.length - HEADER_SIZE + 1
        return PACKET_HEADER + bytes((BROADCAST_ID, inside & 0xFF, inside >> 8, Instruction.STATUS))

    @cached_property
    def _first(self) -> int:
        """Contribution of the reply's header to the first servo block's CRC."""
        return crc16(self._head + bytes(CHECKED_SIZE))

    @cached_property
    def _unchained(self) -> np.uint16:
        """CRC correction of the first block, which no other block precedes.

        The check of all blocks at once takes the two bytes before each block as the CRC of the previous block.
        """
        return np.uint16(self._first ^ int(_CRC_CARRY[int.from_bytes(self._head[-2:], "little")]))

    @cached_property
    def _ids(self) -> bytes:
        return bytes(self.servos)

    @cached_property
    def _all(self) -> Flags:
        all_servos: Flags = np.ones(len(self.servos), dtype=np.bool_)
        all_servos.setflags(write=False)
        return all_servos

    def parse(self, raw: bytes) -> ServoReplies:
        """Parse the reply in received bytes, or salvage its intact blocks."""
        first = start = raw.find(self._head)
        while 0 <= start <= len(raw) - self.length:
            blocks = self._parse_intact(raw, start)
            if blocks is not None:
                return ServoReplies(blocks, self._all, True, start + self.length)
            start = raw.find(self._head, start + 1)  # a reply of other servos may precede this one
        return self._find_intact_blocks(raw, first)

    def _parse_intact(self, raw: bytes, start: int) -> Records | None:
        """Return the blocks of an undamaged reply, or None."""
        offset, size, count = start + HEADER_SIZE, BLOCK_DTYPE.itemsize, len(self.servos)
        if raw[offset + 1 : start + self.length : size] != self._ids:
            return None
        octets = np.ndarray((count, CHECKED_SIZE), np.uint8, raw, offset, (size, 1))
        before: Crcs = np.ndarray((count,), "<u2", raw, offset - 2, (size,))
        crcs: Crcs = np.ndarray((count,), "<u2", raw, offset + CHECKED_SIZE, (size,))
        wrong = _own_crcs(octets)
        wrong ^= _CRC_CARRY.take(before)
        wrong ^= crcs
        wrong[0] ^= self._unchained
        return None if wrong.any() else np.frombuffer(raw, BLOCK_DTYPE, count, offset)

    def is_complete(self, raw: bytes) -> bool:
        """Return whether the bytes end with an intact last block.

        The reply may still have lost bytes before it.
        """
        last = raw[-BLOCK_DTYPE.itemsize :]
        if len(raw) < BLOCK_DTYPE.itemsize + 2 or last[1] != self.servos[-1]:
            return False
        before = raw[-BLOCK_DTYPE.itemsize - 2 : -BLOCK_DTYPE.itemsize]
        crc = crc16(last[:CHECKED_SIZE], crc16(before, int.from_bytes(before, "little")))
        return crc == int.from_bytes(last[CHECKED_SIZE:], "little")

    def _find_intact_blocks(self, raw: bytes, start: int) -> ServoReplies:
        """Find all intact blocks in a damaged reply.

        Bytes may have changed, been lost or been added. Each block is searched near its expected offset; after a
        damaged block, the next intact one within reach shows where the reply continues.
        """
        blocks: Records = np.zeros(len(self.servos), dtype=BLOCK_DTYPE)
        received: Flags = np.zeros(len(self.servos), dtype=np.bool_)
        if len(raw) < BLOCK_DTYPE.itemsize:
            return ServoReplies(blocks, received, False, self.length)
        windows = _Windows.of(raw)
        at, before = (start + HEADER_SIZE if start >= 0 else HEADER_SIZE), self._first
        place = 0
        while place < len(self.servos):
            here = self._next_intact(place, at, before, windows)
            if here is None:
                break
            place, at = here
            blocks[place] = np.frombuffer(raw, BLOCK_DTYPE, 1, at)[0]
            received[place] = True
            before = int(_CRC_CARRY[windows.crcs[at]])
            place, at = place + 1, at + BLOCK_DTYPE.itemsize
        return ServoReplies(
            blocks, received, bool(received.all()), at + BLOCK_DTYPE.itemsize * (len(self.servos) - place)
        )

    def _next_intact(self, place: int, at: int, before: int, windows: "_Windows") -> tuple[int, int] | None:
        """Return servo index and offset of the next intact block, or None.

        The search starts where the block of `place` is expected.
        """
        ahead = self.servos[place : place + RESYNC_BLOCKS]
        for offset in range(
            max(0, at - HEADER_SIZE), min(len(windows.own_crcs), at + RESYNC_BLOCKS * BLOCK_DTYPE.itemsize)
        ):
            if windows.ids[offset] not in ahead:
                continue
            if windows.own_crcs[offset] ^ windows.crcs[offset] in (before, windows.before(offset)):
                return place + ahead.index(windows.ids[offset]), offset
        return None


class _Windows(NamedTuple):
    """Ids and CRCs at all offsets where a servo's block may begin."""

    raw: bytes
    own_crcs: list[int]  # contribution of the block's bytes to the CRC of the block
    ids: list[int]
    crcs: list[int]  # received CRC at the end of the block

    @classmethod
    def of(cls, raw: bytes) -> "_Windows":
        octets = sliding_window_view(np.frombuffer(raw, np.uint8), BLOCK_DTYPE.itemsize)
        crcs = octets[:, CHECKED_SIZE] | octets[:, CHECKED_SIZE + 1].astype(np.uint16) << 8
        return cls(raw, _own_crcs(octets[:, :CHECKED_SIZE]).tolist(), octets[:, 1].tolist(), crcs.tolist())

    def before(self, offset: int) -> int:
        """Return the previous block's contribution to the CRC of a block.

        The two bytes before the block's offset are taken as the previous CRC; -1 if there are fewer bytes.
        """
        return int(_CRC_CARRY[self.raw[offset - 2] | self.raw[offset - 1] << 8]) if offset >= 2 else -1


@dataclass(frozen=True)
class PlainQuery(Query):
    """Query with one status packet per servo.

    It is a sync read, a bulk read, or the read of one servo.
    """

    chained = False

    @cached_property
    def data(self) -> bytes:
        """Bytes of the read, sync read or bulk read packet."""
        if len(self.servos) == 1:
            return read_packet(self.servos[0], self.addresses[0], RECORD_SIZE)
        return self._request(fast=False)

    @cached_property
    def length(self) -> int:
        """Total length of all servos' replies without stuffing [bytes]."""
        return (STATUS_OVERHEAD + RECORD_SIZE) * len(self.servos)

    def parse(self, raw: bytes) -> ServoReplies:
        """Collect the status packets of the queried servos from received bytes."""
        blocks: Records = np.zeros(len(self.servos), dtype=BLOCK_DTYPE)
        received: Flags = np.zeros(len(self.servos), dtype=np.bool_)
        for status in Reader().feed(raw):
            if (
                status.instruction != Instruction.STATUS
                or status.id not in self.servos
                or len(status.data) != RECORD_SIZE
            ):
                continue
            place = self.servos.index(status.id)
            whole = bytes((status.error, status.id)) + status.data + bytes(2)
            blocks[place] = np.frombuffer(whole, BLOCK_DTYPE, 1)[0]
            received[place] = True
        lacking = (STATUS_OVERHEAD + RECORD_SIZE) * int((~received).sum())
        return ServoReplies(blocks, received, bool(received.all()), len(raw) + lacking)

    def is_complete(self, raw: bytes) -> bool:
        """Return False, because stuffing makes the length unpredictable.

        Only the timeout ends such a reply.
        """
        return False


@lru_cache(256)
def make_query(servos: tuple[int, ...], addresses: tuple[int, ...], *, fast: bool) -> Query:
    """Return the query for the records of some servos.

    Args:
        servos: ids, in query order.
        addresses: address of each servo's record.
        fast: whether all of them answer fast reads; a single servo is read plainly.
    """
    return FastQuery(servos, addresses) if fast and len(servos) > 1 else PlainQuery(servos, addresses)


_BYTE_CONTRIBUTIONS = byte_contributions(CHECKED_SIZE).ravel()  # [256 per position] contribution to a block's CRC
_BYTE_ROWS = np.arange(CHECKED_SIZE) * 256  # index of each position's first value in _BYTE_CONTRIBUTIONS
_CRC_CARRY = crc_contributions(CHECKED_SIZE)  # contribution of each possible CRC to the next block's CRC


def _own_crcs(octets: Bytes) -> Crcs:
    """Compute the CRC contribution (m,) of each block's own data bytes."""
    contributions: Crcs = np.bitwise_xor.reduce(_BYTE_CONTRIBUTIONS.take(octets + _BYTE_ROWS), axis=1)
    return contributions
