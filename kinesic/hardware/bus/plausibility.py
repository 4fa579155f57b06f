"""What is believed of what servos say.

A CRC of 16 bits lets about one random error in 65536 pass, and Protocol 2.0 numbers no answers. So a record must be
newer by the servo's own clock than the one before, and what is surprising must be said twice: a joint that jumped, a
temperature that leapt, an error register that the alert bit does not confirm. A record without voltage is none: the
servo has rebooted and no longer shows its registers in its cells.
"""

from math import inf

import numpy as np

from kinesic.body.arrays import Flags, Floats
from kinesic.body.servo import TICKS_PER_TURN
from kinesic.hardware.bus.cycle import BLOCK, Records, signature
from kinesic.hardware.bus.query import ServoReplies
from kinesic.hardware.protocol.models import Model
from kinesic.hardware.protocol.packet import ALERT
from kinesic.hardware.protocol.registers import CLOCK_WRAP, SPEED, TICK, Register

BY_HAND = 2 * TICKS_PER_TURN  # [ticks/s] that a limp joint may be pushed
SURE = 2.0  # times its speed limit that a servo may seem to move
LEEWAY = 40  # [ticks] that a joint may jump at any time
LEAP, RUSH = 5, 60.0  # [C], [C/s] that a servo may seem to warm between two records
LATEST = CLOCK_WRAP // 2  # [ms] of the servo's clock beyond which "newer" is "older"
TRUST = 3  # records from the past in a row after which the servo's clock must have started anew

Place = slice | np.ndarray[tuple[int], np.dtype[np.intp]]


