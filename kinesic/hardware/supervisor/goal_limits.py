"""Limits goals on the host: whatever is requested, no goal leaves its range, jumps, or runs away from its servo."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from kinesic.body.arrays import Flags, Floats, sealed

LEAD = 2.0  # times the error of full power that a goal may be ahead of its servo
RISE = 0.01  # [s] in which a goal may come up to the servo's speed without load
SLACK = 1e-6  # of the limits, against rounding


@dataclass(frozen=True, eq=False)
class GoalBounds:
    """What goals of members may do."""

    lower: Floats  # (m,) [ticks]
    upper: Floats  # (m,) [ticks]
    speed: Floats  # (m,) [ticks/s]
    lead: Floats  # (m,) [ticks] that goals may be ahead of their servos

    @cached_property
    def acceleration(self) -> Floats:
        """(m,) [ticks/s^2]."""
        return self.speed / RISE


@dataclass(frozen=True, eq=False)
class GoalCourse:
    """Goals and how fast they move."""

    goals: Floats  # (m,) [ticks], fractions kept
    speeds: Floats  # (m,) [ticks/s]

    @classmethod
    def still(cls, goals: Floats) -> "GoalCourse":
        """Makes a course that stands."""
        return cls(sealed(goals), sealed(np.zeros(len(goals))))


def limit_goals(
    course: GoalCourse, desired: Floats, present: Floats, seconds: float, bounds: GoalBounds
) -> tuple[GoalCourse, Flags]:
    """Returns the next goals: the desired ones where they keep the limits, else the nearest that do.

    Args:
        course: the goals before.
        desired: (m,) [ticks].
        present: (m,) [ticks] where the servos are; NaN where nobody knows.
        seconds: since the goals before.
        bounds: the limits.

    Returns:
        The course, and (m,) whose desired goals were not granted.
    """
    near = bool((np.abs(desired - present) <= bounds.lead).all())  # that is so in nearly every cycle; not if one is NaN
    if near and bool((desired >= bounds.lower).all()) and bool((desired <= bounds.upper).all()):
        target = desired
    else:
        target = _granted(course, desired, present, bounds)
    speeds = (target - course.goals) / seconds
    change = bounds.acceleration * seconds
    steady = np.abs(speeds) <= bounds.speed * (1 + SLACK)
    steady &= np.abs(speeds - course.speeds) <= change * (1 + SLACK)
    if not steady.all():
        caught = _catching(course, target, seconds, bounds)
        speeds = np.where(steady, speeds, caught)
    goals = course.goals + speeds * seconds
    refused = ~steady if target is desired else ~steady | (np.abs(target - desired) > 0.5)
    return GoalCourse(_locked(goals), _locked(speeds)), refused


def _granted(course: GoalCourse, desired: Floats, present: Floats, bounds: GoalBounds) -> Floats:
    """(m,) [ticks] what is desired, but inside the range and not too far ahead of the servo."""
    known = np.where(np.isfinite(present), present, course.goals)
    low = np.maximum(bounds.lower, np.minimum(known - bounds.lead, course.goals))
    high = np.minimum(bounds.upper, np.maximum(known + bounds.lead, course.goals))
    target: Floats = np.clip(desired, np.minimum(low, bounds.upper), np.maximum(high, bounds.lower))
    return target


def _locked(values: Floats) -> Floats:
    """The same array, which nobody else holds, read-only."""
    values.setflags(write=False)
    return values


def _catching(course: GoalCourse, target: Floats, seconds: float, bounds: GoalBounds) -> Floats:
    """(m,) [ticks/s] that bring a goal to its target within the limits, braking in time."""
    away = target - course.goals
    reach = bounds.acceleration * seconds
    # the fastest from which steps of `reach` still stop at the target
    brake = np.sqrt(2 * bounds.acceleration * np.abs(away) + (reach / 2) ** 2) - reach / 2
    fastest = np.minimum(np.minimum(brake, np.abs(away) / seconds), bounds.speed)
    speeds: Floats = np.clip(np.sign(away) * fastest, course.speeds - reach, course.speeds + reach)
    return speeds
