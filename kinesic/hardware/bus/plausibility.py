"""Plausibility filter for the records of servos.

A record counts if it is plausible, and a surprising one only if it is repeated. A CRC of 16 bits lets about one random
error in 65536 pass, and Protocol 2.0 does not number replies. So a record must be newer by the servo's own clock than
the one before (a stopped clock dates nothing). Surprising records must be repeated: a torque-free joint that jumped, a
temperature jump, or an error register that the alert bit does not confirm. Impossible records are never accepted: a
value outside its bounds, or a jump of a joint with torque, which would pull the goals along. A record with 0 V means
that the servo has rebooted and no longer shows its registers in its cells.
"""

from dataclasses import dataclass
from math import inf

import numpy as np

from kinesic.body.arrays import Flags, Floats
from kinesic.body.servo import TICKS_PER_TURN
from kinesic.hardware.bus.bounds import RecordBounds
from kinesic.hardware.bus.cycle import BLOCK_DTYPE, Records, signature
from kinesic.hardware.bus.query import ServoReplies
from kinesic.hardware.protocol.packet import ALERT_BIT
from kinesic.hardware.protocol.registers import CLOCK_WRAP

MAX_CLOCK_ADVANCE = CLOCK_WRAP // 2  # [ms] largest clock advance between records; a larger one means an older record

ServoSelection = slice | np.ndarray[tuple[int], np.dtype[np.intp]]


@dataclass(frozen=True)
class PlausibilityTuning:
    """Tolerances for changes between two records of a servo."""

    position_tolerance: int = 40  # [ticks] position jump of a servo that is always plausible
    temperature_tolerance: int = 5  # [C] temperature change that is always plausible
    max_heating_rate: float = 60.0  # [C/s] plausible temperature change over time
    clock_resolution: float = 0.0015  # [s] largest lag of a clock that counts milliseconds
    clock_reset_count: int = 3  # consecutive records from the past after which the servo's clock must have restarted


PLAUSIBILITY_TUNING = PlausibilityTuning()  # tolerances on every bus


