"""Commands to a robot, receivers (sinks) that execute commands, and measurements."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Protocol

import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

from kinesic.body.arrays import Floats, seal_in_place
from kinesic.body.dynamics import Clearance
from kinesic.body.servo import Drives

COMMAND_RATE = 100  # [Hz] commands sent per second
SETTLE_DURATION = 0.3  # [s] time after the end of the motion in which commands are still sent
COMMANDS_PER_WINDOW = 1024  # Commands per evaluation of duties and torques, which bounds the memory
NO_FACE: Mapping[str, float] = MappingProxyType({})  # face at rest, without action units


def command_times(duration: float, *, rate: float = COMMAND_RATE, settle: float = SETTLE_DURATION) -> Floats:
    """Return the performance times [s] of all commands of a motion.

    Args:
        duration: [s] of the motion.
        rate: [Hz] of the commands.
        settle: [s] of further commands after the end.

    Returns:
        (m,) [s] performance times, from 0.
    """
    return np.arange(int(np.ceil((duration + settle) * rate)) + 1) / rate


class State(Struct, frozen=True, eq=False, gc=False):
    """Joint angles, velocities and accelerations at one instant.

    An interruption replans from this state.
    """

    angles: Floats  # (n,) [rad]
    velocities: Floats  # (n,) [rad/s]
    accelerations: Floats  # (n,) [rad/s^2]

    speeds = property(lambda self: self.velocities)  # deprecated alias


class Command(Struct, frozen=True, eq=False, gc=False):
    """Reference motion and servo setpoints at one command time.

    Limits and reports judge the reference; servos follow the setpoints. Hundreds of commands are alive at once and hold
    no reference cycles, so the garbage collector need not track them.
    """

    time: float  # [s] performance time
    angles: Floats  # (n,) [rad] angles of the reference
    velocities: Floats  # (n,) [rad/s] velocities of the reference
    accelerations: Floats  # (n,) [rad/s^2] accelerations of the reference
    setpoints: Floats  # (n,) [rad] reference plus feed-forward, clipped to range
    face: Mapping[str, float] = NO_FACE  # action unit -> intensity 0..1

    speeds = property(lambda self: self.velocities)  # deprecated alias
    goals = property(lambda self: self.setpoints)  # deprecated alias


class Sink(Protocol):
    """Receiver of commands, such as a twin, servos or a recorder.

    It is given the time with each command and never sleeps.
    """

    def write(self, command: Command, /) -> None:
        """Receive one command for the robot's joints and face.

        Times never decrease.
        """

    def close(self) -> None:
        """End the performance after the last command.

        Called once, in `finally`.
        """


class Body(Sink, Protocol):
    """Robot or simulation that executes commands and measures joint angles."""

    def positions(self) -> Floats:
        """Return the joint angles (n,) [rad] measured at the last command.

        NaN for a servo that did not answer.
        """


@dataclass(frozen=True, eq=False)
class Power:
    """Supply current, energy, minimum voltage and winding temperature rises.

    A value at a command is that of the interval which ends there.
    """

    mean: Floats  # (m,) [A] mean current of all servos together
    peak: Floats  # (m,) [A] maximum over the physics steps
    energy: float  # [J] total energy
    volts: float  # [V] minimum supply voltage
    warming: Mapping[str, Floats]  # hinge -> (m,) [K] temperature rise of the windings, if the servo has thermal data


@dataclass(frozen=True, eq=False)
class SetpointRows:
    """Setpoints of many commands, in servo ticks, or unrounded in radians.

    Rounded setpoints take a quarter of the memory of angles.
    """

    counts: NDArray[np.int16] | Floats  # (m, n) [ticks]; floats if a setpoint exceeds two bytes or is not rounded
    tick: Floats  # (n,) [rad] angle of one tick; 1 for setpoints that are not rounded

    def angles(self, rows: slice = slice(None)) -> Floats:
        """Return the setpoints (k, n) [rad] of a range of commands."""
        return seal_in_place(self.counts[rows] * self.tick)


@dataclass(frozen=True, eq=False)
class Measurements:
    """Performed motion, sampled at the times of the commands.

    Setpoints, duties and torques are recomputed with the servo model at each access, because those of a long motion
    take much memory.
    """

    times: Floats  # (m,) [s]
    angles: Floats  # (m, n) [rad]
    velocities: Floats  # (m, n) [rad/s]
    sent: SetpointRows  # setpoints sent with each command
    in_force: SetpointRows  # setpoints in force just before each command
    supplied: Floats  # (m,) supply voltage relative to nominal
    drives: Drives  # drives of the servo model
    hands: Mapping[str, Floats]  # "l", "r" -> (m, 3) [m] wrist centre in the world
    clearance: Clearance  # minimum since the previous command, see `sim.twin`
    latency: float  # [s] time from a command until its setpoints reach the servos
    power: Power

    def __repr__(self) -> str:
        samples, hinges = self.angles.shape
        return f"<{samples} measurements of {hinges} hinges>"

    @property
    def setpoints(self) -> Floats:
        """Setpoints (m, n) [rad] as sent, rounded to servo ticks by default.

        Servo parameters are fitted to them.
        """
        return self.sent.angles()

    @property
    def duties(self) -> Floats:
        """Demanded PWM duties (m, n), before clipping to -1..1."""
        return self._driven_rows(0)

    @property
    def torques(self) -> Floats:
        """Torques (m, n) [Nm] of the drives."""
        return self._driven_rows(1)

    def _driven_rows(self, part: int) -> Floats:
        values = np.empty(self.angles.shape)
        for rows in self.windows():
            values[rows] = self.drive_rows(rows)[part]
        return seal_in_place(values)

    def windows(self) -> Iterator[slice]:
        """Yield consecutive slices of at most `COMMANDS_PER_WINDOW` commands."""
        return (slice(begin, begin + COMMANDS_PER_WINDOW) for begin in range(0, len(self.times), COMMANDS_PER_WINDOW))

    def drive_rows(self, rows: slice) -> tuple[Floats, Floats]:
        """Compute demanded duties and torques [Nm], each (k, n), of a slice."""
        velocities, drives = self.velocities[rows], self.drives
        duties = drives.demanded_duties(self.in_force.angles(rows) - self.angles[rows], velocities)
        torques = drives.torque_ratios(np.clip(duties, -1.0, 1.0), velocities, self.supplied[rows])
        torques *= drives.stall
        return duties, torques
