"""Filters the records of servos: a record counts if it is plausible, a surprise only when it is repeated.

A CRC of 16 bits lets about one random error in 65536 pass, and Protocol 2.0 numbers no answers. So a record must be
newer by the servo's own clock than the one before (a clock that stands still dates nothing), and what is surprising
must be said twice: a limp joint that jumped, a temperature that leapt, an error register that the alert bit does not
confirm. No repetition makes true what cannot
be: a value outside its bounds, or a jump of a joint whose servo has torque, which would pull the goals along. A record
without voltage is none: the servo has rebooted and no longer shows its registers in its cells.
"""

from math import inf

import numpy as np

from kinesic.body.arrays import Flags, Floats
from kinesic.body.servo import TICKS_PER_TURN
from kinesic.hardware.bus.bounds import RecordBounds
from kinesic.hardware.bus.cycle import BLOCK, Records, signature
from kinesic.hardware.bus.query import ServoReplies
from kinesic.hardware.protocol.packet import ALERT
from kinesic.hardware.protocol.registers import CLOCK_WRAP

LEEWAY = 40  # [ticks] that a joint may jump at any time
LEAP, RUSH = 5, 60.0  # [C], [C/s] that a servo may seem to warm between two records
LATEST = CLOCK_WRAP // 2  # [ms] of the servo's clock beyond which "newer" is "older"
BLUR = 0.0015  # [s] by which a clock that counts in ms may be behind
TRUST = 3  # records from the past in a row after which the servo's clock must have started anew

Place = slice | np.ndarray[tuple[int], np.dtype[np.intp]]


