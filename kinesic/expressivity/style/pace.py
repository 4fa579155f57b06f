"""Minimum and natural movement durations of a robot's hands, head and trunk."""

from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np

from kinesic.body.arrays import Floats, Indices, sealed
from kinesic.body.limits import Limits
from kinesic.body.robot import Robot, Side
from kinesic.expressivity.keyframes import Turn
from kinesic.expressivity.turns import MIN_KEY_SPACING, TURN_AXES, add_turns, scale_turn, turn_angles
from kinesic.motion.double_s import least_rest_times

COMFORT_MARGIN = 1.3  # smallest natural duration of a rotation / minimum duration of the servos
TEMPORAL_FACTOR = 1.5  # factor on velocity at a temporal extent of 1
POWER_FACTOR = 2.4  # factor on velocity at a power of 1, within the servo limits
POWER_EXPONENT = 2.0  # exponent of power in the factor on velocity; small power has little effect
WEAKNESS_FACTOR = 1.6  # factor on the duration at a power of -1

_SAMPLED_DISTANCES = np.linspace(0.0, 2.4, 25)  # [arm lengths] distances at which minimum durations are computed
_POSTURE_COUNT = 32  # number of start postures of an arm
_RANGE_FRACTION = 0.5  # fraction of each joint range, about its centre, from which start postures are drawn
_POSTURE_QUANTILE = 0.25  # quantile of the durations over postures: planning chooses favourable elbows
_PROBE_ANGLE = 1e-5  # [rad] step of finite differences of the Jacobian
_JACOBIAN_DAMPING = 1e-3  # damping added to the diagonal of J A J^T, for arms near singularities


def scale_time(natural: float, minimum: float, extent: float, max_factor: float) -> float:
    """Scale a duration [s] by temporal extent, above the servo minimum.

    The fastest extent divides the duration by `max_factor`, the slowest multiplies it. Where the minimum duration
    forbids the whole factor, extent 1 gives the minimum duration, and extents between 0 and 1 are scaled accordingly.

    Args:
        natural: duration at extent 0 [s].
        minimum: minimum duration of the servos [s].
        extent: -1 slow .. 1 fast.
        max_factor: velocity factor at extent 1, at least 1.
    """
    factor = max_factor if extent < 0 or minimum <= 0 else min(max_factor, max(natural / minimum, 1.0))
    return float(max(minimum, natural * factor**-extent))


def natural_time(natural: float, minimum: float, temporal: float, power: float, *, margin: float = 1.0) -> float:
    """Scale a duration by temporal extent and power within servo limits [s].

    Args:
        natural: duration without either [s].
        minimum: minimum duration of the servos [s].
        temporal: extent, -1 slow .. 1 fast.
        power: of a stroke, -1 weak .. 1 forceful.
        margin: multiple of the minimum duration below which power does not shorten a movement.
    """
    scaled = scale_time(natural, minimum, temporal, TEMPORAL_FACTOR)
    if power <= 0.0:
        return scale_time(scaled, minimum, power, WEAKNESS_FACTOR)
    return scale_time(scaled, min(scaled, margin * minimum), power**POWER_EXPONENT, POWER_FACTOR)


@dataclass(frozen=True, eq=False)
class _AxisJoints:
    """Joints of a chain with the rotation axis of each."""

    axes: Indices  # (k,) indices into `TURN_AXES`
    joint_ranges: Floats  # (k,) [rad]
    axis_ranges: Floats  # (k,) [rad] sum of the ranges of all joints of the same axis
    limits: Limits  # motion limits of the k joints


@lru_cache(maxsize=32)
def _axis_joints(robot: Robot, limits: Limits, chain: str) -> _AxisJoints:
    skeleton, joints_of_chain = robot.skeleton, robot.joints(chain)
    pairs = [
        (k, axis) for axis, name in enumerate(TURN_AXES) for k in joints_of_chain if skeleton.names[k].endswith(name)
    ]
    joints, axis = np.array(pairs, dtype=np.intp).reshape(-1, 2).T
    joint_ranges = skeleton.upper[joints] - skeleton.lower[joints]
    axis_ranges = [max(float(joint_ranges[axis == index].sum()), _PROBE_ANGLE) for index in axis]
    return _AxisJoints(axis, sealed(joint_ranges), sealed(axis_ranges), limits.part(joints))


@lru_cache(maxsize=256)  # one movement is looked up for its durations, its layers and its whole-body motion
def _least_turn_time(robot: Robot, limits: Limits, chain: str, turn: Turn) -> float:
    axis_joints = _axis_joints(robot, limits, chain)
    angles = np.array(turn_angles(turn))[axis_joints.axes] * axis_joints.joint_ranges / axis_joints.axis_ranges
    return float(least_rest_times(angles, axis_joints.limits).max(initial=0.0))


