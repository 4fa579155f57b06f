"""Observer of wire bytes and servo shafts that reports broken rules.

The rules: no torque is taken from a servo more than 5 degrees from rest; goals never jump, but to where a servo stands;
torque comes where it is; after more than a second of standing nothing moves away from rest by itself; what is believed
is where servos are.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, field
from math import radians
from typing import Protocol

import numpy as np

from kinesic.body.arrays import Flags, Floats
from kinesic.hardware.protocol.wire import BusError, Wire
from kinesic.hardware.supervisor.manifest import Manifest

from ...manual_servo import packet as p
from ...manual_servo.line import writes_of
from ...manual_servo.packet import Decoder, Packet

TORQUE, PWM, GOAL = 64, 100, 116
REST_TOLERANCE = radians(5)  # [rad] largest distance from rest at which a servo may lose torque
RECENT_STATES = 20  # number of recent actual states that a reported angle is compared with
STANDSTILL_LIMIT = 1.0  # [s] duration of a standstill after which motion needs a resume request
MAX_DEPARTURE = radians(3)  # [rad] largest motion away from rest without a resume request after a standstill
STANDSTILL_TOLERANCE = radians(0.2)  # [rad] largest motion of goals during a standstill
GOAL_TOLERANCE = radians(1)  # [rad] largest distance between goal and servo when torque is switched on
MAX_VELOCITY_RATIO = 1.6  # largest goal velocity / no-load velocity of the servo
TICK_TOLERANCE = 2  # [ticks] rounding tolerance of goal changes
ANGLE_TOLERANCE = radians(3)  # [rad] largest error of a reported angle
TIME_TOLERANCE = 0.03  # [s] largest error of the time of a reported angle


class TrueServos(Protocol):
    """Actual states of the servos in manifest order."""

    def torque(self) -> Flags:
        """Return which servos have torque, (m,)."""

    def ticks(self) -> Floats:
        """Return the actual positions [ticks], (m,)."""


class SpyWire:
    """Wire that shows outgoing bytes to an observer."""

    def __init__(self, wire: Wire, observer: Observer, bus: str) -> None:
        self._wire, self._observer, self._bus, self._decoder = wire, observer, bus, Decoder()

    def __getattr__(self, name: str) -> object:
        return getattr(self._wire, name)

    def write(self, data: bytes | bytearray, /) -> None:
        """Show the bytes to the observer before the servos change, then write them."""
        time, count = self._wire.now(), len(self._observer.broken)
        for packet in self._decoder.feed(bytes(data), time):
            self._observer.hear(self._bus, packet, time)
        try:
            self._wire.write(data)
        except BusError:
            del self._observer.broken[count:]  # nobody has heard it
            raise


@dataclass(frozen=True)
class Moment:
    """Actual state of all servos at one time."""

    time: float  # [s] time of the state
    torque: Flags
    angles: Floats  # (m,) [rad] actual joint angle by servo


@dataclass
class Observer:
    """Observer that collects the safety rules that servos break."""

    manifest: Manifest
    true: TrueServos
    broken: list[str] = field(default_factory=list)

    def __post_init__(self) -> None:
        count = len(self.manifest.members)
        self.watching = False  # whether a long standstill counts as an interruption
        self._moments: deque[Moment] = deque(maxlen=RECENT_STATES)
        self._goals, self._sent, self._powers = np.full(count, np.nan), np.full(count, np.nan), np.full(count, np.nan)
        self._energised: Flags = np.zeros(count, dtype=np.bool_)
        self._held, self._stood = self._goals.copy(), 0.0
        self._nearest: Floats | None = None  # (m,) [rad] from rest, since it was interrupted

    @property
    def rest(self) -> Floats:
        """Return the rest positions of the servos [rad], (m,)."""
        return self.manifest.rest[self.manifest.joints]

    def angles(self, ticks: Floats) -> Floats:
        """Return the actual joint angles [rad]."""
        return np.asarray(self.manifest.scale.angles(ticks))

    # the wires

    def hear(self, bus: str, packet: Packet, time: float) -> None:
        """Check a packet that is being sent on a bus."""
        places = {member.id: k for k, member in enumerate(self.manifest.members) if member.bus == bus}

        def meant(servo: int) -> list[int]:
            return list(places.values()) if servo == p.BROADCAST_ID else [places[servo]] if servo in places else []

        if packet.instruction in (p.REBOOT, p.FACTORY_RESET):
            for place in meant(packet.servo):
                self._lets_go(place, time, "reboot")
        for servo, address, data in writes_of(packet):
            for place in meant(servo):
                self._written(place, address, data, time)

    def _written(self, place: int, address: int, data: bytes, time: float) -> None:
        if address <= TORQUE < address + len(data) and not data[TORQUE - address]:
            self._lets_go(place, time, "torque off")
        if (power := _value(address, data, PWM, 2)) is not None:
            if self._energised[place] and power < self._powers[place] - 1:
                self._lets_go(place, time, f"power {power}")
            self._powers[place] = power
        if (goal := _value(address, data, GOAL, 4)) is not None:
            self._goal(place, float(goal), time)

    def _lets_go(self, place: int, time: float, how: str) -> None:
        away = self.angles(self.true.ticks())[place] - self.rest[place]
        if self.true.torque()[place] and abs(away) > REST_TOLERANCE:
            self._note(time, place, f"{how} at {np.degrees(away):.0f} degrees from rest")

    def _goal(self, place: int, goal: float, time: float) -> None:
        before, passed = self._goals[place], time - self._sent[place]
        most = MAX_VELOCITY_RATIO * self.manifest.velocities[place] * max(passed, 0.0) + TICK_TOLERANCE
        moves = self._off(place, goal) > GOAL_TOLERANCE
        if not moves and self._nearest is not None and abs(goal - before) > most:
            self._nearest[place] = np.inf  # it did not hear the goals before, and stands where it was
        elif moves and self._energised[place] and abs(goal - before) > most:
            self._note(time, place, f"goal jumps from {before:.0f} to {goal:.0f} ticks in {1000 * passed:.0f} ms")
        self._goals[place], self._sent[place] = goal, time

    def _off(self, place: int, goal: float) -> float:
        """Return the distance [rad] between a goal and the position of its servo."""
        turns = abs(self.manifest.scale.turns[place])
        return float(abs(goal - self.true.ticks()[place]) / turns * np.pi / 2048)

    # every cycle

    def look(self, time: float, believed: Floats, taken: Floats) -> None:
        """Compare servos with reported angles [rad] and times [s], NaN if unknown."""
        torque, ticks = self.true.torque(), self.true.ticks()
        angles = self.angles(ticks)
        for place in np.flatnonzero(torque & ~self._energised):
            off = self._off(int(place), self._goals[place])
            if off > GOAL_TOLERANCE:
                self._note(time, int(place), f"torque comes {np.degrees(off):.1f} degrees from its goal")
        self._energised = torque
        self._moments.append(Moment(time, torque, angles))
        self._judge_standing(time)
        self._judge_beliefs(believed, taken)

    def _judge_standing(self, time: float) -> None:
        """Check that goals move only towards rest after a long standstill."""
        goals = self.angles(self._goals)
        away = np.abs(goals - self.rest)
        if np.isnan(self._held).any() or not self.watching or np.abs(goals - self._held).max() > STANDSTILL_TOLERANCE:
            self._held, self._stood = goals, time
        elif time - self._stood > STANDSTILL_LIMIT and self._nearest is None:
            self._nearest = away
        if self._nearest is None:
            return
        self._nearest = np.minimum(self._nearest, away)
        for place in np.flatnonzero((away > self._nearest + MAX_DEPARTURE) & self._energised):
            self._note(time, int(place), "moves away from rest again, and nobody has agreed")

    def _judge_beliefs(self, believed: Floats, taken: Floats) -> None:
        for place, joint in enumerate(self.manifest.joints.tolist()):
            if np.isnan(believed[joint] + taken[joint]):
                continue
            near = [m.angles[place] for m in self._moments if abs(m.time - taken[joint]) <= TIME_TOLERANCE]
            if near and min(abs(angle - believed[joint]) for angle in near) > ANGLE_TOLERANCE:
                self._note(float(taken[joint]), place, f"is believed at {np.degrees(believed[joint]):.0f} degrees")

    def _note(self, time: float, place: int, text: str) -> None:
        self.broken.append(f"{time:.2f} s: {self.manifest.members[place].hinge}: {text}")


def _value(address: int, data: bytes, register: int, size: int) -> int | None:
    at = register - address
    return int.from_bytes(data[at : at + size], "little", signed=True) if 0 <= at <= len(data) - size else None
