"""Limits that the host applies to goal positions before sending them.

Goals stay in their range, change smoothly, and stay near their servos, for any requested goals.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from kinesic.body.arrays import Flags, Floats, sealed

MAX_LEAD_RATIO = 2.0  # largest distance of a goal from its servo, as a multiple of the position error at full power
VELOCITY_RISE_TIME = 0.01  # [s] shortest time for a goal to accelerate from rest to no-load velocity
LIMIT_TOLERANCE = 1e-6  # Relative tolerance of the limits against rounding


@dataclass(frozen=True, eq=False)
class GoalBounds:
    """Limits of goal positions: range, velocity, distance from the present position."""

    lower: Floats  # (m,) [ticks] smallest goal
    upper: Floats  # (m,) [ticks] largest goal
    speed: Floats  # (m,) [ticks/s] largest velocity of the goal
    lead: Floats  # (m,) [ticks] largest distance from the servo's position to the goal

    @cached_property
    def acceleration(self) -> Floats:
        """Largest acceleration (m,) [ticks/s^2]."""
        return self.speed / VELOCITY_RISE_TIME


@dataclass(frozen=True, eq=False)
class GoalCourse:
    """Goal positions of all servos with their velocities."""

    goals: Floats  # (m,) [ticks] goal positions, not rounded
    velocities: Floats  # (m,) [ticks/s] velocities of the goals

    @classmethod
    def still(cls, goals: Floats) -> "GoalCourse":
        """Create goals with zero velocity."""
        return cls(sealed(goals), sealed(np.zeros(len(goals))))


def limit_goals(
    course: GoalCourse, desired: Floats, present: Floats, seconds: float, bounds: GoalBounds
) -> tuple[GoalCourse, Flags]:
    """Move goals one step towards the desired ones, within the limits.

    Args:
        course: previous goals.
        desired: (m,) [ticks].
        present: (m,) [ticks] positions of the servos; NaN: unknown.
        seconds: [s] since the previous goals.
        bounds: the limits.

    Returns:
        The next goals, and (m,) whether the desired goal was changed.
    """
    near = bool((np.abs(desired - present) <= bounds.lead).all())  # true in nearly every cycle, false for NaN
    if near and bool((desired >= bounds.lower).all()) and bool((desired <= bounds.upper).all()):
        target = desired
    else:
        target = _clip_to_bounds(course, desired, present, bounds)
    velocities = (target - course.goals) / seconds
    change = bounds.acceleration * seconds
    steady = np.abs(velocities) <= bounds.speed * (1 + LIMIT_TOLERANCE)
    steady &= np.abs(velocities - course.velocities) <= change * (1 + LIMIT_TOLERANCE)
    if not steady.all():
        braking = _braking_velocities(course, target, seconds, bounds)
        velocities = np.where(steady, velocities, braking)
    goals = course.goals + velocities * seconds
    refused = ~steady if target is desired else ~steady | (np.abs(target - desired) > 0.5)
    return GoalCourse(_lock_in_place(goals), _lock_in_place(velocities)), refused


def _clip_to_bounds(course: GoalCourse, desired: Floats, present: Floats, bounds: GoalBounds) -> Floats:
    """Limit goals (m,) [ticks] to their ranges and distances from the servos."""
    positions = np.where(np.isfinite(present), present, course.goals)
    low = np.maximum(bounds.lower, np.minimum(positions - bounds.lead, course.goals))
    high = np.minimum(bounds.upper, np.maximum(positions + bounds.lead, course.goals))
    target: Floats = np.clip(desired, np.minimum(low, bounds.upper), np.maximum(high, bounds.lower))
    return target


def _lock_in_place(values: Floats) -> Floats:
    """Make an array read-only without a copy."""
    values.setflags(write=False)
    return values


def _braking_velocities(course: GoalCourse, target: Floats, seconds: float, bounds: GoalBounds) -> Floats:
    """Compute velocities (m,) [ticks/s] towards the targets within the limits.

    From these velocities, the goals can still stop at the targets.
    """
    distance = target - course.goals
    reach = bounds.acceleration * seconds
    # the highest velocity from which velocity changes of `reach` per cycle still stop at the target
    brake = np.sqrt(2 * bounds.acceleration * np.abs(distance) + (reach / 2) ** 2) - reach / 2
    fastest = np.minimum(np.minimum(brake, np.abs(distance) / seconds), bounds.speed)
    velocities: Floats = np.clip(np.sign(distance) * fastest, course.velocities - reach, course.velocities + reach)
    return velocities
