"""Asks several servos for their records in one packet, and reads the answer, damaged or not.

A fast read is answered by one joint reply: a header, then a block per servo in the order asked, each ending with the
CRC of everything so far (Protocol 2.0, never stuffed). A block is checked against the CRC that stands before it, so a
damaged one spoils neither what comes before nor what comes after. Older firmware answers with one status per servo.
"""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import ClassVar, NamedTuple

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from kinesic.body.arrays import Flags
from kinesic.hardware.bus.cycle import BLOCK, SIZE, Records
from kinesic.hardware.protocol.crc import Bytes, Crcs, byte_contributions, crc_contributions
from kinesic.hardware.protocol.packet import (
    BROADCAST,
    HEADER,
    STATUS_OVERHEAD,
    Instruction,
    Reader,
    bulk_read,
    crc16,
    read_packet,
    sync_read,
)

HEAD = 8  # [bytes] before the first block
CHECKED = BLOCK.itemsize - 2  # [bytes] of a block before its CRC
REACH = 3  # blocks after a damaged one within which the answer must go on


class ServoReplies(NamedTuple):
    """What came of each servo, in the order asked."""

    blocks: Records  # (m,) of dtype BLOCK; only those found mean something
    found: Flags  # (m,)
    whole: bool  # all were found
    end: int  # [bytes] where it ends, or where it should if it is not whole


@dataclass(frozen=True)
class Query(ABC):
    """A question to servos: what to send, and how to read the answer."""

    servos: tuple[int, ...]  # ids, in the order asked
    addresses: tuple[int, ...]  # where each shows its record
    chained: ClassVar[bool]  # whether a servo that keeps silent ends the answer

    @property
    @abstractmethod
    def data(self) -> bytes:
        """The packet that asks."""

    @property
    @abstractmethod
    def length(self) -> int:
        """[bytes] of a full answer."""

    @abstractmethod
    def answer(self, raw: bytes) -> ServoReplies:
        """Reads what has come so far, noise and older answers included."""

    @abstractmethod
    def complete(self, raw: bytes) -> bool:
        """Returns whether the last servo has sent its last byte, whatever came of the others."""

    def _request(self, *, fast: bool) -> bytes:
        """A sync read where all keep their cells at one address, else a bulk read."""
        if len(set(self.addresses)) == 1:
            return sync_read(self.servos, self.addresses[0], SIZE, fast=fast)
        return bulk_read({servo: (a, SIZE) for servo, a in zip(self.servos, self.addresses, strict=True)}, fast=fast)


@dataclass(frozen=True)
class FastQuery(Query):
    """A fast sync read, or a fast bulk read where the models keep their cells at different addresses."""

    chained = True

    @cached_property
    def data(self) -> bytes:
        """The packet that asks."""
        return self._request(fast=True)

    @cached_property
    def length(self) -> int:
        """[bytes] of a full answer."""
        return HEAD + BLOCK.itemsize * len(self.servos)

    @cached_property
    def _head(self) -> bytes:
        inside = self.length - HEAD + 1
        return HEADER + bytes((BROADCAST, inside & 0xFF, inside >> 8, Instruction.STATUS))

    @cached_property
    def _first(self) -> int:
        """What the header contributes to the CRC of the first block."""
        return crc16(self._head + bytes(CHECKED))

    @cached_property
    def _unchained(self) -> np.uint16:
        """The same, less what the last two bytes of the header would contribute if they were a CRC."""
        return np.uint16(self._first ^ int(_CARRIED[int.from_bytes(self._head[-2:], "little")]))

    @cached_property
    def _ids(self) -> bytes:
        return bytes(self.servos)

    @cached_property
    def _all(self) -> Flags:
        every: Flags = np.ones(len(self.servos), dtype=np.bool_)
        every.setflags(write=False)
        return every

    def answer(self, raw: bytes) -> ServoReplies:
        """See `Query`."""
        first = start = raw.find(self._head)
        while 0 <= start <= len(raw) - self.length:
            blocks = self._sound(raw, start)
            if blocks is not None:
                return ServoReplies(blocks, self._all, True, start + self.length)
            start = raw.find(self._head, start + 1)  # behind an answer to other servos, this one may stand
        return self._salvaged(raw, first)

    def _sound(self, raw: bytes, start: int) -> Records | None:
        """Returns the blocks of an undamaged answer; None if it is damaged."""
        offset, size, count = start + HEAD, BLOCK.itemsize, len(self.servos)
        if raw[offset + 1 : start + self.length : size] != self._ids:
            return None
        octets = np.ndarray((count, CHECKED), np.uint8, raw, offset, (size, 1))
        before: Crcs = np.ndarray((count,), "<u2", raw, offset - 2, (size,))
        crcs: Crcs = np.ndarray((count,), "<u2", raw, offset + CHECKED, (size,))
        wrong = _own(octets)
        wrong ^= _CARRIED.take(before)
        wrong ^= crcs
        wrong[0] ^= self._unchained
        return None if wrong.any() else np.frombuffer(raw, BLOCK, count, offset)

    def complete(self, raw: bytes) -> bool:
        """See `Query`: the last block, sound, ends an answer, though it may have lost bytes."""
        last = raw[-BLOCK.itemsize :]
        if len(raw) < BLOCK.itemsize + 2 or last[1] != self.servos[-1]:
            return False
        before = raw[-BLOCK.itemsize - 2 : -BLOCK.itemsize]
        crc = crc16(last[:CHECKED], crc16(before, int.from_bytes(before, "little")))
        return crc == int.from_bytes(last[CHECKED:], "little")

    def _salvaged(self, raw: bytes, start: int) -> ServoReplies:
        """Every sound block that can be found, although bytes were changed, lost or added.

        Block after block is looked for where it should stand; where one is damaged, the next sound one within reach
        shows where the answer goes on.
        """
        blocks: Records = np.zeros(len(self.servos), dtype=BLOCK)
        found: Flags = np.zeros(len(self.servos), dtype=np.bool_)
        if len(raw) < BLOCK.itemsize:
            return ServoReplies(blocks, found, False, self.length)
        windows = _Windows.of(raw)
        at, before = (start + HEAD if start >= 0 else HEAD), self._first
        place = 0
        while place < len(self.servos):
            here = self._next_sound(place, at, before, windows)
            if here is None:
                break
            place, at = here
            blocks[place] = np.frombuffer(raw, BLOCK, 1, at)[0]
            found[place] = True
            before = int(_CARRIED[windows.crcs[at]])
            place, at = place + 1, at + BLOCK.itemsize
        return ServoReplies(blocks, found, bool(found.all()), at + BLOCK.itemsize * (len(self.servos) - place))

    def _next_sound(self, place: int, at: int, before: int, windows: "_Windows") -> tuple[int, int] | None:
        """Finds place and offset of the next sound block, from where the block of `place` should stand."""
        ahead = self.servos[place : place + REACH]
        for offset in range(max(0, at - HEAD), min(len(windows.own), at + REACH * BLOCK.itemsize)):
            if windows.ids[offset] not in ahead:
                continue
            if windows.own[offset] ^ windows.crcs[offset] in (before, windows.before(offset)):
                return place + ahead.index(windows.ids[offset]), offset
        return None


