"""What a robot is told at each tick, who follows it, and what was measured meanwhile."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Protocol

import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

from kinesic.body.arrays import Floats, seal_own
from kinesic.body.dynamics import Clearance
from kinesic.body.servo import Drives

RATE = 100  # [Hz] of commands
COMMANDS_PER_WINDOW = 1024  # commands whose duties are computed together
NO_FACE: Mapping[str, float] = MappingProxyType({})


class State(Struct, frozen=True, eq=False, gc=False):
    """Motion at one instant, in joint order; interruption is re-planning from here."""

    angles: Floats  # (n,) [rad]
    speeds: Floats  # (n,) [rad/s]
    accelerations: Floats  # (n,) [rad/s^2]


class Command(Struct, frozen=True, eq=False, gc=False):
    """One tick: the reference that limits and reports judge, and the goals that servos follow.

    Hundreds are alive at once, and hold no cycles: the garbage collector need not look at them.
    """

    time: float  # [s] performance time
    angles: Floats  # (n,) [rad] reference
    speeds: Floats  # (n,) [rad/s] reference
    accelerations: Floats  # (n,) [rad/s^2] reference
    goals: Floats  # (n,) [rad] reference plus feed-forward, clipped to range
    face: Mapping[str, float] = NO_FACE  # action unit -> 0..1


class Sink(Protocol):
    """Anything that follows commands. It is told the time and never sleeps."""

    def write(self, command: Command, /) -> None:
        """Follows one command; times never decrease."""

    def close(self) -> None:
        """Ends the performance; called once, in `finally`."""


class Body(Sink, Protocol):
    """A sink that can tell where its hinges are."""

    def positions(self) -> Floats:
        """(n,) [rad] at the last command, as its sensors have them; NaN for a servo that did not answer."""


@dataclass(frozen=True, eq=False)
class Power:
    """What the servos took from the supply in the interval that ends at each command, and what it did to them."""

    mean: Floats  # (m,) [A] of all servos together
    peak: Floats  # (m,) [A] largest on any physics step
    energy: float  # [J] in all
    volts: float  # [V] lowest of the supply
    warming: Mapping[str, Floats]  # hinge -> (m,) [K] rise of its windings, where the servo's thermal figures are known


@dataclass(frozen=True, eq=False)
class TickRows:
    """Goals of many commands as servos hold them: whole ticks, in a quarter of the room that angles take."""

    counts: NDArray[np.int16] | Floats  # (m, n) ticks; floats where some goal is beyond two bytes, or not rounded
    tick: Floats  # (n,) [rad]; 1 for goals that nobody rounds

    def angles(self, rows: slice = slice(None)) -> Floats:
        """Computes the goals (k, n) [rad] of some rows."""
        return seal_own(self.counts[rows] * self.tick)


@dataclass(frozen=True, eq=False)
class Measurements:
    """The performed motion, sampled at the times of the commands.

    Goals, duties and torques follow from what is kept by the servos' law. They are computed each time that somebody
    asks, as those of a long motion take much room.
    """

    times: Floats  # (m,) [s]
    angles: Floats  # (m, n) [rad]
    speeds: Floats  # (m, n) [rad/s]
    sent: TickRows  # goals of each command
    in_force: TickRows  # goals that were in force just before each command
    supplied: Floats  # (m,) share of its voltage that the supply had there
    drives: Drives  # whose law it is
    hands: Mapping[str, Floats]  # "l", "r" -> (m, 3) [m] the wrist's centre in the world
    clearance: Clearance  # of the closest posture since the command before, see `sim.twin`
    latency: float  # [s] from a command's time until its goals reach the servos
    power: Power

    @property
    def goals(self) -> Floats:
        """(m, n) [rad] that each command sent, in ticks; what serves to fit servos."""
        return self.sent.angles()

    @property
    def duties(self) -> Floats:
        """(m, n) demanded PWM duty, may exceed 1."""
        return self._of_drives(0)

    @property
    def torques(self) -> Floats:
        """(m, n) [Nm] of the drives."""
        return self._of_drives(1)

    def _of_drives(self, part: int) -> Floats:
        found = np.empty(self.angles.shape)
        for rows in self.windows():
            found[rows] = self.drive_rows(rows)[part]
        return seal_own(found)

    def windows(self) -> Iterator[slice]:
        """Yields the rows of commands whose duties are computed together, window by window."""
        return (slice(begin, begin + COMMANDS_PER_WINDOW) for begin in range(0, len(self.times), COMMANDS_PER_WINDOW))

    def drive_rows(self, rows: slice) -> tuple[Floats, Floats]:
        """Computes duties and torques [Nm] of some commands, each (k, n)."""
        speeds, drives = self.speeds[rows], self.drives
        duties = drives.demanded(self.in_force.angles(rows) - self.angles[rows], speeds)
        loads = drives.loads(np.clip(duties, -1.0, 1.0), speeds, self.supplied[rows])
        loads *= drives.stall
        return duties, loads
