"""What a robot is told at each tick, who follows it, and what was measured meanwhile."""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Protocol

from msgspec import Struct

from kinesic.body.arrays import Floats
from kinesic.body.dynamics import Clearance

RATE = 100  # [Hz] of commands
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
class Measurements:
    """The performed motion, sampled at the times of the commands."""

    times: Floats  # (m,) [s]
    angles: Floats  # (m, n) [rad]
    speeds: Floats  # (m, n) [rad/s]
    torques: Floats  # (m, n) [Nm] of the drives
    duties: Floats  # (m, n) demanded PWM duty, may exceed 1
    goals: Floats  # (m, n) [rad] that each command sent, in ticks; what serves to fit servos
    hands: Mapping[str, Floats]  # "l", "r" -> (m, 3) [m] the wrist's centre in the world
    clearance: Clearance  # of the closest posture since the command before, see `sim.twin`
    latency: float  # [s] from a command's time until its goals reach the servos
    power: Power