class _Windows(NamedTuple):
    """Every place in some bytes where a block may begin."""

    raw: bytes
    own: list[int]  # what its bytes contribute to its CRC
    ids: list[int]
    crcs: list[int]  # the CRC that it ends with

    @classmethod
    def of(cls, raw: bytes) -> "_Windows":
        octets = sliding_window_view(np.frombuffer(raw, np.uint8), BLOCK.itemsize)
        crcs = octets[:, CHECKED] | octets[:, CHECKED + 1].astype(np.uint16) << 8
        return cls(raw, _own(octets[:, :CHECKED]).tolist(), octets[:, 1].tolist(), crcs.tolist())

    def before(self, offset: int) -> int:
        """What the two bytes before a window, taken as a CRC, contribute to its own; -1 at the beginning."""
        return int(_CARRIED[self.raw[offset - 2] | self.raw[offset - 1] << 8]) if offset >= 2 else -1


@dataclass(frozen=True)
class PlainQuery(Query):
    """A sync read, a bulk read, or the read of a single servo: one status each."""

    chained = False

    @cached_property
    def data(self) -> bytes:
        """The packet that asks."""
        if len(self.servos) == 1:
            return read_packet(self.servos[0], self.addresses[0], SIZE)
        return self._request(fast=False)

    @cached_property
    def length(self) -> int:
        """[bytes] of a full answer without stuffing."""
        return (STATUS_OVERHEAD + SIZE) * len(self.servos)

    def answer(self, raw: bytes) -> ServoReplies:
        """See `Query`."""
        blocks: Records = np.zeros(len(self.servos), dtype=BLOCK)
        found: Flags = np.zeros(len(self.servos), dtype=np.bool_)
        for status in Reader().feed(raw):
            if status.instruction != Instruction.STATUS or status.id not in self.servos or len(status.data) != SIZE:
                continue
            place = self.servos.index(status.id)
            whole = bytes((status.error, status.id)) + status.data + bytes(2)
            blocks[place] = np.frombuffer(whole, BLOCK, 1)[0]
            found[place] = True
        lacking = (STATUS_OVERHEAD + SIZE) * int((~found).sum())
        return ServoReplies(blocks, found, bool(found.all()), len(raw) + lacking)

    def complete(self, raw: bytes) -> bool:
        """See `Query`: stuffing may make each status longer, so only time tells."""
        return False


@lru_cache(256)
def question_to(servos: tuple[int, ...], addresses: tuple[int, ...], *, fast: bool) -> Query:
    """Returns the question that asks servos for their records.

    Args:
        servos: ids, in the order to ask.
        addresses: where each shows its record.
        fast: whether all of them answer fast reads; a single one is read plainly anyway.
    """
    return FastQuery(servos, addresses) if fast and len(servos) > 1 else PlainQuery(servos, addresses)


_PLACES = byte_contributions(CHECKED).ravel()
_ROWS = np.arange(CHECKED) * 256
_CARRIED = crc_contributions(CHECKED)


def _own(octets: Bytes) -> Crcs:
    """(m,) what the bytes of blocks, their CRCs left out, (m, 20), contribute to those."""
    own: Crcs = np.bitwise_xor.reduce(_PLACES.take(octets + _ROWS), axis=1)
    return own
