"""Minimum-jerk steps of head and trunk that follow people.

The face accompanies them.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.expressivity.keyframes import Turn
from kinesic.motion.easing import minimum_jerk

TrunkChain = Literal["neck", "torso"]
TRUNK_CHAINS: tuple[TrunkChain, ...] = ("neck", "torso")  # chains of hinges that follow people, besides the eyes
FOLLOWING_PREFIX = "conversation:"  # prefix of the names of postures that follow people
PEAK_VELOCITY_RATIO = 1.875  # peak / mean velocity of a minimum-jerk step
PEAK_ACCELERATION_RATIO = 10.0 / 3.0**0.5  # peak acceleration of a minimum-jerk step * duration^2 / angle
MAX_STEP_DURATION = 3.0  # [s] longest step that is tried
STEP_GROWTH_FACTOR = 1.2  # duration of a step / duration of the previous, too fast attempt
ONSET_FRACTION = 0.25  # fraction of the duration of a brief expression in which it appears, and in which it vanishes
MAX_ONSET = 0.5  # [s] longest time in which an expression appears or vanishes
RATE_SAMPLES = 25  # number of times at which the limits of a step are checked


@dataclass(frozen=True)
class StepLimits:
    """Comfortable limits of one chain, stricter than those of its servos."""

    velocity: float  # [rad/s] of each axis
    acceleration: float  # [rad/s^2] of each axis
    shortest: float  # [s] shortest duration of a step
    delay: float = 0.0  # [s] delay of a step relative to the step of the head


STEP_LIMITS: dict[TrunkChain, StepLimits] = {
    "neck": StepLimits(float(np.radians(90.0)), float(np.radians(400.0)), 0.2),
    "torso": StepLimits(float(np.radians(25.0)), float(np.radians(100.0)), 0.4, delay=0.12),
}


@dataclass(frozen=True, eq=False)
class FollowStep:
    """Rotation of one chain by a minimum-jerk step."""

    chain: TrunkChain
    change: Floats  # (3,) [rad] torsion, tilt and roll
    begin: float  # [s]
    end: float  # [s]

    def progress(self, times: Floats) -> Floats:
        """Return the completed fraction (m,) of the step at times (m,) [s]."""
        return minimum_jerk((times - self.begin) / (self.end - self.begin))

    def rates(self, times: Floats) -> tuple[Floats, Floats]:
        """Return velocities and accelerations (m, 3) at times (m,) [s]."""
        duration = self.end - self.begin
        x = np.clip((times - self.begin) / duration, 0.0, 1.0)[:, None]
        velocity = 30.0 * x**2 * (1.0 - x) ** 2 * self.change / duration
        acceleration = 60.0 * x * (1.0 - x) * (1.0 - 2.0 * x) * self.change / duration**2
        return np.asarray(velocity), np.asarray(acceleration)


@dataclass(frozen=True, eq=False)
class Glimpse:
    """Expression of the face for some time."""

    units: tuple[tuple[str, float], ...] = ()  # action units with intensities 0..1
    begin: float = 0.0  # [s] global time
    end: float = 0.0  # [s] global time; infinity: it is held
    onset: float = MAX_ONSET  # [s] time in which it appears, and in which it vanishes

    @classmethod
    def brief(cls, units: tuple[tuple[str, float], ...], begin: float, duration: float) -> "Glimpse":
        """Return an expression that appears and vanishes within a duration [s]."""
        return cls(units, begin, begin + duration, min(MAX_ONSET, ONSET_FRACTION * duration))

    def ended(self, time: float) -> "Glimpse":
        """Return the expression as it vanishes smoothly from a time [s] on."""
        return replace(self, end=min(self.end, max(time, self.begin + self.onset) + self.onset))


@dataclass(frozen=True, eq=False)
class FollowedFace:
    """Eye direction and brief expression of a robot that follows people."""

    gaze: Turn = field(default_factory=Turn)  # direction in the world, from upright
    before: Turn = field(default_factory=Turn)  # direction before `begin`
    begin: float = 0.0  # [s] global time of the shift of the eyes
    expression: Glimpse = field(default_factory=Glimpse)
    held: Glimpse = field(default_factory=Glimpse)  # expression of the conversational state
    faded: Glimpse = field(default_factory=Glimpse)  # expression of the previous state


def fit_step(chain: TrunkChain, change: Floats, begin: float, running: Sequence[FollowStep]) -> FollowStep | None:
    """Return the shortest comfortable step in addition to running steps.

    Args:
        chain: rotated chain.
        change: (3,) [rad] torsion, tilt and roll.
        begin: time [s] at which it begins, before `StepLimits.delay`.
        running: steps that have begun and may not have ended.

    Returns:
        None if no step up to `MAX_STEP_DURATION` keeps the limits.
    """
    limits, angle = STEP_LIMITS[chain], float(np.abs(change).max())
    duration = max(
        limits.shortest,
        PEAK_VELOCITY_RATIO * angle / limits.velocity,
        (PEAK_ACCELERATION_RATIO * angle / limits.acceleration) ** 0.5,
    )
    others = [step for step in running if step.chain == chain and step.end > begin]
    while duration <= MAX_STEP_DURATION:
        step = FollowStep(chain, change, begin + limits.delay, begin + limits.delay + duration)
        if _is_comfortable(step, others, limits):
            return step
        duration *= STEP_GROWTH_FACTOR
    return None


def _is_comfortable(step: FollowStep, others: Sequence[FollowStep], limits: StepLimits) -> bool:
    """Return whether overlapping follow rotations keep the velocity and acceleration limits."""
    if not others:
        return True
    times = np.linspace(step.begin, max(item.end for item in (step, *others)), RATE_SAMPLES)
    rates = [item.rates(times) for item in (step, *others)]
    velocity, acceleration = (np.abs(np.sum([rate[k] for rate in rates], axis=0)).max() for k in (0, 1))
    return bool(velocity <= limits.velocity and acceleration <= limits.acceleration)
