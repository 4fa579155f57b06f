"""What a robot's motion has told of its servos: by how much more, or less, they have to be led than data sheets say.

A performance that begins with what an earlier one has told is right from its first motion on. What is believed is
bounded: goals lead at least half, and at most twice as far as data sheets say, and arrive at most 50 ms late.
"""

from dataclasses import dataclass

import msgspec
import numpy as np

from kinesic.body.arrays import Flags, Floats, sealed
from kinesic.body.robot import Robot
from kinesic.body.servo import follow_lags
from kinesic.controller.observer_step import SHARES
from kinesic.sim.fitting.fit import Fit, fit_factors
from kinesic.sim.fitting.parameters import MOST_LATENCY, ServoFigure
from kinesic.sim.log import Log
from kinesic.sim.servo_factors import NOMINAL, DriveFactors, Factors

TOLD: tuple[ServoFigure, ...] = (
    "latency",
    "gain",
)  # by a few seconds of motion; the correction learns what else is wrong
GAINS = (1.0 / (1.0 + SHARES[1]), 1.0 / (1.0 + SHARES[0]))  # what a P gain is believed to be, of its data sheet's
MOVING = 0.05  # share of its no-load speed above which a goal moves
REST = 0.2  # [s] before the first motion that belong to it
ENOUGH = 8.0  # [s] from the first motion on that are looked at
LEAST = 0.4  # [s] of motion without which nothing is told
SAME = 0.02  # share by which two gains do not differ
UNEXPLAINED = np.radians(1.5)  # [rad] RMS of what gain and delay leave over, above which something else is wrong


@dataclass(frozen=True, eq=False)
class LearnedGains:
    """Shares by which goals have to lead more than the model of the servos says, in joint order; 0: as it says."""

    load: Floats  # (n,) of what carries torque; or one row for each time
    lead: Floats  # (n,) of what carries speed; or one row for each time
    delay: float | Floats = 0.0  # [s] until goals reach the servos; or one for each time

    @classmethod
    def of_twin(cls, robot: Robot, twin: Factors) -> "LearnedGains":
        """Makes what a twin that was fitted to a robot's servos says of them.

        Args:
            robot: as its data sheets describe it.
            twin: how far its servos are from them.
        """
        sheet, own = robot.drives, twin.applied(robot).drives
        load = sheet.gain * sheet.stall / (own.gain * own.stall) - 1.0
        lead = follow_lags(own) / follow_lags(sheet) - 1.0
        return cls(sealed(np.clip(load, *SHARES)), sealed(np.clip(lead, *SHARES)), min(twin.latency, MOST_LATENCY))

    def towards(self, other: "LearnedGains", shares: Floats) -> "LearnedGains":
        """Goes over into others, by a share (m,) at each of as many times."""
        rows = shares[:, None]
        return LearnedGains(
            sealed(self.load + rows * (other.load - self.load)),
            sealed(self.lead + rows * (other.lead - self.lead)),
            sealed(self.delay + shares * (other.delay - self.delay)),
        )


@dataclass(frozen=True)
class Lesson:
    """What a motion told of the servos that made it."""

    believed: Factors  # from now on; what was believed before where nothing was told
    before: float = 0.0  # [rad] RMS of a twin's angles minus measured ones, as the servos were believed to be
    after: float = 0.0  # [rad] the same, as they are believed to be now
    why: str = ""  # nothing was told
    bounded: bool = False  # whether servos seemed further from their data sheets than is believed

    def __str__(self) -> str:
        """Says it in one line."""
        if self.why:
            return f"nothing learned: {self.why}"
        before, after = np.degrees([self.before, self.after])
        bound = "; further off than is believed: fit the servos (kinesic twin fit)" if self.bounded else ""
        fell = f"the twin's error fell from {before:.2f} to {after:.2f} deg{bound}"
        return f"learned: {describe_belief(self.believed)}; {fell}"