class PlausibilityFilter:
    """Keeps the last believed record of every servo of a bus, and decides which new ones count."""

    def __init__(self, bounds: RecordBounds, period: float) -> None:
        """Knows no record yet.

        Args:
            bounds: of the servos, in the order of the bus.
            period: [s] between cycles.
        """
        count = len(bounds.pace)
        self.blocks: Records = np.zeros(count, dtype=BLOCK)  # read-only, as the next two: each change makes new ones
        self.signature = signature(self.blocks)
        self.times: Floats = np.full(count, -inf)
        self.fresh: Flags = np.zeros(count, dtype=np.bool_)
        self.late: Flags = self.fresh  # (n,) came in this cycle, but of an earlier one
        self.forgetful: set[int] = set()  # places of those whose cells must be set again
        self.doubted: set[int] = set()  # places where doubt arose in this cycle
        self.impossible: dict[int, str] = {}  # place -> what it began in this cycle to say that cannot be
        self._bounds, self._brief = bounds, 2 * period
        self._reach = (bounds.pace * self._brief).astype(np.int32) + LEEWAY  # (n,) [ticks] between two cycles
        self._span = 2 * self._reach.astype(np.uint32)
        self._doubts: dict[int, np.void] = {}
        self._accused: set[int] = set()  # places of those who say what cannot be
        self._past: dict[int, list[int]] = {}  # place -> clocks of records from the past, in a row, each after the last
        self._unset: set[int] = set()  # places of those whose clock is no longer compared with the wire's
        self._none, self._every = self.fresh, np.ones(count, dtype=np.bool_)
        self._ones = np.ones(count)

    def begin(self) -> None:
        """Starts a cycle, in which nothing is fresh yet."""
        self.fresh = self.late = self._none

    def admit(self, places: Place, answer: ServoReplies, time: float, *, open_since: float = inf) -> None:
        """Takes the plausible records of an answer.

        Args:
            places: of the answer's servos among all.
            answer: CRC and id checked.
            time: [s] when the servos were asked.
            open_since: [s] when this cycle began to ask, where an earlier answer may come: then servos' clocks tell.
        """
        if open_since == inf and answer.whole and isinstance(places, slice) and self._continues(answer.blocks):
            self.blocks = answer.blocks
            self.times = self._ones * time
            self.fresh = self._every
            self._doubts.clear()
            self._accused.clear()
            self._past.clear()
            self._unset.clear()
            return
        blocks, times, fresh, late = self.blocks.copy(), self.times.copy(), self.fresh.copy(), self.late.copy()
        for index, block in self._answers(places, answer):
            if self._accepts(index, block, time):
                told = self._time_by_clock(index, block, time) if open_since < inf else inf
                old = told < open_since - BLUR
                blocks[index], times[index] = block, told if old else min(time, max(told, open_since))
                fresh[index], late[index] = fresh[index] or not old, late[index] or old
                self._doubts.pop(index, None)
                self._accused.discard(index)
                self._past.pop(index, None)
                self._unset.discard(index)
        self.blocks, self.times, self.signature = blocks, times, signature(blocks)
        self.fresh, self.late = fresh, late

    def admit_late(self, places: Place, answer: ServoReplies, now: float, *, sent_at: float | None = None) -> None:
        """Takes the answers to an earlier question that are news, dated by the servo's clock.

        Args:
            places: of the answer's servos among all.
            answer: CRC and id checked.
            now: [s].
            sent_at: [s] when that question was asked, if known: it dates the first record of a servo.
        """
        blocks, times, late = self.blocks.copy(), self.times.copy(), self.late.copy()
        for index, block in self._answers(places, answer):
            since, known = self._since(index, block), times[index] > -inf
            given = times[index] + since / 1000 if known else sent_at
            if given is None:
                continue
            if (not known or 0 < since < LATEST) and self._accepts(index, block, now):
                blocks[index], times[index], late[index] = block, min(now, given), True
        self.blocks, self.times, self.late, self.signature = blocks, times, late, signature(blocks)

    def _answers(self, places: Place, answer: ServoReplies) -> list[tuple[int, np.void]]:
        indices = np.arange(len(self.blocks))[places][answer.found].tolist()
        return list(zip(indices, answer.blocks[answer.found], strict=True))

    def _continues(self, blocks: Records) -> bool:
        """Whether a joint answer looks like the one before it, a moment later, so that nothing needs a second look."""
        before = self.blocks
        if signature(blocks) != self.signature:
            return False
        since = (blocks["tick"] - before["tick"]) % CLOCK_WRAP  # (n,) [ms] uint16, which wraps where it must
        if not ((since > 0) & (since < LATEST)).all():
            return False
        jumps = blocks["position"] - before["position"]
        jumps += self._reach
        return not (jumps.view(np.uint32) > self._span).any() and not self._bounds.outside(blocks).any()

    def is_late(self, place: int, block: np.void, time: float, *, leeway: float) -> bool:
        """Returns whether a record is older than a time [s] by more than a leeway [s], by the servo's clock."""
        elapsed = time - self.times[place]
        if place in self._unset:
            return False
        return bool(elapsed < LATEST / 1000 and self._since(place, block) / 1000 < elapsed - leeway)

    def without_late(self, places: Place, answer: ServoReplies, time: float, *, leeway: float) -> ServoReplies:
        """Splits a broken answer: returns what was given after a time [s], and takes the rest as late.

        Args:
            places: of the answer's servos among all.
            answer: CRC and id checked.
            time: [s] when the servos were asked.
            leeway: [s] by which a record may seem older.
        """
        answers = self._answers(places, answer)
        late = {index for index, block in answers if self.is_late(index, block, time, leeway=leeway)}
        if not late:
            return answer
        overdue = np.array([index in late for index in np.arange(len(self.blocks))[places].tolist()], dtype=np.bool_)
        self.admit_late(places, answer._replace(found=overdue), time)
        return answer._replace(found=answer.found & ~overdue)

    def forget(self, place: int) -> None:
        """Forgets a servo that has rebooted, so that its next record is believed."""
        times = self.times.copy()
        times[place] = -inf
        self.times = times
        self._doubts.pop(place, None)
        self._past.pop(place, None)
        self._unset.add(place)

    def distrust_clocks(self) -> None:
        """Stops comparing servos' clocks with the wire's, until the next answer in time sets them anew."""
        self._unset = set(range(len(self.blocks)))

    def _time_by_clock(self, index: int, block: np.void, now: float) -> float:
        """Return a record's time [s] by the servo's clock, or infinity.

        The clock counts too few milliseconds to date a record after a long silence.
        """
        before = self.times[index]
        is_unknown = now - before >= LATEST / 1000 or index in self._unset
        return inf if is_unknown else float(before + self._since(index, block) / 1000)

    def _since(self, index: int, block: np.void) -> int:
        """[ms] of the servo's clock since the last record."""
        return (int(block["tick"]) - int(self.blocks[index]["tick"])) % CLOCK_WRAP

    def _accepts(self, index: int, block: np.void, time: float) -> bool:
        if block["volts"] == 0:
            self.forgetful.add(index)
            return False
        if reason := self._bounds.reason(index, block):
            self._accuse(index, reason)
            return False
        elapsed = time - self.times[index]
        if elapsed == inf:
            return True
        since = self._since(index, block)
        if since == 0:
            return False
        if since >= LATEST and elapsed < LATEST / 1000:
            return self._has_started_anew(index, int(block["tick"]))
        return self._is_credible(index, block, time)

    def _has_started_anew(self, index: int, tick: int) -> bool:
        """Whether records from the past go on for so long that the servo's clock must have started from zero."""
        past = self._past.setdefault(index, [])
        if past and not 0 < (tick - past[-1]) % CLOCK_WRAP < LATEST:
            past.clear()
        past.append(tick)
        return len(past) > TRUST

    def _is_credible(self, index: int, block: np.void, time: float) -> bool:
        """Whether a record that is news within its bounds fits to what was said before, believed or not."""
        before, elapsed = self.blocks[index], time - self.times[index]
        doubt = self._doubts.get(index)
        moment = elapsed if doubt is None else min(elapsed, self._brief)
        near = self._is_near(index, block, before, moment)
        if near and self._is_calm(block, before, moment):
            return True
        if doubt is not None and not near and block["torque"]:
            if self._is_near(index, block, doubt, self._brief):  # it goes on from where it cannot have come to
                self._doubts[index] = block.copy()
                self._accuse(index, f"position leapt from {before['position']} to {block['position']}, with torque")
                return False
            if self._is_near(index, block, before, elapsed) and self._is_calm(block, before, elapsed):
                return True
        elif doubt is not None and self._confirms(block, doubt):
            return True
        self._doubts[index] = block.copy()
        self.doubted.add(index)
        return False

    def _accuse(self, index: int, reason: str) -> None:
        if index not in self._accused:
            self._accused.add(index)
            self.impossible[index] = reason

    def _is_near(self, index: int, block: np.void, before: np.void, elapsed: float) -> bool:
        """Whether a joint can have come from one record to the other; torque coming on forgets whole turns."""
        jump = abs(int(block["position"]) - int(before["position"]))
        if block["torque"] and not before["torque"]:
            jump = abs((jump + TICKS_PER_TURN // 2) % TICKS_PER_TURN - TICKS_PER_TURN // 2)
        return bool(jump <= self._bounds.pace[index] * elapsed + LEEWAY)

    def _is_calm(self, block: np.void, before: np.void, elapsed: float) -> bool:
        """Whether its temperature can have changed so, and its error is confirmed by the alert bit."""
        leap = abs(int(block["temperature"]) - int(before["temperature"]))
        confirmed = (block["error"] >= ALERT) == (block["hardware_error"] > 0)
        return bool(leap <= LEAP + RUSH * elapsed and confirmed)

    def _confirms(self, block: np.void, doubt: np.void) -> bool:
        jump = abs(int(block["position"]) - int(doubt["position"]))
        leap = abs(int(block["temperature"]) - int(doubt["temperature"]))
        return bool(jump <= 2 * LEEWAY and leap <= LEAP and block["hardware_error"] == doubt["hardware_error"])