class PlausibilityFilter:
    """Filter that keeps the last accepted record of every servo."""

    def __init__(self, bounds: RecordBounds, period: float) -> None:
        """Start with no accepted record for any servo.

        Args:
            bounds: bounds of the servos, in the order of the bus.
            period: [s] between cycles.
        """
        count = len(bounds.max_velocity)
        self.blocks: Records = np.zeros(
            count, dtype=BLOCK_DTYPE
        )  # read-only, as the next two: each change makes new ones
        self.signature = signature(self.blocks)
        self.times: Floats = np.full(count, -inf)
        self.fresh: Flags = np.zeros(count, dtype=np.bool_)
        self.late: Flags = self.fresh  # (n,) whether a record of an earlier cycle arrived in this cycle
        self.unmapped: set[int] = set()  # indices of servos whose cells must be restored
        self.doubted: set[int] = set()  # indices of servos with a new doubt in this cycle
        self.impossible: dict[int, str] = {}  # index -> impossible value that began in this cycle
        self._bounds, self._brief_time = bounds, 2 * period
        self._reach = (bounds.max_velocity * self._brief_time).astype(
            np.int32
        ) + PLAUSIBILITY_TUNING.position_tolerance  # (n,) [ticks] between two cycles
        self._span = 2 * self._reach.astype(np.uint32)
        self._doubts: dict[int, np.void] = {}
        self._impossible: set[int] = set()  # indices of servos with impossible values
        self._past: dict[int, list[int]] = {}  # index -> increasing clocks of consecutive records from the past
        self._unset: set[int] = set()  # indices of servos whose clock is not compared with the wire's
        self._none, self._every = self.fresh, np.ones(count, dtype=np.bool_)
        self._ones = np.ones(count)

    def begin(self) -> None:
        """Mark all servo records as outdated at the start of a cycle."""
        self.fresh = self.late = self._none

    def admit(self, places: ServoSelection, answer: ServoReplies, time: float, *, open_since: float = inf) -> None:
        """Accept the plausible records of a reply.

        Args:
            places: indices of the reply's servos.
            answer: reply with checked CRC and ids.
            time: [s] when the servos were queried.
            open_since: [s] first query of this cycle, if an earlier reply may arrive; servo clocks then date the
                records.
        """
        if open_since == inf and answer.whole and isinstance(places, slice) and self._continues(answer.blocks):
            self.blocks = answer.blocks
            self.times = self._ones * time
            self.fresh = self._every
            self._doubts.clear()
            self._impossible.clear()
            self._past.clear()
            self._unset.clear()
            return
        blocks, times, fresh, late = self.blocks.copy(), self.times.copy(), self.fresh.copy(), self.late.copy()
        for index, block in self._answers(places, answer):
            if self._accepts(index, block, time):
                clock_time = self._time_by_clock(index, block, time) if open_since < inf else inf
                old = clock_time < open_since - PLAUSIBILITY_TUNING.clock_resolution
                blocks[index], times[index] = block, clock_time if old else min(time, max(clock_time, open_since))
                fresh[index], late[index] = fresh[index] or not old, late[index] or old
                self._doubts.pop(index, None)
                self._impossible.discard(index)
                self._past.pop(index, None)
                self._unset.discard(index)
        self.blocks, self.times, self.signature = blocks, times, signature(blocks)
        self.fresh, self.late = fresh, late

    def admit_late(
        self, places: ServoSelection, answer: ServoReplies, now: float, *, sent_at: float | None = None
    ) -> None:
        """Accept new records of an earlier query, dated by the servo clocks.

        Args:
            places: indices of the reply's servos.
            answer: reply with checked CRC and ids.
            now: [s].
            sent_at: [s] time of that query, if known; it dates the first record of a servo.
        """
        blocks, times, late = self.blocks.copy(), self.times.copy(), self.late.copy()
        for index, block in self._answers(places, answer):
            since, has_record = self._elapsed_ms(index, block), times[index] > -inf
            given = times[index] + since / 1000 if has_record else sent_at
            if given is None:
                continue
            if (not has_record or 0 < since < MAX_CLOCK_ADVANCE) and self._accepts(index, block, now):
                blocks[index], times[index], late[index] = block, min(now, given), True
        self.blocks, self.times, self.late, self.signature = blocks, times, late, signature(blocks)

    def _answers(self, places: ServoSelection, answer: ServoReplies) -> list[tuple[int, np.void]]:
        indices = np.arange(len(self.blocks))[places][answer.received].tolist()
        return list(zip(indices, answer.blocks[answer.received], strict=True))

    def _continues(self, blocks: Records) -> bool:
        """Return whether all records of a reply plausibly follow the previous ones.

        Then no record needs a closer check.
        """
        before = self.blocks
        if signature(blocks) != self.signature:
            return False
        since = (blocks["tick"] - before["tick"]) % CLOCK_WRAP  # (n,) [ms] uint16, whose wrap is correct here
        if not ((since > 0) & (since < MAX_CLOCK_ADVANCE)).all():
            return False
        jumps = blocks["position"] - before["position"]
        jumps += self._reach
        return not (jumps.view(np.uint32) > self._span).any() and not self._bounds.outside(blocks).any()

    def is_late(self, place: int, block: np.void, time: float, *, leeway: float) -> bool:
        """Return whether a servo record is older than a time [s].

        Its age is computed from the servo's clock, with a leeway [s].
        """
        elapsed = time - self.times[place]
        if place in self._unset:
            return False
        return bool(elapsed < MAX_CLOCK_ADVANCE / 1000 and self._elapsed_ms(place, block) / 1000 < elapsed - leeway)

    def without_late(self, places: ServoSelection, answer: ServoReplies, time: float, *, leeway: float) -> ServoReplies:
        """Accept late servo records of a damaged reply, and return the others.

        Args:
            places: indices of the reply's servos.
            answer: reply with checked CRC and ids.
            time: [s] when the servos were queried.
            leeway: [s] by which a current record may seem older.
        """
        answers = self._answers(places, answer)
        late = {index for index, block in answers if self.is_late(index, block, time, leeway=leeway)}
        if not late:
            return answer
        overdue = np.array([index in late for index in np.arange(len(self.blocks))[places].tolist()], dtype=np.bool_)
        self.admit_late(places, answer._replace(received=overdue), time)
        return answer._replace(received=answer.received & ~overdue)

    def forget(self, place: int) -> None:
        """Treat a rebooted servo as one without an accepted record.

        Its next record is then accepted.
        """
        times = self.times.copy()
        times[place] = -inf
        self.times = times
        self._doubts.pop(place, None)
        self._past.pop(place, None)
        self._unset.add(place)

    def distrust_clocks(self) -> None:
        """Ignore the servo clocks until replies are on time again."""
        self._unset = set(range(len(self.blocks)))

    def _time_by_clock(self, index: int, block: np.void, now: float) -> float:
        """Return a record's time [s] by the servo's clock, or infinity.

        The clock counts too few milliseconds to date a record after a long silence.
        """
        before = self.times[index]
        is_unknown = now - before >= MAX_CLOCK_ADVANCE / 1000 or index in self._unset
        return inf if is_unknown else float(before + self._elapsed_ms(index, block) / 1000)

    def _elapsed_ms(self, index: int, block: np.void) -> int:
        """Return the time [ms] since a servo's last record, by its clock."""
        return (int(block["tick"]) - int(self.blocks[index]["tick"])) % CLOCK_WRAP

    def _accepts(self, index: int, block: np.void, time: float) -> bool:
        if block["volts"] == 0:
            self.unmapped.add(index)
            return False
        if reason := self._bounds.reason(index, block):
            self._mark_impossible(index, reason)
            return False
        elapsed = time - self.times[index]
        if elapsed == inf:
            return True
        since = self._elapsed_ms(index, block)
        if since == 0:
            return False
        if since >= MAX_CLOCK_ADVANCE and elapsed < MAX_CLOCK_ADVANCE / 1000:
            return self._has_reset_clock(index, int(block["tick"]))
        return self._is_credible(index, block, time)

    def _has_reset_clock(self, index: int, tick: int) -> bool:
        """Record an outdated clock value, and return whether the servo's clock restarted."""
        past = self._past.setdefault(index, [])
        if past and not 0 < (tick - past[-1]) % CLOCK_WRAP < MAX_CLOCK_ADVANCE:
            past.clear()
        past.append(tick)
        return len(past) > PLAUSIBILITY_TUNING.clock_reset_count

    def _is_credible(self, index: int, block: np.void, time: float) -> bool:
        """Return whether a servo's new record is consistent with its earlier ones.

        Both accepted and doubted records count.
        """
        before, elapsed = self.blocks[index], time - self.times[index]
        doubt = self._doubts.get(index)
        moment = elapsed if doubt is None else min(elapsed, self._brief_time)
        near = self._is_near(index, block, before, moment)
        if near and self._is_calm(block, before, moment):
            return True
        if doubt is not None and not near and block["torque"]:
            if self._is_near(index, block, doubt, self._brief_time):  # it continues from the impossible position
                self._doubts[index] = block.copy()
                self._mark_impossible(
                    index, f"position jumped from {before['position']} to {block['position']}, with torque"
                )
                return False
            if self._is_near(index, block, before, elapsed) and self._is_calm(block, before, elapsed):
                return True
        elif doubt is not None and self._confirms(block, doubt):
            return True
        self._doubts[index] = block.copy()
        self.doubted.add(index)
        return False

    def _mark_impossible(self, index: int, reason: str) -> None:
        if index not in self._impossible:
            self._impossible.add(index)
            self.impossible[index] = reason

    def _is_near(self, index: int, block: np.void, before: np.void, elapsed: float) -> bool:
        """Return whether a servo can have moved this far between two records.

        Switching torque on resets the count of whole turns.
        """
        jump = abs(int(block["position"]) - int(before["position"]))
        if block["torque"] and not before["torque"]:
            jump = abs((jump + TICKS_PER_TURN // 2) % TICKS_PER_TURN - TICKS_PER_TURN // 2)
        return bool(jump <= self._bounds.max_velocity[index] * elapsed + PLAUSIBILITY_TUNING.position_tolerance)

    def _is_calm(self, block: np.void, before: np.void, elapsed: float) -> bool:
        """Return whether a record's temperature change and error bits are credible.

        The alert bit must confirm the error register.
        """
        leap = abs(int(block["temperature"]) - int(before["temperature"]))
        confirmed = (block["error"] >= ALERT_BIT) == (block["hardware_error"] > 0)
        return bool(
            leap <= PLAUSIBILITY_TUNING.temperature_tolerance + PLAUSIBILITY_TUNING.max_heating_rate * elapsed
            and confirmed
        )

    def _confirms(self, block: np.void, doubt: np.void) -> bool:
        jump = abs(int(block["position"]) - int(doubt["position"]))
        leap = abs(int(block["temperature"]) - int(doubt["temperature"]))
        return bool(
            jump <= 2 * PLAUSIBILITY_TUNING.position_tolerance
            and leap <= PLAUSIBILITY_TUNING.temperature_tolerance
            and block["hardware_error"] == doubt["hardware_error"]
        )