@dataclass(frozen=True, eq=False)
class Pace:
    """Minimum and natural movement durations of a robot.

    A natural duration is taken where the document gives no times. Those of hands come from `Effort`.
    """

    robot: Robot
    limits: Limits

    def turn_time(
        self, chain: str, turn: Turn, temporal: float = 0.0, power: float = 0.0, *, usual: float = 0.0
    ) -> float:
        """Return the natural duration of a rotation from upright [s].

        Args:
            chain: `neck` or `torso`.
            turn: rotation to reach.
            temporal: extent, -1 slow .. 1 fast.
            power: of a stroke, -1 weak .. 1 forceful.
            usual: shortest duration that people take when they are at ease [s].
        """
        least = self.least_turn_time(chain, turn)
        return natural_time(max(usual, COMFORT_MARGIN * least), least, temporal, power)

    def manageable_turn(self, chain: str, before: Turn, desired: Turn, seconds: float, haste: float) -> Turn:
        """Limit a rotation to the angle that can be reached in time.

        Args:
            chain: `neck` or `torso`.
            before: rotation at the beginning.
            desired: target rotation.
            seconds: available time [s].
            haste: fraction of that time that the rotation may need.
        """
        change = add_turns(desired, scale_turn(before, -1.0))
        fraction = min(1.0, haste * seconds / max(self.least_turn_time(chain, change), MIN_KEY_SPACING))
        return add_turns(before, scale_turn(change, fraction**3))  # durations shrink no slower than the cube root

    def least_hand_time(self, distance: float) -> float:
        """Return the minimum rest-to-rest duration of a hand movement [s].

        It holds for an arm in a good posture, and grows with the distance [m].
        """
        return float(np.interp(distance / self.robot.arm_length, _SAMPLED_DISTANCES, self._least_hand_times))

    def least_turn_time(self, chain: str, turn: Turn) -> float:
        """Return the minimum rest-to-rest duration of a rotation from upright [s].

        Joints that rotate about the same axis divide the angle in proportion to their ranges.
        """
        return _least_turn_time(self.robot, self.limits, chain, turn)

    @cached_property
    def _least_hand_times(self) -> Floats:
        """Minimum duration of the slower hand at each sampled distance [s]."""
        times = [self._hand_times(side) for side in self.robot.sides]
        return sealed(np.max(times, axis=0) if times else np.zeros(len(_SAMPLED_DISTANCES)))

    def _hand_times(self, side: Side) -> Floats:
        """Return minimum durations [s] of hand movements over the sampled distances.

        They hold along the fastest axis, from the faster postures.
        """
        arm = np.array(self.robot.arm(side).joints, dtype=np.intp)
        limits = self.limits.part(arm)
        jacobian, accelerations = self._hand_jacobian(side), limits.acceleration
        inertia_inverse = jacobian * accelerations @ jacobian.transpose(0, 2, 1) + _JACOBIAN_DAMPING * np.eye(3)
        # (c, 3, k) [rad/m], weighted by the acceleration limits of the joints
        joint_angles = np.linalg.inv(inertia_inverse) @ (jacobian * accelerations)
        times = least_rest_times(
            self.robot.arm_length * _SAMPLED_DISTANCES[:, None, None, None] * joint_angles, limits
        ).max(axis=-1)
        return np.asarray(np.quantile(times.min(axis=-1), _POSTURE_QUANTILE, axis=1))

    def _hand_jacobian(self, side: Side) -> Floats:
        """Return the hand's Jacobians at random postures of an arm.

        Returns:
            (c, 3, k) [m/rad] for c postures and k joints of the arm.
        """
        skeleton, arm = self.robot.skeleton, list(self.robot.arm(side).joints)
        lower, upper = skeleton.lower[arm], skeleton.upper[arm]
        spread = _RANGE_FRACTION * (np.random.default_rng(0).random((_POSTURE_COUNT, len(arm))) - 0.5)
        postures = np.tile(skeleton.rest, (_POSTURE_COUNT, len(arm) + 1, 1))
        postures[..., arm] = ((lower + upper) / 2 + spread * (upper - lower))[:, None]
        postures[:, np.arange(1, len(arm) + 1), arm] += _PROBE_ANGLE
        hands = skeleton.frames(postures).origins[:, :, self.robot.arm(side).wrist]
        jacobian: Floats = ((hands[:, 1:] - hands[:, :1]) / _PROBE_ANGLE).transpose(0, 2, 1)
        return jacobian