class PlausibilityFilter:
    """The last believed record of every servo of a bus, and the way in."""

    def __init__(self, models: tuple[Model, ...], period: float) -> None:
        """Nothing is known at first.

        Args:
            models: of the servos, in the order of the bus.
            period: [s] between cycles.
        """
        count = len(models)
        self.blocks: Records = np.zeros(count, dtype=BLOCK)  # read-only, as the next two: each change makes new ones
        self.signature = signature(self.blocks)
        self.times: Floats = np.full(count, -inf)
        self.fresh: Flags = np.zeros(count, dtype=np.bool_)
        self.late: Flags = self.fresh  # (n,) heard in this cycle, but of an earlier one
        self.forgetful: set[int] = set()  # places of those whose cells must be set again
        self.doubted: set[int] = set()  # places where doubt arose in this cycle
        limits = np.array([model.starts(Register.VELOCITY_LIMIT) * SPEED / TICK for model in models])
        self._pace = np.maximum(SURE * limits, BY_HAND)  # (n,) [ticks/s]
        self._reach = (self._pace * 2 * period).astype(np.int32) + LEEWAY  # (n,) [ticks] between two cycles
        self._span = 2 * self._reach.astype(np.uint32)
        self._doubts: dict[int, np.void] = {}
        self._stale: dict[int, int] = {}  # records from the past, in a row
        self._unset: set[int] = set()  # places of those whose clock is no longer compared with the wire's
        self._none, self._every = self.fresh, np.ones(count, dtype=np.bool_)
        self._ones = np.ones(count)

    def begin(self) -> None:
        """A new cycle: nothing in it is fresh yet."""
        self.fresh = self.late = self._none

    def admit(self, places: Place, answer: ServoReplies, time: float) -> None:
        """Believes what is plausible.

        Args:
            places: of the answer's servos among all.
            answer: CRC and id checked.
            time: [s] when the servos were asked.
        """
        if answer.whole and isinstance(places, slice) and self._unsurprising(answer.blocks):
            self.blocks = answer.blocks
            self.times = self._ones * time
            self.fresh = self._every
            self._doubts.clear()
            self._stale.clear()
            self._unset.clear()
            return
        blocks, times, fresh = self.blocks.copy(), self.times.copy(), self.fresh.copy()
        for index, block in self._heard(places, answer):
            if self._believed(index, block, time):
                blocks[index], times[index], fresh[index] = block, time, True
                self._doubts.pop(index, None)
                self._stale.pop(index, None)
                self._unset.discard(index)
        self.blocks, self.times, self.fresh, self.signature = blocks, times, fresh, signature(blocks)

    def admit_late(self, places: Place, answer: ServoReplies, now: float, *, asked: float | None = None) -> None:
        """Believes answers to an earlier question, if they are news; when they were given, the servo's clock tells.

        Args:
            places: of the answer's servos among all.
            answer: CRC and id checked.
            now: [s].
            asked: [s] when that question was asked, if it is known: who is heard for the first time is dated by it.
        """
        blocks, times, late = self.blocks.copy(), self.times.copy(), self.late.copy()
        for index, block in self._heard(places, answer):
            since, known = self._since(index, block), times[index] > -inf
            given = times[index] + since / 1000 if known else asked
            if given is None:
                continue
            if (not known or 0 < since < LATEST) and self._believed(index, block, now):
                blocks[index], times[index], late[index] = block, min(now, given), True
        self.blocks, self.times, self.late, self.signature = blocks, times, late, signature(blocks)

    def _heard(self, places: Place, answer: ServoReplies) -> list[tuple[int, np.void]]:
        """Places and blocks of those who answered."""
        indices = np.arange(len(self.blocks))[places][answer.found].tolist()
        return list(zip(indices, answer.blocks[answer.found], strict=True))

    def _unsurprising(self, blocks: Records) -> bool:
        """Whether a joint answer looks like the one before it, a moment later: nothing needs a second look."""
        before = self.blocks
        if signature(blocks) != self.signature:
            return False
        if not 0 < (int(blocks["tick"][0]) - int(before["tick"][0])) % CLOCK_WRAP < LATEST:
            return False
        jumps = blocks["position"] - before["position"]
        jumps += self._reach
        return not (jumps.view(np.uint32) > self._span).any()

    def is_late(self, place: int, block: np.void, time: float, *, leeway: float) -> bool:
        """Whether a record was taken clearly before a time [s], more than a leeway [s], by the servo's clock."""
        elapsed = time - self.times[place]
        if place in self._unset:
            return False
        return bool(elapsed < LATEST / 1000 and self._since(place, block) / 1000 < elapsed - leeway)

    def without_late(self, places: Place, answer: ServoReplies, time: float, *, leeway: float) -> ServoReplies:
        """What of a broken answer was given after a time [s]; the rest answers an earlier question, and is news of it.

        Args:
            places: of the answer's servos among all.
            answer: CRC and id checked.
            time: [s] when the servos were asked.
            leeway: [s] by which a record may seem older.
        """
        heard = self._heard(places, answer)
        late = {index for index, block in heard if self.is_late(index, block, time, leeway=leeway)}
        if not late:
            return answer
        overdue = np.array([index in late for index in np.arange(len(self.blocks))[places].tolist()], dtype=np.bool_)
        self.admit_late(places, answer._replace(found=overdue), time)
        return answer._replace(found=answer.found & ~overdue)

    def forget(self, place: int) -> None:
        """The servo starts anew: whatever it says first is believed."""
        times = self.times.copy()
        times[place] = -inf
        self.times = times
        self._doubts.pop(place, None)
        self._stale.pop(place, None)

    def distrust_clocks(self) -> None:
        """Servos' clocks and the wire's have moved apart: the next answer in time tells anew by how much."""
        self._unset = set(range(len(self.blocks)))

    def _since(self, index: int, block: np.void) -> int:
        """[ms] of the servo's clock since the last record."""
        return (int(block["tick"]) - int(self.blocks[index]["tick"])) % CLOCK_WRAP

    def _believed(self, index: int, block: np.void, time: float) -> bool:
        if block["volts"] == 0:
            self.forgetful.add(index)
            return False
        elapsed = time - self.times[index]
        if elapsed == inf:
            return True
        if elapsed < LATEST / 1000 and not 0 < self._since(index, block) < LATEST:
            self._stale[index] = self._stale.get(index, 0) + 1
            return self._stale[index] > TRUST
        if self._ordinary(block, self.blocks[index], self._pace[index], elapsed):
            return True
        doubt = self._doubts.get(index)
        if doubt is not None and self._repeated(block, doubt):
            return True
        self._doubts[index] = block.copy()
        self.doubted.add(index)
        return False

    def _ordinary(self, block: np.void, before: np.void, pace: float, elapsed: float) -> bool:
        """Whether nothing about a record surprises."""
        jump = abs(int(block["position"]) - int(before["position"]))
        leap = abs(int(block["temperature"]) - int(before["temperature"]))
        confirmed = (block["error"] >= ALERT) == (block["hardware_error"] > 0)
        return bool(jump <= pace * elapsed + LEEWAY and leap <= LEAP + RUSH * elapsed and confirmed)

    def _repeated(self, block: np.void, doubt: np.void) -> bool:
        """Whether a surprise was said twice."""
        jump = abs(int(block["position"]) - int(doubt["position"]))
        leap = abs(int(block["temperature"]) - int(doubt["temperature"]))
        return bool(jump <= 2 * LEEWAY and leap <= LEAP and block["hardware_error"] == doubt["hardware_error"])
