"""What a robot is told at each tick, what it is doing, and who listens."""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Protocol

from msgspec import Struct

from kinesic.body.arrays import Floats

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