def soften(robot: Robot, believed: Factors) -> Robot:
    """Makes a robot as soft as its servos are believed to be, for the correction.

    It is never stiffer than the data sheets say: a correction that believed so would be stable in fewer cases.
    """
    rows = {
        name: DriveFactors(gain=float(np.clip(believed.servos.get(name, believed).gain, GAINS[0], 1.0)))
        for name in _models(robot)
    }
    return Factors(servos=rows).applied(robot)


def _models(robot: Robot) -> tuple[str, ...]:
    return tuple(dict.fromkeys(drive.servo.name for drive in robot.drives))


def describe_belief(believed: Factors) -> str:
    """Says in a few words how servos are believed to be, as shares of their data sheets' figures."""
    rows = {name: _shares(own) for name, own in sorted(believed.servos.items())} or {"all servos": _shares(believed)}
    if len(set(rows.values())) == 1:
        rows = {"all servos": next(iter(rows.values()))}
    shown = ", ".join(f"{shares} ({name})" for name, shares in rows.items())
    return f"{shown}, {1000 * believed.latency:.0f} ms late"


def _shares(own: DriveFactors) -> str:
    """The P gain, and what else goals lead by where it is not as in the data sheet."""
    others = (("stall torque", own.stall), ("no-load speed", own.no_load))
    told = [
        f"P gain x {own.gain:.2f}",
        *(f"{name} x {share:.2f}" for name, share in others if f"{share:.2f}" != "1.00"),
    ]
    return " ".join(told)


def learn(log: Log, robot: Robot, believed: Factors = NOMINAL) -> Lesson:
    """Finds P gains and delay of a robot's servos from the first seconds of a motion, whatever corrected its goals.

    What a motion does not tell, such as the gain of servos without motion and load, is believed as before.

    Args:
        log: of a performance that began at rest.
        robot: as its data sheets describe it.
        believed: how its servos were believed to be.
    """
    moving, spans = _moving(log, robot), np.diff(log.times)
    if (moved := float(spans[moving].sum())) < LEAST:
        return Lesson(believed, why=f"servos moved for {moved:.1f} s, at least {LEAST:g} s are needed")
    begin = int(np.searchsorted(log.times, log.times[int(moving.argmax())] - REST))
    end = int(np.searchsorted(log.times, log.times[begin] + REST + ENOUGH))
    part = Log(log.times[begin:end], log.goals[begin:end], log.angles[begin:end])
    found = fit_factors(part, believed.applied(robot), free=TOLD)
    if found.after > UNEXPLAINED:
        left = f"{np.degrees(found.after):.1f} deg of error are left"
        return Lesson(believed, found.before, found.after, f"gain and delay do not explain the motion: {left}")
    if all(estimate.why for estimate in found.estimates):
        return Lesson(believed, found.before, found.after, "the motion tells neither gain nor delay")
    return _lesson(found, robot, believed)


def _moving(log: Log, robot: Robot) -> Flags:
    """(m - 1,) whether any goal moves from each time to the next."""
    speeds = np.abs(np.diff(log.goals, axis=0)) / np.diff(log.times)[:, None]
    moving: Flags = np.any(speeds > MOVING * robot.drives.no_load, axis=1)
    return moving


def _lesson(found: Fit, robot: Robot, believed: Factors) -> Lesson:
    """Joins what was found with what was believed, within bounds."""
    late = next(estimate for estimate in found.estimates if estimate.unknown.figure == "latency")
    servos, bounded = {}, False
    for name in _models(robot):
        own = believed.servos.get(name, believed)
        gain = own.gain * found.factors.servos.get(name, NOMINAL).gain
        kept = float(np.clip(gain, *GAINS))
        bounded = bounded or abs(kept - gain) > SAME * gain
        figures = {figure: getattr(own, figure) for figure in DriveFactors.__struct_fields__}
        servos[name] = DriveFactors(**{**figures, "gain": kept})
    latency = believed.latency if late.why else min(found.factors.latency, MOST_LATENCY)
    joined = msgspec.structs.replace(believed, servos=servos, latency=latency)
    return Lesson(joined, found.before, found.after, bounded=bounded)
